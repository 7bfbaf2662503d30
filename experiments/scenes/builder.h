// Puts a scene together: materials, meshes, nodes and what hangs on them, instances in the order of their nodes.
#pragma once

#include "core/scene.h"

namespace experiments {

/// Where a node stands relative to its parent.
struct Place {
  core::vec3 position{0};
  core::vec3 size{1};
  core::quat rotation{1, 0, 0, 0};
  int parent = -1;
};

/// Rotation by degrees around an axis of unit length.
core::quat turn(float degrees, const core::vec3& axis = core::vec3(0, 1, 0));

/// Rotation of a camera or a spot light at `from` that looks at `to`, y up.
core::quat lookAt(const core::vec3& from, const core::vec3& to);

/// A dielectric of one colour.
core::Material matte(const std::string& name, const core::vec3& color, float roughness = 1);
/// A black surface that shines.
core::Material emitter(const std::string& name, const core::vec3& radiance);

class SceneBuilder {
 public:
  explicit SceneBuilder(const std::string& name) { scene_.name = name; }

  int texture(core::Texture texture);
  int material(core::Material material);
  int flicker(core::Track track);
  int mesh(const std::string& name, core::Mesh shape, int material);
  int node(const std::string& name, const Place& place);
  /// A new node with an instance of the mesh; returns the node.
  int add(const std::string& name, int mesh, const Place& place);
  void camera(int node, float yfovDegrees);
  void light(core::PunctualLight light, int node);

  core::Material& materialAt(int index) { return scene_.materials[index]; }
  core::Node& nodeAt(int index) { return scene_.nodes[index]; }
  core::Scene take() { return std::move(scene_); }

 private:
  core::Scene scene_;
};

}  // namespace experiments
