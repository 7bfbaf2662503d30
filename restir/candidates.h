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
//
// Power knows nothing of distance: close to one lamp of many, few candidates are of it, and each of them weighs much. T
// samples a batch from a light tree draw it often. To know the tree's density of every candidate would cost more than
// all else here, so what the others chose, y of weight W, joins the tree's samples as one more candidate, and the
// balance heuristic is between the two:
//   [candidates 2]  w = p-hat(y) / (n (L p_light(y) + B p_bsdf(y) + T p_tree(y)))                 for a tree's sample
//   [candidates 3]  w = p-hat(y) W (L p_light + B p_bsdf) / (L p_light + B p_bsdf + T p_tree)     for what was chosen
// W is an unbiased estimate of 1 / density (reservoir.h), so the sum over both has the mean it would have had.
#pragma once

#include "core/check.h"
#include "core/light_choice.h"
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
  int treeSamples = 0;  ///< a batch, from a light tree
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
/// for the lights themselves. tree: what tree samples are drawn from, needed if there are any. Walk: what a BSDF ray
/// finds; anything but the default is there to show in tests what goes wrong.
template <LightFeatures F, class Walk = ThroughOccluders>
class Candidates {
 public:
  Candidates(const Target<F>& target, const Surface& surface, const core::Tracer& tracer,
             const CandidateParameters& parameters, int total, std::span<const core::PresampledLight> tile = {},
             const core::LightChoice* tree = nullptr)
      : target_(target),
        surface_(surface),
        tracer_(tracer),
        lightSamples_(parameters.lightSamples),
        bsdfSamples_(bsdfSamplesFor(parameters, target.lights())),
        origin_(core::offsetOrigin(surface.position, surface.geometricNormal)),
        total_(total),
        tile_(tile),
        treeSamples_(parameters.treeSamples),
        tree_(tree) {
    CHECK(treeSamples_ == 0 || tree_ != nullptr);
  }

  /// Every batch, batch i from random numbers rngOf(i).
  template <class RngOf>
  ReservoirBuilder draw(RngOf&& rngOf) const {
    ReservoirBuilder chosen, all;
    for (int i = 0; i < total_; ++i) {
      core::Rng rng = rngOf(i);
      addBatch(rng, chosen);
      if (treeSamples_ == 0) continue;
      addTreeSamples(rng, all);
      if (i + 1 == total_) addChosen(chosen, rng, all);
    }
    return treeSamples_ == 0 ? chosen : all;
  }

  /// Light and BSDF samples.
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

  /// A batch of tree samples, as if whatever the others chose were to join them.
  void addTreeSamples(core::Rng& rng, ReservoirBuilder& builder) const {
    if (target_.lights().empty()) return;
    for (int i = 0; i < treeSamples_; ++i) {
      core::LightBits bits{rng.bits(), rng.bits(), {}};
      bits.where = {rng.bits(), rng.bits()};
      const core::LightDraw drawn = tree_->sample(surface_.position, surface_.normal, bits, rng);
      const Known y = know(drawn.sample);
      builder.add(drawn.sample, y.target, y.target / (total_ * (y.density + treeSamples_ * double{drawn.pdf})),
                  rng);  // [candidates 2]
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
    const Known known = know(y, in, lightPdf);
    if (known.target > 0) builder.add(y, known.target, known.target / (total_ * known.density), rng);  // [candidates 1]
  }

  struct Known {
    float target = 0;    ///< p-hat
    double density = 0;  ///< L p_light + B p_bsdf
  };
  Known know(const LightSample& y, const Incident& in, float lightPdf) const {
    const vec3 flux = in.flux();
    if (!(core::maxComponent(flux) > 0)) return {};
    const BsdfValue bsdf = target_.bsdf().value(in.direction);
    const double bsdfPdf = target_.lights().isHittable(y.light) ? double{bsdf.pdf} * in.geometry : 0.0;
    return {core::luminance(bsdf.f * flux), lightSamples_ * double{lightPdf} + bsdfSamples_ * bsdfPdf};
  }
  Known know(const LightSample& y) const { return know(y, target_.incident(y), target_.lights().pdf(y)); }

  void addChosen(const ReservoirBuilder& chosen, core::Rng& rng, ReservoirBuilder& builder) const {
    if (chosen.empty()) return;
    const LightSample& y = chosen.sample();
    const double others = know(y).density;
    const double byTree = treeSamples_ * double{tree_->pdf(y, surface_.position, surface_.normal)};
    builder.add(y, chosen.target(), chosen.sum() * others / (others + byTree), rng);  // [candidates 3]
  }

  const Target<F>& target_;
  const Surface& surface_;
  const core::Tracer& tracer_;
  int lightSamples_;
  double bsdfSamples_;
  vec3 origin_;
  int total_;
  std::span<const core::PresampledLight> tile_;
  int treeSamples_;
  const core::LightChoice* tree_;
};

}  // namespace restir
