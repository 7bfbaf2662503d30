// Axis-aligned boxes around meshes and scenes.
#pragma once

#include <span>

#include "core/scene.h"

namespace core {

/// Empty until something is added.
struct Bounds {
  vec3 low{kInfinity}, high{-kInfinity};

  bool empty() const { return !(low.x <= high.x); }
  void add(const vec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  /// Corner 0 to 7.
  vec3 corner(int i) const { return {(i & 1 ? high : low).x, (i & 2 ? high : low).y, (i & 4 ? high : low).z}; }
};

/// Per mesh, in its own space.
inline std::vector<Bounds> meshBounds(const Scene& scene) {
  std::vector<Bounds> bounds(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (const vec3& p : scene.meshes[m].positions) bounds[m].add(p);
  return bounds;
}

/// Around the boxes of all instances in world space; a cube of side 2 around the origin where there are none.
inline Bounds sceneBounds(const Scene& scene, std::span<const Bounds> meshes, std::span<const mat4> nodeToWorld) {
  Bounds all;
  for (const Instance& instance : scene.instances) {
    const Bounds& box = meshes[instance.mesh];
    for (int i = 0; i < 8 && !box.empty(); ++i) all.add(vec3(nodeToWorld[instance.node] * vec4(box.corner(i), 1)));
  }
  return all.empty() ? Bounds{vec3(-1), vec3(1)} : all;
}

}  // namespace core
