// One light sample and one BSDF sample at a time, combined.
#include "restir/direct.h"

#include "core/lattice.h"
#include "core/material.h"
#include "restir/visibility.h"

namespace restir {
namespace {

using core::Incident;
using core::Lattice3;
using core::LightFeatures;
using core::Lights;
using core::LightSample;
using core::Rng;
using core::vec3;

/// A surface, its reflection to the camera, and what lights it.
struct Receiver {
  const core::Surface& surface;
  core::Bsdf bsdf;
  vec3 origin;
  const Lights& lights;
  const core::LightChoice& choice;  // of lights
  const core::Tracer& tracer;
};

/// f cos L_e G over the densities of both techniques: what either adds to the estimate, before visibility. lightPdf: of
/// y by light sampling; called only where y shines.
template <class LightPdf>
vec3 weighted(const Receiver& r, const LightSample& y, const Incident& in, LightPdf&& lightPdf) {
  const vec3 flux = in.flux();
  if (!(core::maxComponent(flux) > 0)) return vec3(0);
  const core::BsdfValue bsdf = r.bsdf.value(in.direction);
  const float bsdfPdf = r.lights.isHittable(y.light) ? bsdf.pdf * in.geometry : 0.0f;
  return bsdf.f * flux / (lightPdf() + bsdfPdf);  // [Veach 97, 9.2.2] balance heuristic, one sample each
}

template <LightFeatures F>
vec3 lightSample(const Receiver& r, const std::array<std::uint32_t, 3>& u, Rng& rng) {
  const std::uint32_t lowBits = rng.bits();
  const core::LightDraw drawn =
      r.choice.sample(r.surface.position, r.surface.normal, {u[0], lowBits, {u[1], u[2]}}, rng);
  const Incident in = r.lights.template incident<F>(drawn.sample, r.surface.position);
  const vec3 value = weighted(r, drawn.sample, in, [&] { return drawn.pdf; });
  return core::maxComponent(value) > 0 && visible(r.tracer, r.surface, in) ? value : vec3(0);
}

template <LightFeatures F>
vec3 bsdfSample(const Receiver& r, const std::array<std::uint32_t, 3>& u) {
  const core::BsdfSample s = r.bsdf.sample({Lattice3::uniform(u[0]), Lattice3::uniform(u[1]), Lattice3::uniform(u[2])});
  if (!(s.pdf > 0)) return vec3(0);
  const core::Hit hit = r.tracer.intersect(r.origin, s.direction);
  const LightSample y = hit.hit() ? LightSample{r.lights.lightOf(hit.instance, hit.primitive), hit.barycentric}
                                  : r.lights.environmentAt(s.direction);
  if (!y.valid()) return vec3(0);
  return weighted(r, y, r.lights.template incident<F>(y, r.surface.position),
                  [&] { return r.choice.pdf(y, r.surface.position, r.surface.normal); });
}

template <LightFeatures F>
vec3 mean(const Receiver& r, int samples, Rng& rng) {
  const Lattice3 lightPoints(rng), bsdfPoints(rng);
  vec3 sum(0);
  for (int i = 0; i < samples; ++i) {
    sum += lightSample<F>(r, lightPoints.bits(static_cast<std::uint32_t>(i)), rng);
    if (r.lights.anyHittable()) sum += bsdfSample<F>(r, bsdfPoints.bits(static_cast<std::uint32_t>(i)));
  }
  return sum / static_cast<float>(samples);
}

}  // namespace

vec3 meanDirect(const core::Moment& moment, const core::Surface& surface, const core::LightChoice& choice, int samples,
                Rng rng) {
  CHECK_GE(samples, 1);
  if (!surface.hit() || moment.lights->empty()) return vec3(0);
  const Receiver receiver{surface,
                          core::Bsdf(surface, normalize(moment.cameraPosition - surface.position)),
                          core::offsetOrigin(surface.position, surface.geometricNormal),
                          *moment.lights,
                          choice,
                          *moment.tracer};
  vec3 result(0);
  core::withFeatures(moment.lights->features(), [&]<LightFeatures F>() { result = mean<F>(receiver, samples, rng); });
  return result;
}

vec3 meanDirect(const core::Moment& moment, const core::Surface& surface, int samples, std::uint64_t stream,
                std::uint32_t pixel) {
  const core::LightChoice byPower(*moment.lights, core::LightSampler::power);
  return meanDirect(moment, surface, byPower, samples, {stream, core::Pass::reference, pixel, moment.frame});
}

}  // namespace restir
