#include "experiments/scenes/builder.h"

namespace experiments {
namespace {

template <class T>
int put(std::vector<T>& list, T item) {
  list.push_back(std::move(item));
  return static_cast<int>(list.size()) - 1;
}

}  // namespace

core::quat turn(float degrees, const core::vec3& axis) { return glm::angleAxis(glm::radians(degrees), axis); }

core::quat lookAt(const core::vec3& from, const core::vec3& to) {
  return glm::quatLookAt(normalize(to - from), core::vec3(0, 1, 0));
}

core::Material matte(const std::string& name, const core::vec3& color, float roughness) {
  core::Material m;
  m.name = name;
  m.baseColor = color;
  m.metallic = 0;
  m.roughness = roughness;
  return m;
}

core::Material emitter(const std::string& name, const core::vec3& radiance) {
  core::Material m = matte(name, core::vec3(0));
  m.emission = radiance;
  return m;
}

int SceneBuilder::texture(core::Texture texture) { return put(scene_.textures, std::move(texture)); }

int SceneBuilder::material(core::Material material) { return put(scene_.materials, std::move(material)); }

int SceneBuilder::flicker(core::Track track) { return put(scene_.flickers, std::move(track)); }

int SceneBuilder::mesh(const std::string& name, core::Mesh shape, int material) {
  shape.name = name;
  shape.material = material;
  return put(scene_.meshes, std::move(shape));
}

int SceneBuilder::node(const std::string& name, const Place& place) {
  core::Node n;
  n.name = name;
  n.parent = place.parent;
  n.translation = place.position;
  n.rotation = place.rotation;
  n.scale = place.size;
  return put(scene_.nodes, std::move(n));
}

int SceneBuilder::add(const std::string& name, int mesh, const Place& place) {
  const int at = node(name, place);
  scene_.instances.push_back({mesh, at});
  return at;
}

void SceneBuilder::camera(int node, float yfovDegrees) {
  scene_.cameras.push_back({"camera", glm::radians(yfovDegrees), node});
}

void SceneBuilder::light(core::PunctualLight light, int node) {
  light.node = node;
  scene_.punctual.push_back(light);
}

}  // namespace experiments
