// glTF metallic-roughness reflection: Lambert and GGX with visible-normal sampling, for one surface and viewer.
// Sources: glTF 2.0 specification, appendix B; Heitz, "Sampling the GGX Distribution of Visible Normals" (JCGT 2018).
#pragma once

#include "core/surface.h"

namespace core {

struct BsdfSample {
  vec3 direction{0};  ///< unit, world space, away from the surface
  float pdf = 0;      ///< solid angle; 0 = no sample
};

/// Reflection at one surface towards one viewer. Cheap to make (once per pixel), no virtual calls.
class Bsdf {
 public:
  /// toViewer: unit vector from the surface to the viewer.
  Bsdf(const Surface& surface, const vec3& toViewer);
  /// f(direction, viewer) |cos theta|, RGB, 1/sr; 0 below the geometric or shading horizon.
  vec3 evaluate(const vec3& direction) const;
  /// Density with which sample() returns direction, 1/sr.
  float pdf(const vec3& direction) const;
  /// u: three uniform numbers in [0, 1); u.z chooses the lobe.
  BsdfSample sample(const vec3& u) const;

 private:
  Frame frame_;
  vec3 geometricNormal_, viewer_;  // viewer_ in the shading frame
  vec3 diffuse_, f0_;
  float alpha_, specularProbability_;
};

}  // namespace core
