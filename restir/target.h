// The target function p-hat: luminance of the light that one sample sends to the viewer, occlusion ignored or included.
// Source: Bitterli et al. 2020, section 2.3. Measure: core/lights.h.
//
// Included, p-hat V traces a shadow ray from its own surface through the geometry of its own instant, in every merge
// and every denominator. Candidates are resampled with p-hat alone, and a fresh sample that is hidden gets W = 0: with
// E[W g] = sum of g over the support of p-hat, E[W V g] is the sum over the support of p-hat V.
#pragma once

#include "core/lights.h"
#include "core/material.h"
#include "restir/visibility.h"

namespace restir {

using core::BsdfValue;
using core::Incident;
using core::LightFeatures;
using core::Lights;
using core::LightSample;
using core::Surface;
using core::vec3;

/// One surface, seen from one place, under the lights of one instant. Cheap to make; lights must outlive it.
template <LightFeatures F, bool kVisibility = false>
class Target;

template <LightFeatures F>
class Target<F, false> {
 public:
  Target(const Surface& surface, const vec3& viewer, const Lights& lights)
      : bsdf_(surface, normalize(viewer - surface.position)), position_(surface.position), lights_(&lights) {}

  /// p-hat(y) = luminance(f cos L_e G); 0 for no sample.
  float operator()(const LightSample& y) const { return y.valid() ? core::luminance(radiance(incident(y))) : 0.0f; }

  /// y: a LightSample or a PresampledLight.
  template <class Y>
  Incident incident(const Y& y) const {
    return lights_->template incident<F>(y, position_);
  }
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

/// p-hat V. tracer: the geometry of the same instant; it and the surface must outlive this.
template <LightFeatures F>
class Target<F, true> : public Target<F, false> {
 public:
  Target(const Surface& surface, const vec3& viewer, const Lights& lights, const core::Tracer& tracer)
      : Target<F, false>(surface, viewer, lights), surface_(&surface), tracer_(&tracer) {}

  float operator()(const LightSample& y) const {
    const float unshadowed = Target<F, false>::operator()(y);
    return unshadowed > 0 && visible(*tracer_, *surface_, this->incident(y)) ? unshadowed : 0.0f;
  }

 private:
  const Surface* surface_;
  const core::Tracer* tracer_;
};

}  // namespace restir
