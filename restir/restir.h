// ReSTIR direct lighting with a sample count of its own in every pixel: parameters, state, and the passes in order.
//
//   drawCandidates           n batches of candidates a pixel into a fresh reservoir of confidence weight(n)
//   reuseTemporally          resamples it with the pixel's history, whose target is the previous frame's
//   reuseSpatiallyAndShade   n times: resamples with neighbours, one shadow ray (or one for each: Shaded); averages
//
// Rules that keep it unbiased: taps, neighbours and confidences follow from geometry, counts and random numbers, never
// from a reservoir's sample; null samples keep their confidence; what is kept for the next frame is the reservoir
// before spatial reuse; shadow rays are written back only where every target includes them. Where n = 0 a reservoir
// waits, and remembers the surface, viewer, lights and geometry that its target had.
//
// Sources: Bitterli et al. 2020; Lin et al. 2022 (see mis.h). Sample counts are this project's.
#pragma once

#include "core/image.h"
#include "core/light_choice.h"
#include "core/moment.h"
#include "core/parallel.h"
#include "restir/candidates.h"
#include "restir/mis.h"
#include "restir/past.h"
#include "restir/spatial.h"
#include "restir/told.h"
#include "twohistory/ledger.h"
#include "twohistory/taps.h"

namespace restir {

using core::Image;
using core::In;
using core::Moment;
using core::PlanesView;
using twohistory::Choice;
using twohistory::Ledger;
using twohistory::Taps;

/// none: n independent results a pixel, each as WithoutReuse says. temporal: n batches of candidates, but one result
/// and one shadow ray whatever n, since a reservoir without neighbours gives no second. spatial, both: n results.
enum class Reuse { none, temporal, spatial, both };

/// ris: a result is one reservoir, resampled from its candidates. The others are baselines: a result is one light
/// sample, drawn in that way, and one BSDF sample, each with a ray, combined by the balance heuristic (direct.h).
enum class WithoutReuse { ris, uniform, power, tree };

/// automatic: kernels are compiled for the lights that the scene has. all: for every kind, to measure what that costs.
enum class Features { automatic, all };

/// What a result of spatial reuse shades. chosen: the one sample that resampling chose. all: every sample that it would
/// have chosen from, weighted as it would: as many shadow rays, and none of the noise of choosing.
/// Source: Wyman and Panteleev, "Rearchitecting Spatiotemporal Resampling for Production" (2021), decoupled shading.
enum class Shaded { chosen, all };

struct TemporalParameters {
  twohistory::Policy policy{twohistory::Weighting::samples, twohistory::Forgetting::relativeCap, 20};
  Choice tap = Choice::stochastic;  ///< `best` is 5 % quieter in the median but keeps its fireflies: docs/decisions.md
  /// Targets of the history: with the surface, viewer, lights and geometry it had (unbiased), or with this frame's
  /// (cheaper).
  bool previousSurface = true, previousCamera = true, previousLights = true;
  bool previousGeometry = true;  ///< only where targets include visibility
};

/// How two histories of reservoirs become one image (second.h). counts: least variance by the ledger, unbiased.
/// measured: least variance by the images around a pixel. mean: half of each.
enum class SecondBlend { counts, measured, mean };

struct SecondParameters {
  bool on = false;
  twohistory::Policy policy{twohistory::Weighting::samples, twohistory::Forgetting::relativeCap, 3};
  SecondBlend blend = SecondBlend::mean;
};

struct RestirParameters {
  Reuse reuse = Reuse::both;
  WithoutReuse withoutReuse = WithoutReuse::ris;  ///< anything else needs Reuse::none
  Mis mis = Mis::balance;
  CandidateParameters candidates;
  TemporalParameters temporal;
  SpatialParameters spatial;
  Shaded shaded = Shaded::chosen;
  SecondParameters second;
  Features features = Features::automatic;
  /// Targets include the shadow ray of their own surface at their own instant (target.h), and the last one is reused
  /// for shading.
  bool targetVisibility = false;
  bool demodulate = true;        ///< divide radiance by demodulationAlbedo()
  bool tellAll = false;          ///< work out the counts of every Told, not of samples alone
  float sharedVariance = 0.23f;  ///< rho of [told] under spatial reuse
};

/// One frame's input; all images have one size. Whoever renders keeps now's and before's owners alive.
struct Frame {
  Moment now, before;  ///< before: the frame before; equal to now in the first frame
  In<float> samples;   ///< n >= 0, rounded to whole batches; 0 = nothing is sampled
  In<Taps> taps;       ///< into the frame before; no valid tap = no history
  std::uint64_t seed = 0;
  int tile = core::kDefaultTile;
};

/// Everything that one sequence keeps from frame to frame. Allocates nothing after the first frame (and, once, in the
/// first frame that has a pixel without samples).
struct RestirState {
  RestirState() = default;
  RestirState(int width, int height);

  /// Pixels since the start whose radiance was not finite; they counted as n = 0.
  std::int64_t badPixels() const { return bad; }

