// The target function p-hat: luminance of the light that one sample sends to the viewer, occlusion ignored.
// Source: Bitterli et al. 2020, section 2.3. Measure: core/lights.h.
#pragma once

#include "core/lights.h"
#include "core/material.h"

namespace restir {

using core::BsdfValue;
using core::Incident;
using core::LightFeatures;
using core::Lights;
using core::LightSample;
using core::Surface;
using core::vec3;

/// One surface, seen from one place, under the lights of one instant. Cheap to make; lights must outlive it.
template <LightFeatures F>
class Target {
 public:
  Target(const Surface& surface, const vec3& viewer, const Lights& lights)
      : bsdf_(surface, normalize(viewer - surface.position)), position_(surface.position), lights_(&lights) {}

  /// p-hat(y) = luminance(f cos L_e G); 0 for no sample.
  float operator()(const LightSample& y) const { return y.valid() ? core::luminance(radiance(incident(y))) : 0.0f; }

  Incident incident(const LightSample& y) const { return lights_->template incident<F>(y, position_); }
  /// f cos L_e G, unshadowed.
  vec3 radiance(const Incident& in) const {
    const vec3 flux = in.flux();
    return core::maxComponent(flux) > 0 ? bsdf_.evaluate(in.direction) * flux : vec3(0);
  }
  const core::Bsdf& bsdf() const { return bsdf_; }
  const Lights& lights() const { return *lights_; }

 private:
  core::Bsdf bsdf_;
  vec3 position_;
  const Lights* lights_;
};

}  // namespace restir
