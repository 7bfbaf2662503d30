// A reservoir: one light sample that stands for many, and the stream that chooses it.
// Source: Bitterli et al., "Spatiotemporal Reservoir Resampling for Real-Time Ray Tracing with Dynamic Direct
// Lighting" (2020), algorithms 2 and 3.
#pragma once

#include "core/lights.h"
#include "core/random.h"

namespace restir {

using core::LightSample;

/// E[unbiasedWeight g(sample)] = sum of g over the support of the target that the reservoir was last resampled for.
struct Reservoir {
  LightSample sample;
  float unbiasedWeight = 0;  ///< W, an unbiased estimate of 1 / density of sample; 0 = null sample
  float confidence = 0;      ///< c: how many samples it stands for, null samples included; never depends on values
  std::uint32_t frame = 0;   ///< frame whose surface, lights and camera its target had
};
static_assert(sizeof(Reservoir) <= 32);

/// Weighted reservoir sampling of one candidate, in proportion to resampling weights.
///
/// The sum is kept in double: tens of thousands of candidates lose nothing. A candidate whose weight or target is not
/// positive and finite counts as one of weight 0.
class ReservoirBuilder {
 public:
  static constexpr float kLargest = 1e37f;  ///< weights and targets from here on count as not finite

  /// w: resampling weight m p-hat W of the candidate; target: p-hat of it, which finish() divides by.
  void add(const LightSample& candidate, float target, double w, core::Rng& rng) {
    if (!(w > 0 && w < kLargest && target > 0 && target < kLargest)) return;
    sum_ += w;
    const double u = (rng.bits() + 0.5) * 0x1p-32;
    if (u * sum_ < w) sample_ = candidate, target_ = target;
  }
  /// True while nothing has been chosen.
  bool empty() const { return !sample_.valid(); }
  /// What is chosen so far, and its target.
  const LightSample& sample() const { return sample_; }
  float target() const { return target_; }
  /// Sum of the weights: p-hat W of what is chosen.
  double sum() const { return sum_; }

  /// W = factor times sum of w / p-hat(y).
  Reservoir finish(float confidence, std::uint32_t frame, double factor = 1) const {
    const auto weight = static_cast<float>(factor * sum_ / target_);
    if (!(weight > 0 && weight < kLargest)) return {{}, 0, confidence, frame};
    return {sample_, weight, confidence, frame};
  }

 private:
  LightSample sample_;
  float target_ = 1;
  double sum_ = 0;
};

}  // namespace restir
