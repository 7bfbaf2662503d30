// Two histories of reservoirs: the same fresh candidates, forgotten in two ways, shaded apart and blended.
//
// A long chain has seen more candidates, a short one repeats itself less. Both chains resample the frame's fresh
// reservoirs with random numbers of their own. Half of each is the default: most of a result's noise is that one sample
// was chosen, which two chains do not share. Blended by counts, a ledger of both policies on the first chain's taps
// gives the covariance that two *means* of these weights would have [ledger 4], and p_opt [blend opt] from it. In both,
// weights follow from counts alone, so the blend of two unbiased images is unbiased. The measured blend takes variances
// and covariance from the two images around a pixel instead, which knows what resampling really leaves, and costs a
// little bias: the neighbours' samples are not independent of the pixel's own. docs/results.md, section 13, compares.
#pragma once

#include "restir/restir.h"

namespace restir {

/// Everything that the second history keeps from frame to frame.
class SecondHistory {
 public:
  SecondHistory(int width, int height);

  /// Blends the second history's radiance into `radiance`, the first's. To be called once a frame, after the first
  /// history's reuseSpatiallyAndShade(). first: its state after that.
  void blendInto(const RestirParameters& parameters, const Frame& frame, const RestirState& first,
                 PlanesView<float> radiance);

  /// Weight of the first history in the last frame, in [0, 1].
  In<float> weight() const { return weight_; }
  /// As RestirState::badPixels(), of the second history.
  std::int64_t badPixels() const { return state_.badPixels(); }

 private:
  void weighByCounts(const RestirParameters& parameters, const Frame& frame, const RestirState& first);
  void weighByMeasurement(const Frame& frame, PlanesView<const float> first);

  RestirState state_;
  Image<Ledger<2>> ledgerBefore_, ledger_;  // empty unless counts decide
  Image<float> weight_;
  core::Planes radiance_;
};

}  // namespace restir
