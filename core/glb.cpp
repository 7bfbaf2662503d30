#include "core/glb.h"

#include <map>
#include <nlohmann/json.hpp>

#include "core/check.h"
#include "core/files.h"
#include "core/png.h"

namespace core {
namespace {

using Json = nlohmann::json;

constexpr int kFloatType = 5126, kUnsignedIntType = 5125;
constexpr int kVertices = 34962, kIndices = 34963;  // targets of buffer views
const char* const kLights = "KHR_lights_punctual";
const char* const kStrength = "KHR_materials_emissive_strength";

template <class Vec>
Json array(const Vec& v) {
  Json numbers = Json::array();
  for (int i = 0; i < Vec::length(); ++i) numbers.push_back(v[i]);
  return numbers;
}

Json array(const quat& q) { return {q.x, q.y, q.z, q.w}; }

Json array(const mat4& m) {
  Json numbers = Json::array();
  for (int i = 0; i < 16; ++i) numbers.push_back(m[i / 4][i % 4]);
  return numbers;
}

/// A colour as factors of at most 1 and a strength, in double precision so that their product is the colour again.
struct Scaled {
  Json factors;
  double strength;
};
Scaled scaled(const vec3& color) {
  const double strength = maxComponent(color) > 1 ? maxComponent(color) : 1.0;
  return {{color.x / strength, color.y / strength, color.z / strength}, strength};
}

/// Builds the JSON and the binary chunk side by side.
class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {
    root_["asset"] = {{"version", "2.0"}, {"generator", "Twofold"}};
  }

  std::string write() {
    for (const Texture& texture : scene_.textures) addTexture(texture);
    for (const Material& material : scene_.materials) root_["materials"].push_back(materialOf(material));
    for (const Mesh& mesh : scene_.meshes) addMesh(mesh);
    for (const Node& node : scene_.nodes) root_["nodes"].push_back(nodeOf(node));
    addHierarchy();
    addInstances();
    addCameras();
    addLights();
    addAnimation();
    return container();
  }

 private:
  // ---- the binary chunk

