// How far two histories differ beyond noise: the edge-aware window mean that lag regression reads its drift from.
#pragma once

#include "core/edge_weight.h"
#include "core/guide.h"
#include "core/simd.h"
#include "twohistory/blend.h"

namespace twohistory {

/// Window statistics of one block of a row, element 0 belonging to x0. o: edge weights, N = (sum o)^2 / sum o^2.
struct DriftRow {
  static constexpr int kQuadrants = 4;
  std::array<float, core::kBlock> weight, difference, squared, noise, weightSquared, sampleVariance;
  std::array<std::array<float, core::kBlock>, kQuadrants> quadrantWeight, quadrantDifference;

  /// [blend D] mean of lum(X_j - X_k) over the window.
  float mean(int i) const { return weight[i] > 0 ? difference[i] / weight[i] : 0; }
  /// Window mean of s2.
  float meanSampleVariance(int i) const { return weight[i] > 0 ? sampleVariance[i] / weight[i] : 0; }
  /// [blend noise2] predicted variance of mean().
  float predictedNoise(int i) const { return weight[i] > 0 ? noise[i] / (weight[i] * weight[i]) : 0; }
  /// Largest of the prediction, the window's own spread over N, and the spread of four quadrant means.
  float safeNoise(int i) const;
};

/// Sums over the window around every pixel x in [x0, x1) of row y. difference: lum(X_j - X_k); noise: its predicted
/// variance in a pixel; sampleVariance: s2.
void sumDrift(const core::Guide& guide, const core::EdgeParameters& edges, core::In<float> difference,
              core::In<float> noise, core::In<float> sampleVariance, int radius, int y, int x0, int x1, DriftRow& out);

}  // namespace twohistory
