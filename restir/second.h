// Two histories of reservoirs: the same fresh candidates, forgotten in two ways, shaded apart and blended.
//
// A long chain has seen more candidates, a short one repeats itself less. Both chains resample the frame's fresh
// reservoirs with random numbers of their own; a ledger of both policies on the chains' taps gives the covariance that
// two *means* of these weights would have [ledger 4], and p_opt [blend opt] from it. Since p follows from counts alone,
// the blend of two unbiased images is unbiased. The measured blend takes variances and covariance from the two images
// around a pixel instead, which knows what resampling really leaves, and costs a little bias: the neighbours' samples
// are not independent of the pixel's own.
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
  const RestirState& state() const { return state_; }

 private:
  void advanceLedgers(const RestirParameters& parameters, const Frame& frame, const RestirState& first);
  void weighByCounts(int tile);
  void weighByMeasurement(const Frame& frame, PlanesView<const float> first);

  RestirState state_;
  Image<Ledger<2>> ledgerBefore_, ledger_;
  Image<float> weight_;
  core::Planes radiance_;
};

}  // namespace restir
