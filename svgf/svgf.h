// Spatiotemporal variance-guided filtering over K histories of demodulated radiance: parameters, what is kept between
// frames, and the passes in the order in which a frame calls them.
// Sources: SVGF (Schied et al. 2017); [Tu24] "Two-history Spatio-temporal Filter" for where the histories part and
// meet.
#pragma once

#include <array>
#include <utility>

#include "core/edge_weight.h"
#include "core/guide.h"
#include "svgf/moments.h"
#include "twohistory/history_view.h"
#include "twohistory/packed_ledger.h"
#include "twohistory/twins.h"
#include "twohistory/validation.h"
#include "twohistory/walk_memory.h"

namespace svgf {

using core::Guide;
using core::Image;
using core::ImageView;
using core::In;
using core::Planes;
using core::PlanesView;
using twohistory::HistoryColours;
using twohistory::Ledger;
using twohistory::LedgerView;
using twohistory::StoredLedger;
using twohistory::Taps;

struct FilterParameters {
  int levels = 2;       ///< à-trous levels in all; the first one's result is fed back; 0 = no spatial filter
  float phiColour = 4;  ///< [SVGF (5)] sigma_l, times the standard deviation of luminance
  core::EdgeParameters edges;
  float momentsDecay = 0.95f;  ///< of the luminance mean that innovations are measured against
  float spatialBelow = 4;      ///< fewer innovations than this: variance from the neighbourhood
  int spatialRadius = 3;       ///< of that neighbourhood, pixels
  float fireflyClamp = 0;      ///< k: luminance at most m + k sigma, 0 = off; takes energy away, and says how much
  bool skipTwins = true;       ///< work on one history where the second is the same; changes no bit
};

template <class V>
void describe(V& v, FilterParameters& p) {
  v("levels", p.levels, "a-trous levels, the first of which is fed back; 0 = no spatial filter", 0.0, 5.0);
  v("phiColour", p.phiColour, "luminance edge weight, in standard deviations", 1e-3, 1e6);
  v("depthScale", p.edges.depthScale, "depth edge weight, in depth slopes", 1e-6, 1e6);
  v("relativeDepth", p.edges.relativeDepth, "depth edge weight, in depths a pixel, added", 0.0, 1.0);
  v("momentsDecay", p.momentsDecay, "decay a frame of the luminance mean that variance is measured against", 0.1, 1.0);
  v("spatialBelow", p.spatialBelow, "innovations below which variance comes from the neighbourhood", 1.0, 20.0);
  v("spatialRadius", p.spatialRadius, "radius of that neighbourhood in pixels", 1.0, 8.0);
  v("fireflyClamp", p.fireflyClamp, "standard deviations above its mean that a fresh luminance may lie, 0 = any", 0.0,
    1e6);
  v("skipTwins", p.skipTwins, "work on one history where the second is the same; changes no bit");
}

/// What one variant keeps from frame to frame. Index [now] is written this frame, [1 - now] was written before.
template <int K>
struct FilterState {
  FilterState(int width, int height);

  int now = 0;
  std::uint32_t frame = 0;  ///< how many were begun, for the ledgers' rounding
  std::array<Image<StoredLedger<K>>, 2> ledger;
  std::array<Image<StoredLedger<1>>, 2> momentsLedger;
  std::array<Image<Moments>, 2> moments;
  HistoryColours<K> history;                      ///< after the first level: fed back, and blended
  HistoryColours<K> accumulated;                  ///< before it
  twohistory::TwinTiles twins, accumulatedTwins;  ///< of each, for pairs that can have twins
  twohistory::WalkMemory walks;                   ///< of the noise through past frames' taps
  Image<float> samples;                           ///< sample counts after bad input was taken out
  Image<float> sampleVariance;                    ///< s2 a pixel
  Image<float> variance, filteredVariance;        ///< of history 0's luminance, before and after a level
  Image<float> luminance, tolerance;              ///< what the luminance edge weight reads
  Planes clamped;                                 ///< radiance without fireflies; empty unless they are clamped

  void swapFrames() { now = 1 - now, ++frame; }
  Ledger<K> ledgerAt(int x, int y) const { return ledger[now](x, y); }
  std::size_t bytes() const;
};

/// Copies sample counts, with 0 where radiance is not finite: such a pixel is a frame without samples.
/// Returns how many pixels were dropped.
std::int64_t dropBadSamples(PlanesView<const float> radiance, In<float> n, ImageView<float> out);

/// [clamp] Copies radiance with its luminance at most m + k sqrt(s2 (1/n + V)): m, s2 the gathered moments, V the
/// variance of m, once s2 has seen `spatialBelow` innovations. Returns the luminance taken away, times albedo's,
/// summed. A change of the light is clamped too, but widens s2, so that it is through after some frames.
template <int K>
double clampFireflies(const FilterParameters& parameters, In<Taps> taps, PlanesView<const float> radiance,
                      PlanesView<const float> albedo, FilterState<K>& state);

/// Carries all K colour histories and the moments through one frame (the temporal filter).
template <int K>
void accumulate(const FilterParameters& parameters, const std::array<twohistory::Policy, K>& policies, In<Taps> taps,
                PlanesView<const float> radiance, FilterState<K>& state);

/// Holds the last blend against this frame's samples, to be called between accumulate and blend. check: RGB of
/// samples that depend on no earlier frame, negative where there is none; empty = the radiance itself is independent.
template <int K>
void checkBlend(const twohistory::ValidationParameters& parameters, const std::array<twohistory::Policy, K>& policies,
                In<Taps> taps, PlanesView<const float> radiance, PlanesView<const float> check,
                const FilterState<K>& state, twohistory::Validation& validation);

/// s2 from innovations or, where they are few, from the neighbourhood; history 0's variance from it. Pixels that have
/// never seen a sample take their colours from neighbours that have (weight 0: the next sample replaces them).
template <int K>
void estimateVariance(const FilterParameters& parameters, const Guide& guide, FilterState<K>& state);

/// First à-trous level: one set of weights, from history 0, filters all K histories, so that their covariances stay in
/// proportion. Result in state.history and state.filteredVariance.
template <int K>
void filterHistories(const FilterParameters& parameters, const Guide& guide, FilterState<K>& state);

/// Images that the further levels go through.
struct LevelBuffers {
  LevelBuffers(int width, int height)
      : colour{Planes(width, height), Planes(width, height)},
        variance{Image<float>(width, height), Image<float>(width, height)},
        luminance(width, height),
        tolerance(width, height) {}
  std::array<Planes, 2> colour;
  std::array<Image<float>, 2> variance;
  Image<float> luminance, tolerance;

  /// Images that are free until filterFurther runs.
  std::array<ImageView<float>, 5> free() {
    const PlanesView<float> planes = colour[1];
    return {planes.plane[0], planes.plane[1], planes.plane[2], luminance, tolerance};
  }
  std::size_t bytes() const {
    return colour[0].bytes() + colour[1].bytes() + variance[0].bytes() + variance[1].bytes() + luminance.bytes() +
           tolerance.bytes();
  }
};

/// À-trous levels 2 .. parameters.levels of the blended image in buffers.colour[0], with its variance in
/// buffers.variance[0]. Returns the index of the buffers that hold the result.
int filterFurther(const FilterParameters& parameters, const Guide& guide, LevelBuffers& buffers);

}  // namespace svgf