  LightTiles lightTiles;
  Image<Reservoir> fresh, before, now;
  Image<Ledger<1>> ledgerBefore, ledgerNow;
  Image<Taps> taps;                     ///< the one tap that was chosen
  Image<Surface> waitedBefore, waited;  ///< surface of a reservoir that waits; empty until one does
  Image<float> shaded;  ///< n that a pixel's radiance stands for: 0 without surface, samples or finite result
  Image<float> confidence, effective;  ///< the same as Told names them; empty unless all are told
  PastMoments past;
  bool waitsBefore = false, waits = false;  ///< some pixel of the frame had n = 0
  std::int64_t bad = 0;
  std::shared_ptr<const Lights> drawnLights;  ///< what lightChoice draws from
  std::shared_ptr<const core::LightChoice>
      lightChoice;  ///< null unless a baseline draws lights, or there are tree samples
};

/// True where a baseline takes the place of reservoirs.
inline bool drawsLights(const RestirParameters& p) {
  return p.reuse == Reuse::none && p.withoutReuse != WithoutReuse::ris;
}

/// Where nothing is reused: draws no candidate, but builds what a baseline draws lights from, once for every change of
/// the lights.
void drawCandidates(const RestirParameters& parameters, const Frame& frame, RestirState& state);
/// The same for a second history (second.h) of the frame: takes over the fresh reservoirs of `first`.
void shareCandidates(const RestirParameters& parameters, const Frame& frame, const RestirState& first,
                     RestirState& state);
void reuseTemporally(const RestirParameters& parameters, const Frame& frame, RestirState& state);
/// One independent result, RGB, a block of 2x2 pixels, shaded from the fresh reservoir alone: unbiased, and
/// independent of every earlier frame, which reused samples are not. Negative in pixels that have none. To be called
/// between drawCandidates and reuseTemporally.
void shadeCheckSamples(const RestirParameters& parameters, const Frame& frame, const RestirState& state,
                       PlanesView<float> radiance);
/// radiance: reflected light, emission excluded, 0 where there is no surface. A pixel with n = 0 gets the mean of its
/// similar neighbours within a few pixels that have samples, else 0.
void reuseSpatiallyAndShade(const RestirParameters& parameters, const Frame& frame, RestirState& state,
                            PlanesView<float> radiance);

template <class V>
void describe(V& v, CandidateParameters& p) {
  v("lightSamples", p.lightSamples, "light samples a batch; a pixel of n samples draws n batches", 1, 4096);
  v("bsdfSamples", p.bsdfSamples, "BSDF samples a batch; a fraction is a probability", 0.0, 4096.0);
  v("bsdfShareOfMany", p.bsdfShareOfMany, "factor on bsdfSamples where lights outgrow the cache", 0.0, 1.0);
  v.choice("lightTiles", p.lightTiles,
           {{"auto", TileUse::automatic}, {"always", TileUse::always}, {"never", TileUse::never}},
           "light samples from tiles that blocks of pixels share; auto: where lights outgrow the cache");
  v("treeSamples", p.treeSamples, "samples a batch from a light tree, which knows what is near", 0, 4096);
}

template <class V>
void describe(V& v, TemporalParameters& p) {
  v("policy", p.policy, "how confidence is weighted and forgotten");
  v.choice("tap", p.tap, {{"best", Choice::best}, {"stochastic", Choice::stochastic}},
           "which of the reprojected taps gives the reservoir");
  v("previousSurface", p.previousSurface, "history targets use the surface they had, else this frame's (biased)");
  v("previousCamera", p.previousCamera, "history targets use the viewer they had, else this frame's (unbiased too)");
  v("previousLights", p.previousLights, "history targets use the lights they had, else this frame's (biased)");
  v("previousGeometry", p.previousGeometry,
    "history targets that include visibility trace the geometry they had, else this frame's (biased)");
}

template <class V>
void describe(V& v, SpatialParameters& p) {
  v("neighbours", p.neighbours, "reservoirs merged with a pixel's own", 0, kMostNeighbours);
  v("radius", p.radius, "of the disk they come from, fraction of the image height", 0.0, 1.0);
  v("normalCosine", p.normalCosine, "least cosine between the normals", -1.0, 1.0);
  v("planeDistance", p.planeDistance, "most distance from the pixel's plane, fraction of its distance to the camera",
    0.0, 1e6);
}

template <class V>
void describe(V& v, SecondParameters& p) {
  v("on", p.on, "shade a second history of reservoirs too, and blend");
  v("policy", p.policy, "how the second history is weighted and forgotten");
  v.choice("blend", p.blend,
           {{"counts", SecondBlend::counts}, {"measured", SecondBlend::measured}, {"mean", SecondBlend::mean}},
           "least variance by counts (unbiased), by images around a pixel (a little biased), or half of each");
}

template <class V>
void describe(V& v, RestirParameters& p) {
  v.choice("reuse", p.reuse,
           {{"none", Reuse::none}, {"temporal", Reuse::temporal}, {"spatial", Reuse::spatial}, {"both", Reuse::both}},
           "of reservoirs; a pixel of n samples shades n results, with temporal reuse alone one");
  v.choice("withoutReuse", p.withoutReuse,
           {{"ris", WithoutReuse::ris},
            {"uniform", WithoutReuse::uniform},
            {"power", WithoutReuse::power},
            {"tree", WithoutReuse::tree}},
           "results where reuse is none: reservoirs, or a light and a BSDF sample each, lights drawn so");
  v.choice("mis", p.mis,
           {{"constant", Mis::constant},
            {"contribution", Mis::contribution},
            {"balance", Mis::balance},
            {"pairwise", Mis::pairwise}},
           "weights of merging; constant is biased");
  v("targetVisibility", p.targetVisibility, "targets include occlusion, a ray each; else shading alone traces it");
  v("sharedVariance", p.sharedVariance, "correlation of a pixel's results, for variants told effective counts", 0.0,
    1.0);
  v("candidates", p.candidates, "fresh candidates");
  v("temporal", p.temporal, "reuse from the frame before");
  v("spatial", p.spatial, "reuse from neighbours");
  v.choice("shaded", p.shaded, {{"chosen", Shaded::chosen}, {"all", Shaded::all}},
           "of the samples that neighbours and pixel merge: the one that is chosen, or all of them, a ray each");
  v("second", p.second, "a second history of reservoirs");
}

}  // namespace restir
