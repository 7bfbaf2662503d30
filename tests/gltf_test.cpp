// glTF in and out: a scene survives saving and loading field by field; every way of storing vertices is read; what is
// not supported is told once; and whatever is broken gives one line that names the file, never a crash.
#include "core/gltf.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/check.h"
#include "core/files.h"
#include "core/glb.h"
#include "core/png.h"
#include "core/random.h"

namespace fs = std::filesystem;
using core::Scene;
using core::vec2;
using core::vec3;
using core::vec4;

namespace {

// ---- a scene that has one of everything

core::Texture smallTexture(core::Texture::Wrap u, core::Texture::Wrap v, std::uint8_t start) {
  core::Texture texture{3, 2, {}, u, v};
  for (int i = 0; i < 24; ++i) texture.texels.push_back(static_cast<std::uint8_t>(start + 7 * i));
  return texture;
}

core::Mesh triangleMesh(const std::string& name, int material, bool attributes) {
  core::Mesh mesh;
  mesh.name = name;
  mesh.positions = {{0, 0, 0}, {1.1f, 0, 0}, {0, 0.3f, -7}, {5, 5, 5}};
  if (attributes) mesh.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, -1}};
  if (attributes) mesh.uvs = {{0, 0}, {0.1f, 2}, {-3, 0.7f}, {1, 1}};
  mesh.triangles = {{0, 1, 2}, {3, 2, 1}};
  mesh.material = material;
  return mesh;
}

core::Track track(core::Interpolation interpolation, std::vector<vec4> values) {
  const std::size_t keys = values.size() / (interpolation == core::Interpolation::cubic ? 3 : 1);
  core::Track t;
  for (std::size_t k = 0; k < keys; ++k) t.times.push_back(0.1f + 0.3f * static_cast<float>(k));
  t.values = std::move(values);
  t.interpolation = interpolation;
  return t;
}

core::Track flicker(core::Interpolation interpolation, float second) {
  return track(interpolation, {{0.3f, 0, 0, 0}, {second, 0, 0, 0}, {0, 0, 0, 0}});
}

std::vector<core::Material> someMaterials() {
  core::Material shiny, glowing, dim;
  shiny.name = "shiny \"quoted\" ü";
  shiny.baseColor = {0.1f, 0.7f, 0.33f};
  shiny.metallic = 0.3f;
  shiny.roughness = 0.123f;
  shiny.doubleSided = true;
  shiny.baseColorTexture = 0;
  shiny.metallicRoughnessTexture = 1;
  shiny.normalTexture = 2;
  shiny.normalScale = 0.4f;
  glowing.emission = {17.3f, 0.1f, 12345.678f};
  glowing.emissionTexture = 1;
  glowing.flicker = 0;
  dim.emission = {0.1f, 0.2f, 0.3f};
  dim.flicker = 1;
  return {shiny, glowing, dim};
}

std::vector<core::Node> someNodes() {
  core::Node root, turned, matrix, moving;
  root.name = "root";
  turned.parent = 0;
  turned.translation = {0.1f, -2.7f, 1e-5f};
  turned.rotation = normalize(core::quat(0.3f, 0.1f, -0.7f, 0.2f));
  turned.scale = {1, 2, 0.1f};
  matrix.parent = 1;
  matrix.hasMatrix = true;
  for (int i = 0; i < 16; ++i)
    matrix.matrix[i / 4][i % 4] = i == 15 ? 1 : i % 4 == 3 ? 0 : 0.37f * static_cast<float>(i);
  moving.translationTrack = track(core::Interpolation::linear, {{0, 1, 2, 0}, {0.1f, 5, 2, 0}});
  moving.rotationTrack = track(core::Interpolation::step, {{0, 0, 0, 1}, {0.6f, 0, 0.8f, 0}});
  moving.scaleTrack = track(core::Interpolation::cubic, std::vector<vec4>(6, vec4(0.3f, 1, 2, 0)));
  return {root, turned, matrix, moving};
}