  int addView(const void* bytes, std::size_t size, int target) {
    while (binary_.size() % 4 != 0) binary_.push_back('\0');
    Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}};
    if (target) view["target"] = target;
    binary_.append(static_cast<const char*>(bytes), size);
    return push("bufferViews", view);
  }

  template <class T>
  int addAccessor(const std::vector<T>& items, const char* type, int componentType, int target) {
    const int view = addView(items.data(), items.size() * sizeof(T), target);
    return push("accessors",
                {{"bufferView", view}, {"componentType", componentType}, {"count", items.size()}, {"type", type}});
  }

  int push(const char* list, const Json& item) {
    root_[list].push_back(item);
    return static_cast<int>(root_[list].size()) - 1;
  }

  void use(const char* extension) {
    for (const Json& name : root_["extensionsUsed"])
      if (name == extension) return;
    root_["extensionsUsed"].push_back(extension);
  }

  // ---- textures and materials

  void addTexture(const Texture& texture) {
    const std::string png = pngBytes({texture.width, texture.height, 4, texture.texels});
    const int view = addView(png.data(), png.size(), 0);
    const int image = push("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    const int sampler = push("samplers", {{"wrapS", wrapOf(texture.wrapU)}, {"wrapT", wrapOf(texture.wrapV)}});
    push("textures", {{"sampler", sampler}, {"source", image}});
  }

  static int wrapOf(Texture::Wrap wrap) {
    if (wrap == Texture::Wrap::clamp) return 33071;
    return wrap == Texture::Wrap::mirror ? 33648 : 10497;
  }

  Json materialOf(const Material& m) {
    Json pbr{{"metallicFactor", m.metallic}, {"roughnessFactor", m.roughness}};
    pbr["baseColorFactor"] = {m.baseColor.x, m.baseColor.y, m.baseColor.z, 1};
    if (m.baseColorTexture >= 0) pbr["baseColorTexture"]["index"] = m.baseColorTexture;
    if (m.metallicRoughnessTexture >= 0) pbr["metallicRoughnessTexture"]["index"] = m.metallicRoughnessTexture;
    Json json{{"pbrMetallicRoughness", pbr}};
    if (!m.name.empty()) json["name"] = m.name;
    if (m.emissionTexture >= 0) json["emissiveTexture"]["index"] = m.emissionTexture;
    if (m.normalTexture >= 0) json["normalTexture"] = {{"index", m.normalTexture}, {"scale", m.normalScale}};
    if (m.doubleSided) json["doubleSided"] = true;
    addEmission(m, json);
    return json;
  }

  void addEmission(const Material& m, Json& json) {
    if (m.flicker >= 0) json["extras"]["twofold"]["emission"] = flickerOf(scene_.flickers.at(m.flicker));
    if (!m.emits()) return;
    const Scaled emission = scaled(m.emission);
    json["emissiveFactor"] = emission.factors;
    if (emission.strength == 1) return;
    json["extensions"][kStrength]["emissiveStrength"] = emission.strength;
    use(kStrength);
  }

  static Json flickerOf(const Track& track) {
    if (track.interpolation == Interpolation::cubic) throw Error("flicker", "is a spline", "use linear or step keys");
    Json factors = Json::array();
    for (const vec4& value : track.values) factors.push_back(value.x);
    return {{"times", track.times}, {"factors", factors}, {"interpolation", nameOf(track.interpolation)}};
  }

  static const char* nameOf(Interpolation interpolation) {
    if (interpolation == Interpolation::cubic) return "CUBICSPLINE";
    return interpolation == Interpolation::step ? "STEP" : "LINEAR";
  }

  // ---- meshes and nodes

  void addMesh(const Mesh& mesh) {
    if (mesh.triangles.empty() || mesh.positions.empty())
      throw Error("mesh '" + mesh.name + "'", "has no triangles, which glTF cannot hold", "leave it out");
    const int positions = addAccessor(mesh.positions, "VEC3", kFloatType, kVertices);
    setBounds(positions, mesh.positions);
    Json attributes{{"POSITION", positions}};
    if (!mesh.normals.empty()) attributes["NORMAL"] = addAccessor(mesh.normals, "VEC3", kFloatType, kVertices);
    if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = addAccessor(mesh.uvs, "VEC2", kFloatType, kVertices);
    const int indices = addAccessor(mesh.triangles, "SCALAR", kUnsignedIntType, kIndices);
    root_["accessors"][indices]["count"] = 3 * mesh.triangles.size();
    Json json{{"primitives", {{{"attributes", attributes}, {"indices", indices}, {"material", mesh.material}}}}};
    if (!mesh.name.empty()) json["name"] = mesh.name;
    meshOf_[{push("meshes", json)}] = static_cast<int>(meshOf_.size());
  }

  template <class Vec>
  void setBounds(int accessor, const std::vector<Vec>& items) {
    Vec low = items.front(), high = items.front();
    for (const Vec& item : items) low = glm::min(low, item), high = glm::max(high, item);
    root_["accessors"][accessor]["min"] = array(low);
    root_["accessors"][accessor]["max"] = array(high);
  }

  static Json nodeOf(const Node& node) {
    Json json = Json::object();
    if (!node.name.empty()) json["name"] = node.name;
    if (node.hasMatrix) json["matrix"] = array(node.matrix);
    if (node.hasMatrix) return json;
    if (node.translation != vec3(0)) json["translation"] = array(node.translation);
    if (node.rotation != quat(1, 0, 0, 0)) json["rotation"] = array(node.rotation);
    if (node.scale != vec3(1)) json["scale"] = array(node.scale);
    return json;
  }

  void addHierarchy() {
    root_["scene"] = 0;
    root_["scenes"] = {Json::object()};
    for (int i = 0; i < static_cast<int>(scene_.nodes.size()); ++i) {
      const int parent = scene_.nodes[i].parent;
      Json& list = parent < 0 ? root_["scenes"][0]["nodes"] : root_["nodes"][parent]["children"];
      list.push_back(i);
    }
  }

  /// The node itself, or a new child of it where it holds a `key` already.
  Json& holder(int node, const char* key) {
    if (!root_["nodes"].at(node).contains(key)) return root_["nodes"][node];
    root_["nodes"][node]["children"].push_back(root_["nodes"].size());
    return root_["nodes"].emplace_back(Json::object());
  }

  /// A node with several meshes refers to a glTF mesh of several primitives.
  void addInstances() {
    std::map<int, std::vector<int>> meshesAt;
    for (const Instance& instance : scene_.instances) meshesAt[instance.node].push_back(instance.mesh);
    for (const auto& [node, meshes] : meshesAt) root_["nodes"].at(node)["mesh"] = groupOf(meshes);
  }

  int groupOf(const std::vector<int>& meshes) {
    const auto [place, isNew] = meshOf_.emplace(meshes, static_cast<int>(meshOf_.size()));
    if (!isNew) return place->second;
    Json primitives = Json::array();
    for (int mesh : meshes) primitives.push_back(root_["meshes"].at(mesh)["primitives"][0]);
    return push("meshes", {{"primitives", primitives}});
  }

  void addCameras() {
    for (const SceneCamera& camera : scene_.cameras) {
      Json json{{"type", "perspective"}, {"perspective", {{"yfov", camera.yfov}, {"znear", 0.01}}}};
      if (!camera.name.empty()) json["name"] = camera.name;
      holder(camera.node, "camera")["camera"] = push("cameras", json);
    }
  }

  void addLights() {
    for (std::size_t i = 0; i < scene_.punctual.size(); ++i) {
      use(kLights);
      root_["extensions"][kLights]["lights"].push_back(lightOf(scene_.punctual[i]));
      holder(scene_.punctual[i].node, "extensions")["extensions"][kLights]["light"] = i;
    }
  }

  static Json lightOf(const PunctualLight& light) {
    static const char* const names[] = {"point", "spot", "directional"};
    const Scaled intensity = scaled(light.intensity);
    Json json{{"type", names[static_cast<int>(light.type)]}};
    json["color"] = intensity.factors;
    json["intensity"] = intensity.strength;
    if (light.type == PunctualLight::Type::spot)
      json["spot"] = {{"innerConeAngle", light.innerAngle}, {"outerConeAngle", light.outerAngle}};
    return json;
  }

  // ---- animation

  void addAnimation() {
    Json animation{{"channels", Json::array()}, {"samplers", Json::array()}};
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
      addChannel(animation, i, "translation", scene_.nodes[i].translationTrack);
      addChannel(animation, i, "rotation", scene_.nodes[i].rotationTrack);
      addChannel(animation, i, "scale", scene_.nodes[i].scaleTrack);
    }
    if (!animation["channels"].empty()) root_["animations"].push_back(animation);
  }

  void addChannel(Json& animation, std::size_t node, const char* path, const Track& track) {
    if (track.empty()) return;
    const int output =
        path == std::string("rotation")
            ? addAccessor(track.values, "VEC4", kFloatType, 0)
            : addAccessor(std::vector<vec3>(track.values.begin(), track.values.end()), "VEC3", kFloatType, 0);
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    animation["samplers"].push_back(
        {{"input", timesOf(track.times)}, {"interpolation", nameOf(track.interpolation)}, {"output", output}});
  }

  /// Tracks of the same times share one accessor.
  int timesOf(const std::vector<float>& times) {
    const auto [place, isNew] = times_.emplace(times, 0);
    if (!isNew) return place->second;
    place->second = addAccessor(times, "SCALAR", kFloatType, 0);
    root_["accessors"][place->second]["min"] = {times.front()};
    root_["accessors"][place->second]["max"] = {times.back()};
    return place->second;
  }

  // ---- the file

  /// Header, JSON padded with spaces, binary padded with zeros. [glTF 2.0, section 4.4]
  std::string container() {
    while (binary_.size() % 4 != 0) binary_.push_back('\0');
    if (!binary_.empty()) root_["buffers"].push_back({{"byteLength", binary_.size()}});
    std::string json = root_.dump();
    while (json.size() % 4 != 0) json.push_back(' ');
    std::string bytes = "glTF";
    appendWord(bytes, 2);
    appendWord(bytes, 20 + json.size() + (binary_.empty() ? 0 : 8 + binary_.size()));
    appendWord(bytes, json.size());
    bytes += "JSON" + json;
    if (binary_.empty()) return bytes;
    appendWord(bytes, binary_.size());
    return bytes + std::string("BIN\0", 4) + binary_;
  }

  static void appendWord(std::string& bytes, std::size_t value) {
    if (value > 0xffffffffu) throw Error("scene", "needs more than the 4 GiB of a GLB", "make it smaller");
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
  }

  const Scene& scene_;
  Json root_;
  std::string binary_;
  std::map<std::vector<int>, int> meshOf_;   ///< glTF mesh by the scene's meshes it holds
  std::map<std::vector<float>, int> times_;  ///< accessor by key times
};

}  // namespace

std::string glbBytes(const Scene& scene) { return Writer(scene).write(); }

void saveGlb(const Scene& scene, const std::filesystem::path& path) { writeFileAtomically(path, glbBytes(scene)); }

}  // namespace core
