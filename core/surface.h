// What one pixel knows of the surface it sees: one cache line, fetched whole at random addresses.
#pragma once

#include "core/guide.h"
#include "core/maths.h"

namespace core {

/// Surface seen by a pixel, world space. id = kNoId where nothing was hit.
struct Surface {
  vec3 position{0};
  float roughness = 1;      ///< perceptual, alpha = roughness^2
  vec3 geometricNormal{0};  ///< unit, towards the viewer
  float metallic = 0;
  vec3 normal{0};            ///< unit shading normal, in the viewer's half space
  std::uint32_t id = kNoId;  ///< instance
  vec3 baseColor{0};
  std::uint32_t primitive = 0;  ///< triangle of the instance's mesh

  bool hit() const { return id != kNoId; }
};
static_assert(sizeof(Surface) == 64);

/// What the filter divides radiance by: (1 - metallic) base colour + F0, at least 1e-3.
inline vec3 demodulationAlbedo(const Surface& s) {
  const vec3 f0 = lerp(vec3(0.04f), s.baseColor, s.metallic);
  return glm::max((1 - s.metallic) * s.baseColor + f0, vec3(1e-3f));
}

}  // namespace core