Scene everything() {
  using Wrap = core::Texture::Wrap;
  using Type = core::PunctualLight::Type;
  Scene scene;
  scene.textures = {smallTexture(Wrap::repeat, Wrap::clamp, 0), smallTexture(Wrap::mirror, Wrap::repeat, 50),
                    smallTexture(Wrap::clamp, Wrap::mirror, 100)};
  scene.materials = someMaterials();
  scene.meshes = {triangleMesh("plain", 2, false), triangleMesh("full", 0, true), triangleMesh("lamp", 1, true)};
  scene.nodes = someNodes();
  scene.instances = {{0, 0}, {1, 1}, {2, 1}, {1, 3}};  // two on one node
  scene.punctual = {{Type::spot, {3, 700, 0.2f}, 0.1f, 0.6f, 3},
                    {Type::point, {0.1f, 0.2f, 0.3f}, 0, core::kPi / 4, 1},
                    {Type::directional, {0, 2, 0}, 0, core::kPi / 4, 2}};
  scene.cameras = {{"second", 0.7f, 3}, {"", 1.2f, 1}};
  scene.flickers = {flicker(core::Interpolation::step, 2), flicker(core::Interpolation::linear, 1.7f)};
  return scene;
}

void expectEqual(const core::Track& a, const core::Track& b) {
  EXPECT_EQ(a.times, b.times);
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.interpolation, b.interpolation);
}

void expectEqual(const core::Material& a, const core::Material& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.baseColor, b.baseColor);
  EXPECT_EQ(a.metallic, b.metallic);
  EXPECT_EQ(a.roughness, b.roughness);
  EXPECT_EQ(a.emission, b.emission);
  EXPECT_EQ(a.doubleSided, b.doubleSided);
  EXPECT_EQ(a.baseColorTexture, b.baseColorTexture);
  EXPECT_EQ(a.metallicRoughnessTexture, b.metallicRoughnessTexture);
  EXPECT_EQ(a.emissionTexture, b.emissionTexture);
  EXPECT_EQ(a.normalTexture, b.normalTexture);
  EXPECT_EQ(a.normalScale, b.normalScale);
  EXPECT_EQ(a.flicker, b.flicker);
}

void expectEqual(const core::Mesh& a, const core::Mesh& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.uvs, b.uvs);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.material, b.material);
}

void expectEqual(const core::Node& a, const core::Node& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.parent, b.parent);
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_EQ(a.rotation, b.rotation);
  EXPECT_EQ(a.scale, b.scale);
  EXPECT_EQ(a.hasMatrix, b.hasMatrix);
  EXPECT_EQ(a.matrix, b.matrix);
  expectEqual(a.translationTrack, b.translationTrack);
  expectEqual(a.rotationTrack, b.rotationTrack);
  expectEqual(a.scaleTrack, b.scaleTrack);
}

void expectEqual(const core::Texture& a, const core::Texture& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.texels, b.texels);
  EXPECT_EQ(a.wrapU, b.wrapU);
  EXPECT_EQ(a.wrapV, b.wrapV);
}

void expectEqual(const core::Instance& a, const core::Instance& b) {
  EXPECT_EQ(a.mesh, b.mesh);
  EXPECT_EQ(a.node, b.node);
}

void expectEqual(const core::PunctualLight& a, const core::PunctualLight& b) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.innerAngle, b.innerAngle);
  EXPECT_EQ(a.outerAngle, b.outerAngle);
  EXPECT_EQ(a.node, b.node);
}

void expectEqual(const core::SceneCamera& a, const core::SceneCamera& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.yfov, b.yfov);
  EXPECT_EQ(a.node, b.node);
}

template <class T>
void expectAllEqual(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expectEqual(a[i], b[i]);
}

// ---- hand-made files

