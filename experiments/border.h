// The border of a region as an eye would see it: a step of the mean level, and a step of the noise.
//
// A step of level counts as visible from a Weber contrast of 1 %: thresholds of luminance edges under good conditions
// lie at 1 to 2 % (Cornsweet, Pinsker, "Luminance discrimination of brief flashes under various conditions of
// adaptation", 1965; cited from memory), whatever the level.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "experiments/regions.h"
#include "experiments/results.h"

namespace experiments {

/// One border over the frames of a sequence.
///
/// Pixels within kBand of the border, on either side, are gathered in cells of kCell x kCell pixels; in each cell that
/// holds both sides, step = mean error inside - mean error outside. Noise of single pixels averages out, a difference
/// of level does not. contrast = step over the true level there (plus 1 % of the frame's, for a black is not darker
/// than that on a display).
class BorderStep {
 public:
  static constexpr int kBand = 4, kCell = 16, kLeast = 8;  ///< pixels; least pixels of either side in a cell
  using Contrast = std::array<float, 2>;                   ///< against either half of the truth

  /// image, truth: luminance; the two halves of a reference have independent noise, a known truth is both. inside:
  /// nonzero in the region.
  void add(core::In<float> image, const std::array<core::In<float>, 2>& truth, core::In<std::uint8_t> inside);
  /// Mean of step^2 over cells and frames; NaN where no cell held a border.
  double meanSquare() const;
  /// Noise outside over noise inside: standard deviations of the error within either side of a cell, geometric mean
  /// over cells and frames. NaN where no cell held a border.
  double noiseRatio() const;
  /// Signed, cell by cell and frame by frame; the same cells for every seed.
  const std::vector<Contrast>& contrasts() const { return contrasts_; }

 private:
  struct Side;
  void addCell(core::In<float> image, const std::array<core::In<float>, 2>& truth, core::In<std::uint8_t> side,
               double floor, int x0, int y0);
  double sum_ = 0, logRatio_ = 0;
  std::int64_t cells_ = 0, noisy_ = 0;
  std::vector<Contrast> contrasts_;
};

/// Mean squared contrast of the step in the mean image, free of noise: the mean over cells of the product of two
/// independent seeds' contrasts. One jackknife pseudo-value a seed, whose mean is the estimate (it may be negative) and
/// whose spread is its error. sequences: one a seed; fewer than three, or cells that differ, give NaN.
std::vector<double> systematicContrast2(const std::vector<const std::vector<BorderStep::Contrast>*>& sequences);

/// Regions whose borders are measured: where the fovea is, and where it has been in the last 30 frames.
inline constexpr std::array kBorders{Region::fovea, Region::recentlyFoveal};

/// Contrasts of one variant's border in one sequence.
struct BorderContrasts {
  std::string variant, region;
  std::uint64_t seed;
  std::vector<BorderStep::Contrast> contrasts;
};

/// Rows "border_contrast2": systematicContrast2 of every variant and region. all: of one scene, in any order.
std::vector<Row> systematicRows(const std::string& scene, const std::vector<BorderContrasts>& all);

}  // namespace experiments
