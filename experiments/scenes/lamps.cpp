// Many lights: a hall with pillars under N small emissive triangles of one mesh, most of them far from or hidden from
// any one point. Total power does not depend on N. Their radiance comes from a texture, one texel a triangle.
#include <charconv>

#include "core/check.h"
#include "core/random.h"
#include "experiments/scenes/builder.h"
#include "experiments/scenes/builtin.h"
#include "experiments/scenes/shapes.h"

namespace experiments {
namespace {

using core::vec2;
using core::vec3;

constexpr std::string_view kPrefix = "lamps-";
constexpr int kMostLamps = 4'000'000;
constexpr float kWidth = 40, kDepth = 30, kHeight = 7;  // of the hall, metres
constexpr int kTexels = 16;                             // on a side
constexpr float kBrightest = 300;                       // radiance of a white texel

/// Colours of two decades of brightness.
core::Texture lampColours() {
  core::Texture t{kTexels, kTexels, std::vector<std::uint8_t>(4 * kTexels * kTexels, 255)};
  for (int i = 0; i < kTexels * kTexels; ++i) {
    core::Rng rng(7, core::Pass::other, static_cast<std::uint32_t>(i), 0);
    const float level = std::pow(10.0f, -2 * rng.uniform());
    const vec3 tint(1, 0.5f + 0.5f * rng.uniform(), 0.25f + 0.75f * rng.uniform());
    for (int c = 0; c < 3; ++c)
      t.texels[4 * i + c] = static_cast<std::uint8_t>(std::lround(255 * std::pow(level * tint[c], 1 / 2.2f)));
  }
  return t;
}

/// A triangle around a point, of some area, facing anywhere but mostly down.
void addLamp(core::Mesh& mesh, core::Rng& rng, float area) {
  const vec3 centre((rng.uniform() - 0.5f) * (kWidth - 1), 3 + (kHeight - 3.3f) * rng.uniform(),
                    (rng.uniform() - 0.5f) * (kDepth - 1));
  const vec2 tilt = 1.6f * (rng.uniform2() - 0.5f);
  const vec3 normal = normalize(vec3(tilt.x, -1, tilt.y)), u = normalize(cross(normal, vec3(0.3f, 0.1f, 1)));
  const vec3 v = cross(normal, u);
  const float side = std::sqrt(area * 4 / std::sqrt(3.0f)), height = side * std::sqrt(3.0f) / 2;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {centre - 0.5f * side * u - height / 3 * v,
                                               centre + 0.5f * side * u - height / 3 * v, centre + 2 * height / 3 * v});
  mesh.normals.insert(mesh.normals.end(), 3, cross(u, v));
  const vec2 texel(rng.below(kTexels), rng.below(kTexels));
  mesh.uvs.insert(mesh.uvs.end(), 3, (texel + 0.5f) / static_cast<float>(kTexels));
  mesh.triangles.push_back({first, first + 1, first + 2});
}

core::Mesh lampMesh(int count) {
  constexpr float kArea = 24;  // of all lamps, square metres
  core::Mesh mesh;
  mesh.positions.reserve(3 * static_cast<std::size_t>(count));
  mesh.uvs.reserve(3 * static_cast<std::size_t>(count));
  mesh.normals.reserve(3 * static_cast<std::size_t>(count));
  mesh.triangles.reserve(static_cast<std::size_t>(count));
  constexpr float kMeanSpread = 2.15f;  // of 10^(2 u - 1), u uniform: (10 - 0.1) / ln 100
  for (int i = 0; i < count; ++i) {
    core::Rng rng(8, core::Pass::other, static_cast<std::uint32_t>(i), 0);
    const float spread = std::pow(10.0f, 2 * rng.uniform() - 1) / kMeanSpread;
    addLamp(mesh, rng, spread * kArea / static_cast<float>(count));
  }
  return mesh;
}

void addHall(SceneBuilder& scene) {
  core::Material polished = matte("floor", {0.45f, 0.42f, 0.4f}, 0.35f);
  const int floor = scene.mesh("floor", quadMesh(), scene.material(polished));
  const int wall = scene.mesh("wall", quadMesh(), scene.material(matte("wall", {0.7f, 0.68f, 0.62f})));
  const vec3 x(1, 0, 0);
  scene.add("floor", floor, {vec3(0), {kWidth, kDepth, 1}, turn(-90, x)});
  scene.add("ceiling", wall, {{0, kHeight, 0}, {kWidth, kDepth, 1}, turn(90, x)});
  scene.add("back", wall, {{0, kHeight / 2, -kDepth / 2}, {kWidth, kHeight, 1}});
  scene.add("left", wall, {{-kWidth / 2, kHeight / 2, 0}, {kDepth, kHeight, 1}, turn(90)});
  scene.add("right", wall, {{kWidth / 2, kHeight / 2, 0}, {kDepth, kHeight, 1}, turn(-90)});
}

void addPillars(SceneBuilder& scene) {
  const int pillar = scene.mesh("pillar", cylinderMesh(24), scene.material(matte("stone", {0.6f, 0.55f, 0.5f}, 0.8f)));
  core::Material metal = matte("metal", {0.9f, 0.7f, 0.4f}, 0.3f);
  metal.metallic = 1;
  const int ball = scene.mesh("ball", sphereMesh(4), scene.material(metal));
  const int screen = scene.mesh("screen", boxMesh(), scene.material(matte("screen", {0.3f, 0.45f, 0.55f})));
  for (int i = -3; i <= 3; ++i)
    for (int j = -2; j <= 2; ++j) {
      const vec3 at(5.5f * i, 0, 5.5f * j);
      scene.add("pillar", pillar, {at + vec3(0, kHeight / 2, 0), {1, kHeight, 1}});
      if ((i + j) % 2 == 0) scene.add("ball", ball, {at + vec3(2.7f, 0.8f, 2.2f), vec3(1.6f)});
      if ((i + j) % 2 != 0)
        scene.add("screen", screen, {at + vec3(2.6f, 0.7f, 0.4f), {2.2f, 1.4f, 0.15f}, turn(25.0f * i)});
    }
}

}  // namespace

int lampsIn(std::string_view name) {
  if (!name.starts_with(kPrefix)) return 0;
  name.remove_prefix(kPrefix.size());
  int count = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), count);
  return error == std::errc{} && end == name.data() + name.size() && count >= 1 && count <= kMostLamps ? count : 0;
}

bool isLamps(const std::string& name) {
  return name.starts_with(kPrefix) && name.find_first_of("./\\") == std::string::npos;  // no file
}

core::Scene lampsScene(const std::string& name) {
  const int count = lampsIn(name);
  if (count == 0)
    throw core::UsageError(name, "that is no number of lamps", "lamps-N takes a whole N from 1 to 4000000");
  SceneBuilder scene(name);
  addHall(scene);
  addPillars(scene);
  core::Material shine = emitter("lamps", vec3(kBrightest));
  shine.emissionTexture = scene.texture(lampColours());
  scene.add("lamps", scene.mesh("lamps", lampMesh(count), scene.material(shine)), {});
  const vec3 eye(2.2f, 2.9f, 14.2f);
  const int camera = scene.node("camera", {eye, vec3(1), lookAt(eye, {-1, 1.5f, -4})});
  core::Node& node = scene.nodeAt(camera);
  node.translationTrack.times = {0, 10};
  node.translationTrack.values = {core::vec4(eye, 0), core::vec4(eye + vec3(4, 0, -1), 0)};
  scene.camera(camera, 50);
  return scene.take();
}

}  // namespace experiments