/// Two triangles of a quad: positions (4 x vec3 at 0), list indices (6 x u16 at 48), strip (4 x u8 at 60), interleaved
/// normalised u8 uvs with stride 4 (at 64), one sparse index (u8 at 80) and its vec3 (at 84).
std::string quadBytes() {
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const std::uint16_t list[] = {0, 1, 2, 2, 1, 3};
  const std::uint8_t rest[] = {0, 1, 2, 3, 0, 0, 9, 9, 255, 0, 9, 9, 0, 255, 9, 9, 255, 51, 9, 9, 3, 0, 0, 0};
  const float moved[] = {2, 2, 5};
  std::string bytes(96, '\0');
  std::memcpy(bytes.data(), positions, 48);
  std::memcpy(bytes.data() + 48, list, 12);
  std::memcpy(bytes.data() + 60, rest, 24);
  std::memcpy(bytes.data() + 84, moved, 12);
  return bytes;
}

const char* const kQuad = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
  "nodes": [{"mesh": 0}], "materials": [{}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "mode": 4}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC2"}],
  "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
                  {"buffer": 0, "byteOffset": 64, "byteLength": 16, "byteStride": 4},
                  {"buffer": 0, "byteOffset": 60, "byteLength": 4},
                  {"buffer": 0, "byteOffset": 80, "byteLength": 1}, {"buffer": 0, "byteOffset": 84, "byteLength": 12}],
  "buffers": [{"byteLength": 96, "uri": "quad.bin"}]})";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string quadWith(const std::string& from, const std::string& to) { return replaced(kQuad, from, to); }

fs::path sharedFolder() {
  const char* shared = std::getenv("TWOFOLD_SHARED");
  return shared ? shared : TWOFOLD_SOURCE_DIR "/../shared";
}

class Gltf : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("gltf_test_" + std::to_string(getpid()));
    fs::create_directory(folder_);
    core::writeFileAtomically(folder_ / "quad.bin", quadBytes());
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& bytes) const {
    core::writeFileAtomically(folder_ / name, bytes);
    return folder_ / name;
  }
  Scene load(const std::string& json) const { return core::loadGltf(write("test.gltf", json)); }

  /// The error's text, "" if the file loads.
  static std::string errorOf(const fs::path& path) {
    try {
      core::loadGltf(path);
      return "";
    } catch (const core::Error& e) {
      return e.what();
    }
  }
  /// The file must be refused by one line that names it and contains `what`.
  void expectRefused(const std::string& json, const std::string& what) const {
    const fs::path path = write("test.gltf", json);
    const std::string error = errorOf(path);
    EXPECT_NE(error.find(what), std::string::npos) << "error: '" << error << "' for " << json;
    EXPECT_EQ(error.find(path.string()), 0u) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  fs::path folder_;
};

}  // namespace

TEST_F(Gltf, RoundTripKeepsEveryField) {
  const Scene scene = everything();
  core::saveGlb(scene, folder_ / "all.glb");
  const Scene back = core::loadGltf(folder_ / "all.glb");
  EXPECT_EQ(back.name, "all");
  EXPECT_TRUE(back.warnings.empty()) << back.warnings.front();
  expectAllEqual(scene.textures, back.textures);
  expectAllEqual(scene.materials, back.materials);
  expectAllEqual(scene.meshes, back.meshes);
  expectAllEqual(scene.nodes, back.nodes);
  expectAllEqual(scene.instances, back.instances);
  expectAllEqual(scene.punctual, back.punctual);
  expectAllEqual(scene.cameras, back.cameras);
  expectAllEqual(scene.flickers, back.flickers);
}

TEST_F(Gltf, WhatSharesANodeGetsChildren) {
  Scene scene = everything();
  for (core::SceneCamera& camera : scene.cameras) camera.node = 1;
  for (core::PunctualLight& light : scene.punctual) light.node = 1;
  core::saveGlb(scene, folder_ / "shared.glb");
  const Scene back = core::loadGltf(folder_ / "shared.glb");
  ASSERT_EQ(back.cameras.size(), 2u);
  ASSERT_EQ(back.punctual.size(), 3u);
  EXPECT_EQ(back.nodes.size(), scene.nodes.size() + 3);
  const core::Pose before = core::poseAt(scene, 0.2), after = core::poseAt(back, 0.2);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(before.nodeToWorld[scene.punctual[i].node], after.nodeToWorld[back.punctual[i].node]);
}

