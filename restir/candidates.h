// Fresh candidates of one pixel: light samples and BSDF samples, combined by the balance heuristic.
//
// p-hat ignores occlusion, so a reservoir must be an unbiased estimate over every light point that p-hat sees, also
// those that something hides from this pixel: a neighbour or the next frame may see them. Light sampling draws hidden
// points. A BSDF ray that stopped at its first hit would not, yet the balance heuristic would still count its density
// there, and the energy of hidden points would be lost on reuse. So a BSDF sample passes through occluders: its ray is
// followed through the emitters alone, and every one on it is a candidate of that one sample; so is the environment at
// its end. Then the density of light point y is exactly pdf(direction) x (area cos_light / d^2, or d omega / d(u, v)),
// hidden or not. With n batches of L light and B BSDF samples, the balance heuristic gives every candidate the weight
//   [candidates 1]  w = p-hat(y) / (n (L p_light(y) + B p_bsdf(y)))
// B need not be whole: then the last BSDF sample of a batch is drawn with the probability that is left, whatever the
// batch has found, and the mean of the sum over candidates stays.
#pragma once

#include "core/tracer.h"
#include "restir/light_tiles.h"
#include "restir/reservoir.h"
#include "restir/target.h"

namespace restir {

struct CandidateParameters {
  int lightSamples = 8;    ///< a batch
  double bsdfSamples = 1;  ///< a batch; a fraction is a probability
  /// Factor on them where lights outgrow the cache: a ray through a tree of so many emitters costs as much as dozens of
  /// light samples, and finds no more of their light than it would of a few.
  double bsdfShareOfMany = 0.25;
  TileUse lightTiles = TileUse::automatic;
};

/// B of [candidates 1] for these lights.
inline double bsdfSamplesFor(const CandidateParameters& p, const Lights& lights) {
  return p.bsdfSamples * (lights.size() >= LightTiles::kManyLights ? p.bsdfShareOfMany : 1);
}

/// A BSDF ray meets at most this many emitters; more along one line are dropped (their energy is lost).
inline constexpr int kMostEmittersOnARay = 64;

/// Finds every emitter on a ray, through occluders, nearest first. Emitters closer together than a millionth of their
/// distance count as one. Embree's rounding grows with coordinates, not with distance, so the triangle just met is also
/// known by its number: a flat triangle lies on a ray once.
struct ThroughOccluders {
  template <class Body>
  void operator()(const core::Tracer& tracer, const Lights& lights, const vec3& origin, const vec3& direction,
                  Body&& body) const {
    float minimum = 0;
    core::Hit last;
    for (int i = 0; i < kMostEmittersOnARay; ++i) {
      const core::Hit hit = tracer.intersectLights(origin, direction, minimum);
      if (!hit.hit()) return;
      if (hit.instance != last.instance || hit.primitive != last.primitive)
        body(LightSample{lights.lightOf(hit.instance, hit.primitive), hit.barycentric});
      last = hit;
      minimum = hit.distance * (1 + 0x1p-20f);  // beyond the rounding with which Embree would find it again
    }
  }
};

/// Streams batches into one builder, as part of `total` batches in all. tile: what light samples are drawn from, empty
/// for the lights themselves. Walk: what a BSDF ray finds; anything but the default is there to show in tests what goes
/// wrong.
template <LightFeatures F, class Walk = ThroughOccluders>
class Candidates {
 public:
  Candidates(const Target<F>& target, const Surface& surface, const core::Tracer& tracer,
             const CandidateParameters& parameters, int total, std::span<const core::PresampledLight> tile = {})
      : target_(target),
        tracer_(tracer),
        lightSamples_(parameters.lightSamples),
        bsdfSamples_(bsdfSamplesFor(parameters, target.lights())),
        origin_(core::offsetOrigin(surface.position, surface.geometricNormal)),
        total_(total),
        tile_(tile) {}

  void addBatch(core::Rng& rng, ReservoirBuilder& builder) const {
    const Lights& lights = target_.lights();
    if (lights.empty()) return;
    addLightSamples(rng, builder);
    if (!lights.anyHittable()) return;
    const int whole = static_cast<int>(bsdfSamples_);
    const double rest = bsdfSamples_ - whole;
    const int count = whole + (rest > 0 && rng.uniform() < rest);
    for (int i = 0; i < count; ++i) {
      const core::BsdfSample s = target_.bsdf().sample(rng.uniform3());
      if (s.pdf > 0) follow(s.direction, rng, builder);
    }
  }

 private:
  void addLightSamples(core::Rng& rng, ReservoirBuilder& builder) const {
    const Lights& lights = target_.lights();
    for (int i = 0; i < lightSamples_; ++i) {
      if (tile_.empty()) {
        const LightSample y = lights.sample(rng);
        add(y, target_.incident(y), lights.pdf(y), rng, builder);
      } else {
        const core::PresampledLight& y = tile_[rng.below(LightTiles::kTileSize)];
        add(y.sample, target_.incident(y), y.pdf, rng, builder);
      }
    }
  }

  /// What a BSDF ray finds: triangles, and behind them all the environment.
  void follow(const vec3& direction, core::Rng& rng, ReservoirBuilder& builder) const {
    const Lights& lights = target_.lights();
    const auto found = [&](const LightSample& y) { add(y, target_.incident(y), lights.pdf(y), rng, builder); };
    if (lights.triangleCount() > 0) Walk()(tracer_, lights, origin_, direction, found);
    if constexpr (F.punctual)
      if (const LightSample y = lights.environmentAt(direction); y.valid()) found(y);
  }

  /// lightPdf: density with which light samples give y.
  void add(const LightSample& y, const Incident& in, float lightPdf, core::Rng& rng, ReservoirBuilder& builder) const {
    const vec3 flux = in.flux();
    if (!(core::maxComponent(flux) > 0)) return;
    const BsdfValue bsdf = target_.bsdf().value(in.direction);
    const float target = core::luminance(bsdf.f * flux);
    const double bsdfPdf = target_.lights().isHittable(y.light) ? double{bsdf.pdf} * in.geometry : 0.0;
    const double density = lightSamples_ * double{lightPdf} + bsdfSamples_ * bsdfPdf;
    builder.add(y, target, target / (total_ * density), rng);  // [candidates 1]
  }

  const Target<F>& target_;
  const core::Tracer& tracer_;
  int lightSamples_;
  double bsdfSamples_;
  vec3 origin_;
  double total_;
  std::span<const core::PresampledLight> tile_;
};

}  // namespace restir
