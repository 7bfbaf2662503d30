// Errors of one sequence against its known truth: squared error by region, and the step that a fovea's edge leaves.
#pragma once

#include "experiments/border.h"
#include "experiments/regions.h"

namespace experiments::lab {

/// One variant's errors over the measured frames of a sequence.
class Measure {
 public:
  /// image, truth: RGB; errors are of luminance where nothing else is said.
  void add(core::PlanesView<const float> image, core::PlanesView<const float> truth, const FovealMemory& memory);
  /// Mean squared error; NaN where the region held no pixel.
  double squaredError(Region region) const;
  /// The same of RGB, mean over channels.
  double squaredColourError(Region region) const;
  /// Over the border of the fovea, or of where it has been in the last 30 frames.
  const BorderStep& border(Region region) const { return steps_[region == Region::fovea ? 0 : 1]; }

 private:
  double mean(const std::array<double, kRegions.size()>& sums, Region region) const;

  std::array<double, kRegions.size()> sums_{}, colour_{};
  std::array<std::int64_t, kRegions.size()> pixels_{};
  std::array<BorderStep, 2> steps_;
};

}  // namespace experiments::lab