TEST_F(Gltf, EmptySceneAndMeshesWithoutTriangles) {
  core::saveGlb(Scene{}, folder_ / "empty.glb");
  EXPECT_TRUE(core::loadGltf(folder_ / "empty.glb").nodes.empty());
  Scene scene = everything();
  scene.meshes[0].triangles.clear();
  EXPECT_THROW(core::saveGlb(scene, folder_ / "x.glb"), core::Error);
  EXPECT_FALSE(fs::exists(folder_ / "x.glb"));
}

TEST_F(Gltf, ReadsListsStridesAndNormalisedNumbers) {
  const Scene scene = load(kQuad);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const core::Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangles, (std::vector<core::uvec3>{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(mesh.positions[3], vec3(1, 1, 0));
  EXPECT_EQ(mesh.uvs, (std::vector<vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 0.2f}}));
  EXPECT_EQ(scene.materials.size(), 2u);  // the file's, and glTF's default that the primitive uses
  EXPECT_EQ(scene.materials[mesh.material].metallic, 1);
}

TEST_F(Gltf, ReadsStripsAndFans) {
  const std::string strip =
      replaced(quadWith("\"mode\": 4", "\"mode\": 5"), "\"bufferView\": 1, \"componentType\": 5123, \"count\": 6",
               "\"bufferView\": 3, \"componentType\": 5121, \"count\": 4");
  EXPECT_EQ(load(strip).meshes[0].triangles, (std::vector<core::uvec3>{{0, 1, 2}, {1, 3, 2}}));
  const std::string fan = replaced(strip, "\"mode\": 5", "\"mode\": 6");
  EXPECT_EQ(load(fan).meshes[0].triangles, (std::vector<core::uvec3>{{1, 2, 0}, {2, 3, 0}}));
  const std::string unindexed = replaced(strip, "\"indices\": 1, ", "");
  EXPECT_EQ(load(unindexed).meshes[0].triangles.size(), 2u);
}

TEST_F(Gltf, ReadsSparseAccessors) {
  const std::string sparse = R"("count": 4, "sparse": {"count": 1, "indices": {"bufferView": 4, "componentType": 5121},
      "values": {"bufferView": 5}}, "type": "VEC3")";
  const Scene scene = load(quadWith("\"count\": 4, \"type\": \"VEC3\"", sparse));
  EXPECT_EQ(scene.meshes[0].positions[1], vec3(1, 0, 0));
  EXPECT_EQ(scene.meshes[0].positions[3], vec3(2, 2, 5));
  const Scene zeros = load(replaced(quadWith("\"count\": 4, \"type\": \"VEC3\"", sparse), "\"bufferView\": 0, ", ""));
  EXPECT_EQ(zeros.meshes[0].positions[1], vec3(0));
  EXPECT_EQ(zeros.meshes[0].positions[3], vec3(2, 2, 5));
  expectRefused(replaced(quadWith("\"count\": 4, \"type\": \"VEC3\"", sparse), "{\"count\": 1", "{\"count\": 2"),
                "reaches beyond");
}

