// Errors of one sequence against its known truth: squared error by region, and the step that a fovea's edge leaves.
#pragma once

#include "core/image.h"
#include "experiments/regions.h"

namespace experiments::lab {

/// The border of a region as an eye would see it.
///
/// Pixels within kBand of the border, on either side, are gathered in cells of kCell x kCell pixels; in each cell that
/// holds both sides, step = mean error inside - mean error outside. Noise of single pixels averages out, a difference
/// of level does not. Reported: mean of step^2 over cells and frames.
class BorderStep {
 public:
  static constexpr int kBand = 4, kCell = 16, kLeast = 8;  ///< pixels; least pixels of either side in a cell
  void add(core::In<float> error, core::In<std::uint8_t> inside);
  /// NaN where no cell held a border.
  double meanSquare() const;

 private:
  void addCell(core::In<float> error, core::In<std::uint8_t> side, int x0, int y0);
  double sum_ = 0;
  std::int64_t cells_ = 0;
};

/// One variant's errors over the measured frames of a sequence.
class Measure {
 public:
  /// image, truth: RGB; errors are of luminance.
  void add(core::PlanesView<const float> image, core::PlanesView<const float> truth, const FovealMemory& memory);
  /// Mean squared error; NaN where the region held no pixel.
  double squaredError(Region region) const;
  /// Mean squared step over the border of the fovea, or of where it has been in the last 30 frames.
  double borderStep(Region region) const { return steps_[region == Region::fovea ? 0 : 1].meanSquare(); }

 private:
  std::array<double, kRegions.size()> sums_{};
  std::array<std::int64_t, kRegions.size()> pixels_{};
  std::array<BorderStep, 2> steps_;
};

}  // namespace experiments::lab
