// Rays against a scene at an instant (Embree). One tree per mesh is built once and shared; instances that move only
// rebuild the small tree above them.
#pragma once

#include <cstdint>
#include <memory>

#include "core/scene.h"

namespace core {

inline constexpr int kPacket = 8;  ///< primary rays traced together

struct Hit {
  float distance = kInfinity;
  std::uint32_t instance = 0xffffffffu, primitive = 0;
  vec2 barycentric{0};  ///< weights of the triangle's second and third vertex
  vec3 normal{0};       ///< unnormalised geometric normal in object space
  bool hit() const { return instance != 0xffffffffu; }
};

/// Trees of all meshes of a scene; immutable, shared by the tracers of every instant.
class MeshTrees;
std::shared_ptr<const MeshTrees> buildMeshTrees(const Scene& scene);

/// Answers rays at one instant. All members are safe to call from many threads.
class Tracer {
 public:
  Tracer(std::shared_ptr<const MeshTrees> trees, const Scene& scene, const Pose& pose);
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Nearest hit along origin + t direction, t in (0, maximum].
  Hit intersect(const vec3& origin, const vec3& direction, float minimum = 0, float maximum = kInfinity) const;
  /// Nearest hits of kPacket coherent rays from one origin; directions beyond count are ignored.
  void intersectPacket(const vec3& origin, const vec3* directions, int count, Hit* hits) const;
  /// Nearest hit among emissive meshes only: occluders are passed through.
  Hit intersectLights(const vec3& origin, const vec3& direction, float minimum = 0) const;
  /// True if anything lies between origin and origin + maximum * direction.
  bool occluded(const vec3& origin, const vec3& direction, float maximum) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Origin of a ray that leaves a surface: moved along the geometric normal by a few units in the last place.
/// Source: Wachter and Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems (2019).
vec3 offsetOrigin(const vec3& position, const vec3& geometricNormal);

}  // namespace core