TEST_F(Gltf, ParentsComeFirstWhateverTheFileSays) {
  const Scene scene = load(quadWith("\"nodes\": [{\"mesh\": 0}]",
                                    R"("nodes": [{"children": [2]}, {"mesh": 0, "translation": [1, 0, 0]},
                                       {"children": [1], "translation": [0, 5, 0]}])"));
  ASSERT_EQ(scene.nodes.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(scene.nodes[i].parent, i - 1);
  EXPECT_EQ(vec3(core::poseAt(scene, 0).nodeToWorld[scene.instances[0].node][3]), vec3(1, 5, 0));
}

TEST_F(Gltf, TextureTransformsAreBaked) {
  const std::string png = core::pngBytes({1, 1, 3, std::vector<std::uint8_t>{1, 2, 3}});
  write("white space.png", png);
  const std::string textured = R"("materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions":
      {"KHR_texture_transform": {"offset": [1, 2], "scale": [4, 5], "rotation": 1.5707963267948966}}}}}],
      "textures": [{"source": 0}], "images": [{"uri": "white%20space.png"}])";
  const Scene scene =
      load(replaced(quadWith("\"materials\": [{}]", textured), "\"mode\": 4", "\"mode\": 4, \"material\": 0"));
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].texels, (std::vector<std::uint8_t>{1, 2, 3, 255}));
  EXPECT_NEAR(scene.meshes[0].uvs[1].x, 1, 1e-5);  // (1, 0) scaled to (4, 0), turned counter-clockwise with v down
  EXPECT_NEAR(scene.meshes[0].uvs[1].y, -2, 1e-5);
}

TEST_F(Gltf, WhatIsNotSupportedIsToldOnce) {
  const Scene scene =
      load(replaced(quadWith("\"scene\": 0", R"("scene": 0, "extensionsUsed":
      ["KHR_animation_pointer", "KHR_materials_ior", "KHR_lights_punctual"])"),
                    "\"materials\": [{}]", R"("materials": [{"alphaMode": "BLEND"}, {"alphaMode": "MASK"}])"));
  EXPECT_EQ(scene.warnings,
            (std::vector<std::string>{"KHR_animation_pointer is not supported: its animations stay at rest",
                                      "KHR_materials_ior is not supported: the index of refraction is 1.5",
                                      "transparency (alphaMode) is not supported: its surfaces are opaque"}));
  EXPECT_TRUE(load(quadWith("\"mode\": 4", "\"mode\": 1")).instances.empty());
  EXPECT_EQ(load(quadWith("\"mode\": 4", "\"mode\": 1")).warnings.size(), 1u);
}

TEST_F(Gltf, RefusesWhatIsNotThere) {
  expectRefused(quadWith("quad.bin", "absent.bin"), "absent.bin is missing");
  expectRefused(quadWith("quad.bin", "/etc/hostname"), "by a path relative");
  expectRefused(quadWith("quad.bin", "http://example.com/a.bin"), "by a path relative");
  expectRefused(quadWith("quad.bin", "data:application/octet-stream;base64,AAAA"), "decode");
  expectRefused(quadWith("\"byteLength\": 96", "\"byteLength\": 97"), "mismatch");
  expectRefused(quadWith("\"materials\"", "\"images\": [{\"uri\": \"no.png\"}], \"materials\""), "no.png is missing");
  expectRefused(quadWith("\"nodes\": [0]", "\"nodes\": [7]"), "node 7");
  expectRefused(quadWith("\"mesh\": 0", "\"mesh\": 3"), "mesh 3");
  expectRefused(quadWith("\"mesh\": 0", "\"camera\": 0"), "camera 0");
  expectRefused(quadWith("\"scene\": 0", "\"scene\": 2"), "scene 2");
  expectRefused(quadWith("\"mode\": 4", "\"mode\": 4, \"material\": 9"), "material 9");
  expectRefused(quadWith("\"POSITION\": 0", "\"POSITION\": 12"), "accessor 12");
}

TEST_F(Gltf, RefusesNumbersBeyondTheirBytes) {
  for (const char* count : {"5", "4000000000", "18446744073709551615", "1537228672809129302"}) {
    expectRefused(quadWith("\"count\": 4", std::string("\"count\": ") + count), "beyond");
  }
  expectRefused(quadWith("\"count\": 6", "\"count\": 9"), "beyond");
  expectRefused(quadWith("\"byteOffset\": 64", "\"byteOffset\": 90"), "beyond");
  expectRefused(quadWith("\"byteOffset\": 64", "\"byteOffset\": 18446744073709551600"), "beyond");
  expectRefused(
      quadWith("\"bufferView\": 0, \"componentType\"", "\"bufferView\": 0, \"byteOffset\": 4, \"componentType\""),
      "beyond");
  expectRefused(quadWith("\"byteStride\": 4", "\"byteStride\": 8"), "beyond");
  expectRefused(quadWith("\"bufferView\": 2, \"componentType\": 5121", "\"bufferView\": 2, \"componentType\": 5130"),
                "component type");
  const std::string zeros = quadWith("\"bufferView\": 0, \"componentType\"", "\"componentType\"");
  expectRefused(replaced(zeros, "\"count\": 4", "\"count\": 4000000000"), "too many zeros");
}

