// Every blend of two (or three) histories over an image. See combination.h for the formulas.
#pragma once

#include <array>

#include "core/edge_weight.h"
#include "core/guide.h"
#include "twohistory/drift.h"
#include "twohistory/history_view.h"
#include "twohistory/packed_ledger.h"
#include "twohistory/twins.h"
#include "twohistory/validation.h"

namespace twohistory {

enum class BlendMode {
  first,       ///< pair[0] alone ("unweighted" and "weighted" are this with one history)
  published,   ///< p as the slides' headline prints it
  optimal,     ///< p_opt: least variance under constant truth
  optimalAll,  ///< the same over all K histories, weights >= 0
  seed,        ///< p_opt, then towards pair[0] where the gradient is large, as its author shipped it
  seedSlide,   ///< the same with the slides' gradient
  consistent,  ///< one closed form in place of p and q
  lag,         ///< lag regression: least estimated true error; the flagship
  lagAll,      ///< lag regression over all K histories; pair[1] is the freshest, which the others are compared with
  custom,      ///< BlendParameters::custom
  oracle,      ///< best p in [0, 1] against the reference; p_opt in frames without one
};

/// Whether a mode reads BlendParameters::pair beyond its first.
inline bool usesPair(BlendMode mode) {
  return mode != BlendMode::first && mode != BlendMode::custom && mode != BlendMode::optimalAll;
}

/// predicted: from the power sums. safe: the largest of that and two measured ones (spread in the window, spread of
/// four quadrant means); lagAll then also scales pixel noise by its measured over its predicted variance.
enum class NoiseEstimate { predicted, safe };

/// What a blend of one's own may read of one pixel with `count` histories.
struct PixelHistories {
  int count = 0;
  std::array<core::vec3, 3> colour{};                ///< demodulated radiance after the first filter level
  std::array<float, 3> weight{};                     ///< W
  std::array<float, 3> age{};                        ///< mean age in frames
  std::array<std::array<float, 3>, 3> covariance{};  ///< in units of sampleVariance
  float sampleVariance = 0;                          ///< s2: luminance variance of one sample
  float samples = 0;                                 ///< n of this frame
};

/// Weights of the histories; they should sum to 1.
using BlendFunction = std::array<float, 3> (*)(const PixelHistories&);

struct BlendParameters {
  BlendMode mode = BlendMode::first;
  std::array<int, 2> pair{0, 1};         ///< histories; p weighs the first
  float lowest = -0.5f, highest = 1.5f;  ///< range of p in `lag`; lowest also bounds `lagAll`
  float correction = 0;                  ///< c: share of the lag left in `lagAll`'s blend that is taken away, in [0, 1]
  float lagError = 0.5f;                 ///< epsilon: relative standard deviation of that lag's estimate
  int radius = 3;                        ///< of the window that estimates drift, pixels
  bool trend = true;                     ///< lagAll shrinks differences towards those of large areas, not towards 0
  NoiseEstimate noise = NoiseEstimate::predicted;
  core::EdgeParameters edges;
  ValidationParameters validation;
  BlendFunction custom = nullptr;  ///< of mode custom; only an extension can set it
};

template <class V>
void describe(V& v, BlendParameters& p) {
  v.choice("mode", p.mode,
           {{"first", BlendMode::first},
            {"published", BlendMode::published},
            {"optimal", BlendMode::optimal},
            {"optimalAll", BlendMode::optimalAll},
            {"seed", BlendMode::seed},
            {"seedSlide", BlendMode::seedSlide},
            {"consistent", BlendMode::consistent},
            {"lag", BlendMode::lag},
            {"lagAll", BlendMode::lagAll},
            {"custom", BlendMode::custom},
            {"oracle", BlendMode::oracle}},
           "how the histories become one image");
  v("first", p.pair[0], "index of the history that p weighs", 0.0, 2.0);
  v("second", p.pair[1], "index of the other history", 0.0, 2.0);
  v("lowest", p.lowest, "least p (lag) or least weight of any history (lagAll)", -4.0, 0.0);
  v("highest", p.highest, "largest p (lag)", 1.0, 5.0);
  v("correction", p.correction, "share of the lag left in the blend that is taken away (lagAll)", 0.0, 1.0);
  v("lagError", p.lagError, "relative standard deviation of the estimate of that lag", 0.0, 1.0);
  v("radius", p.radius, "radius in pixels of the window that estimates drift", 0.0, 8.0);
  v("trend", p.trend, "shrink noisy differences towards those of large areas instead of 0 (lagAll)");
  v.choice("noise", p.noise, {{"predicted", NoiseEstimate::predicted}, {"safe", NoiseEstimate::safe}},
           "how the noise of the histories' mean difference is estimated");
  v("validation", p.validation, "check of the blend against samples that it has not seen");
}

/// What a blend reads. All images have one size; colours are after the first filter level.
template <int K>
struct Histories {
  std::array<HistoryView, K> colour;
  LedgerView<K> ledger;
  core::In<float> sampleVariance;          ///< s2: luminance variance of one sample
  core::In<float> samples;                 ///< n of this frame
  core::In<float> variance;                ///< luminance variance of history 0 after the filter
  core::PlanesView<const float> gradient;  ///< seed, seedSlide: change per frame; else empty
  core::PlanesView<const float> target;    ///< oracle: the demodulated truth; else empty
  const TwinTiles* twins = nullptr;        ///< where the second history is the first; null = not known
};

/// Planes that the window estimate needs while blend() runs, and nothing keeps: a value and its noise for each of at
/// most two differences, and lum(X_0). Any images of the right size that are free will do, but not out or variance.
using BlendScratch = std::array<core::ImageView<float>, 2 * DriftRow::kMost + 1>;

/// Where a blend's result goes. weight: p where the blend has one (else 1); may be empty.
struct Blended {
  core::PlanesView<float> colour;
  core::ImageView<float> variance;  ///< of the luminance, what remains
  core::ImageView<float> weight{};
};

/// Blends every pixel. K = 1, 2 or 3. validation: the check of earlier frames, where parameters ask for it.
template <int K>
void blend(const Histories<K>& histories, const core::Guide& guide, const BlendParameters& parameters,
           Validation& validation, const BlendScratch& scratch, const Blended& out);

}  // namespace twohistory
