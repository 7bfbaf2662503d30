// How far histories differ beyond noise: edge-aware window means of their differences, and what noise they have.
#pragma once

#include <array>
#include <vector>

#include "core/edge_weight.h"
#include "core/guide.h"
#include "core/simd.h"

namespace twohistory {

inline constexpr int kQuadrants = 4;

/// Window sums of one difference over one block of a row, element 0 belonging to x0.
struct DifferenceSums {
  using Row = std::array<float, core::kBlock>;
  Row difference, squared, noise;        ///< sum o d, sum o d^2, sum o^2 v
  std::array<Row, kQuadrants> quadrant;  ///< sum o d of each quadrant
};

/// Window sums of one block of a row. o: edge weights, N = (sum o)^2 / sum o^2.
struct DriftRow {
  static constexpr int kMost = 2;  ///< differences at once
  using Row = DifferenceSums::Row;
  Row weight, weightSquared, sampleVariance, brightness;
  std::array<Row, kQuadrants> quadrantWeight;
  std::array<DifferenceSums, kMost> of;

  /// [blend D] mean of the k-th difference over the window.
  float mean(int k, int i) const {
    return weight[i] > 0 ? of[k].difference[i] / weight[i] : 0;  // [blend D]
  }
  /// Window mean of s2.
  float meanSampleVariance(int i) const { return weight[i] > 0 ? sampleVariance[i] / weight[i] : 0; }
  /// Window mean of lum(X_0).
  float meanBrightness(int i) const { return weight[i] > 0 ? brightness[i] / weight[i] : 0; }
  /// Variance of the difference over the window.
  float spread(int k, int i) const;
  /// [blend noise2] predicted variance of mean().
  float predictedNoise(int k, int i) const {
    return weight[i] > 0 ? of[k].noise[i] / (weight[i] * weight[i]) : 0;  // [blend noise2]
  }
  /// Largest of the prediction, spread() / (N - 1), and the variance of the mean of four quadrant means.
  float safeNoise(int k, int i) const;
};

/// One difference: lum(X_j - X_k) a pixel, and the predicted variance of its noise where the window averages it.
struct Difference {
  core::In<float> value, noise;
};

/// What windows are summed over.
struct DriftSource {
  const core::Guide& guide;
  const core::EdgeParameters& edges;
  int radius;                      ///< of the window, pixels
  core::In<float> sampleVariance;  ///< s2
  core::In<float> brightness;      ///< lum(X_0)
  int count;                       ///< differences in use
  std::array<Difference, DriftRow::kMost> differences;
};

/// Window sums of a block of pixels, along rows first and then across them, so that a window costs twice its side
/// instead of its area. A tap (dx, dy) of pixel p weighs o(p, m) o(m, q), m = p + (0, dy), q = p + (dx, dy): both legs
/// must cross no edge. No sum depends on where blocks begin.
class DriftBlock {
 public:
  static constexpr int kWidth = 128, kHeight = 32;  ///< pixels at once: the sums along rows stay in a core's cache

  explicit DriftBlock(const DriftSource& source) : source_(source) {}
  /// Sums along the rows that the windows of pixels [x0, x1) in rows [y0, y1) reach.
  void sumRows(int x0, int x1, int y0, int y1);
  /// Sums over the window around pixels [begin, end) of row y, within what sumRows() was given; element 0 of `out` is
  /// that of `begin`.
  void sumWindows(int y, int begin, int end, DriftRow& out) const;

 private:
  using Row = std::array<float, kWidth>;
  /// Sums over taps to the left (dx < 0), the centre alone, and taps to the right, kept apart for the quadrants.
  struct Thirds {
    Row left, centre, right;
  };
  struct Along {
    Thirds weight;
    Row weightSquared, sampleVariance, brightness;
    struct {
      Thirds difference;
      Row squared, noise;
    } of[DriftRow::kMost];
  };
  void sumRow(int y, Along& out) const;
  static void addAlong(const Along& row, int i, int n, int dy, int differences, const float* o, DriftRow& out);

  const DriftSource& source_;
  int x0_ = 0, x1_ = 0, first_ = 0;  ///< pixels and first row of rows_
  std::vector<Along> rows_;
};

}  // namespace twohistory