TEST_F(Gltf, RefusesBrokenGeometry) {
  std::string bytes = quadBytes();
  bytes[48] = 4;
  write("quad.bin", bytes);
  expectRefused(kQuad, "index 4 is out of range of 4 vertices");
  bytes = quadBytes();
  const float infinite = core::kInfinity;
  std::memcpy(bytes.data() + 4, &infinite, 4);
  write("quad.bin", bytes);
  expectRefused(kQuad, "not finite");
  write("quad.bin", quadBytes());
  expectRefused(quadWith("\"count\": 6", "\"count\": 5"), "no whole triangles");
  expectRefused(quadWith("\"normalized\": true, \"count\": 4", "\"normalized\": true, \"count\": 3"),
                "differ in count");
  expectRefused(quadWith("\"mode\": 4", "\"mode\": 9"), "mode");
}

TEST_F(Gltf, RefusesTreesThatAreNone) {
  expectRefused(quadWith("[{\"mesh\": 0}]", "[{\"children\": [1]}, {\"children\": [0]}]"), "ancestor");
  expectRefused(quadWith("[{\"mesh\": 0}]", "[{\"children\": [0]}]"), "ancestor");
  expectRefused(quadWith("[{\"mesh\": 0}]", "[{\"children\": [2]}, {\"children\": [2]}, {}]"), "two parents");
  expectRefused(quadWith("[{\"mesh\": 0}]", "[{}, {\"children\": [0]}]"), "has a parent");
}

TEST_F(Gltf, RefusesBrokenImages) {
  const auto withImage = [](const std::string& image) {
    return quadWith("\"materials\": [{}]",
                    "\"materials\": [{}], \"textures\": [{\"source\": 0}], \"images\": [" + image + "]");
  };
  write("broken.png", core::pngBytes({9, 9, 3, std::vector<std::uint8_t>(243, 9)}).substr(0, 40));
  expectRefused(withImage("{\"uri\": \"broken.png\"}"), "cannot be decoded");
  write("text.png", "this is text, not an image at all");
  expectRefused(withImage("{\"uri\": \"text.png\"}"), "neither PNG nor JPEG");
  expectRefused(withImage("{\"bufferView\": 0, \"mimeType\": \"image/png\"}"), "neither PNG nor JPEG");
  expectRefused(replaced(withImage("{\"bufferView\": 4, \"mimeType\": \"image/png\"}"), "\"byteOffset\": 80",
                         "\"byteOffset\": 4000000000"),
                "beyond");
}

TEST_F(Gltf, RefusesWhatIsNoGltf2) {
  expectRefused("", "not glTF");
  expectRefused("hello", "not glTF");
  expectRefused("{", "cannot be read");
  expectRefused("{}", "cannot be read");
  expectRefused(quadWith("\"2.0\"", "\"1.0\""), "version 2.0");
  expectRefused(quadWith("\"2.0\"", "\"2.0\", \"minVersion\": \"2.1\""), "version 2.0");
  expectRefused(quadWith("\"scene\": 0", "\"scene\": 0, \"extensionsRequired\": [\"KHR_draco_mesh_compression\"]"),
                "KHR_draco");
  expectRefused("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}", "too deep");
  EXPECT_NE(errorOf(folder_ / "absent.gltf").find("no such file"), std::string::npos);
  EXPECT_NE(errorOf(folder_).find("not a regular file"), std::string::npos);
}

