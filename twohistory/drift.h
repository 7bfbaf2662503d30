// How far histories differ beyond noise: edge-aware window means of their differences, and what noise they have.
#pragma once

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
  Row weight, weightSquared, sampleVariance;
  std::array<Row, kQuadrants> quadrantWeight;
  std::array<DifferenceSums, kMost> of;

  /// [blend D] mean of the k-th difference over the window.
  float mean(int k, int i) const { return weight[i] > 0 ? of[k].difference[i] / weight[i] : 0; }
  /// Window mean of s2.
  float meanSampleVariance(int i) const { return weight[i] > 0 ? sampleVariance[i] / weight[i] : 0; }
  /// Variance of the difference over the window.
  float spread(int k, int i) const;
  /// [blend noise2] predicted variance of mean().
  float predictedNoise(int k, int i) const { return weight[i] > 0 ? of[k].noise[i] / (weight[i] * weight[i]) : 0; }
  /// Largest of the prediction, spread() / (N - 1), and the variance of the mean of four quadrant means.
  float safeNoise(int k, int i) const;
};

/// One difference: lum(X_j - X_k) a pixel, and the predicted variance of its noise where the window averages it.
struct Difference {
  core::In<float> value, noise;
};

/// Sums over the window around every pixel x in [x0, x1) of row y, for `count` differences. sampleVariance: s2.
void sumDrift(const core::Guide& guide, const core::EdgeParameters& edges, const Difference* differences, int count,
              core::In<float> sampleVariance, int radius, int y, int x0, int x1, DriftRow& out);

}  // namespace twohistory