TEST_F(Gltf, RefusesBrokenAnimation) {
  const std::string animated = quadWith("\"scene\": 0", R"("scene": 0, "animations": [{"channels": [{"sampler": 0,
      "target": {"node": 0, "path": "translation"}}], "samplers": [{"input": 3, "output": 0}]}])");
  const auto withTimes = [&](const std::string& accessor) {
    return replaced(animated, "\"type\": \"VEC2\"}]", "\"type\": \"VEC2\"}, " + accessor + "]");
  };
  expectRefused(animated, "accessor 3");
  expectRefused(withTimes(R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "SCALAR"})"), "ascend");
  expectRefused(withTimes(R"({"bufferView": 3, "componentType": 5121, "count": 3, "type": "SCALAR"})"),
                "4 values for 3 keys");
  const Scene scene = load(withTimes(R"({"bufferView": 3, "componentType": 5121, "count": 4, "type": "SCALAR"})"));
  EXPECT_EQ(scene.nodes[0].translationTrack.times, (std::vector<float>{0, 1, 2, 3}));
}

TEST_F(Gltf, FlickerMustMakeSense) {
  const auto flickering = [](const std::string& emission) {
    return quadWith("\"materials\": [{}]",
                    "\"materials\": [{\"extras\": {\"twofold\": {\"emission\": " + emission + "}}}]");
  };
  EXPECT_EQ(load(flickering(R"({"times": [0, 1], "factors": [1, 0.5]})")).flickers.size(), 1u);
  expectRefused(flickering(R"({"times": [0, 1], "factors": [1]})"), "1 values for 2 keys");
  expectRefused(flickering(R"({"times": [1, 0], "factors": [1, 1]})"), "ascend");
  expectRefused(flickering(R"({"times": [0, 1], "factors": [1, -1]})"), "factor");
  expectRefused(flickering(R"({"times": [0], "factors": [1], "interpolation": "SINE"})"), "SINE");
}

TEST_F(Gltf, TruncatedGlbIsRefusedAtEveryLength) {
  const std::string bytes = core::glbBytes(everything());
  for (std::size_t length = 0; length < bytes.size(); length += length < 64 ? 1 : 37)
    EXPECT_NE(errorOf(write("cut.glb", bytes.substr(0, length))), "") << length;
}

TEST_F(Gltf, DamagedGlbNeverCrashes) {
  const std::string bytes = core::glbBytes(everything());
  int refused = 0;
  for (std::uint32_t trial = 0; trial < 300; ++trial) {
    core::Rng rng(1, core::Pass::other, trial, 0);
    std::string damaged = bytes;
    for (std::uint32_t i = 0; i <= trial % 4; ++i)
      damaged[rng.below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(rng.bits() >> 24);
    refused += errorOf(write("damaged.glb", damaged)) != "";
  }
  EXPECT_GT(refused, 75);   // most of the file is JSON, whose damage shows
  EXPECT_LT(refused, 300);  // numbers may change unseen
}

TEST_F(Gltf, SharedScenesLoad) {
  const fs::path scenes = sharedFolder() / "scenes";
  if (!fs::exists(scenes)) GTEST_SKIP() << "skipped: no shared data";
  for (const auto& entry : fs::recursive_directory_iterator(scenes)) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    const std::string error = errorOf(entry.path());
    const bool compressed = entry.path().filename() == "suzi.glb";
    EXPECT_EQ(error.find("KHR_draco") != std::string::npos, compressed) << error;
    EXPECT_TRUE(compressed || error.empty()) << error;
  }
}

TEST_F(Gltf, SharedBadFilesGiveASceneOrOneLine) {
  const fs::path bad = sharedFolder() / "bad_gltf";
  if (!fs::exists(bad)) GTEST_SKIP() << "skipped: no shared data";
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(bad)) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    EXPECT_EQ(errorOf(entry.path()).find('\n'), std::string::npos) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 100);
}
