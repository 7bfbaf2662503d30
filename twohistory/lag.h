// Lag regression in one pixel: what the window around it says of K histories' biases and noise, and the weights of
// least estimated error that follow. Derived in docs/history.md.
#pragma once

#include <array>
#include <cmath>

#include "twohistory/combination.h"
#include "twohistory/drift.h"
#include "twohistory/trend.h"

namespace twohistory {

/// x / y for x, y >= 0, at most 1e6: without noise any drift is certain. No 0 / 0, also where both have underflowed.
inline float cappedRatio(float x, float y) {
  constexpr float kMost = 1e6f;
  if (!(x > 0)) return 0;
  return x < kMost * y ? x / y : kMost;
}

/// Which histories a pixel's differences compare: of[k] - reference, for k < K - 1.
template <int K>
struct Against {
  int reference;  ///< the freshest history
  std::array<int, K> of{};

  explicit Against(int freshest) : reference(freshest) {
    for (int j = 0, k = 0; j < K; ++j)
      if (j != freshest) of[k++] = j;
  }
};

/// What a window says about its pixel's histories, in units of s2 and its square root.
template <int K>
struct WindowEvidence {
  std::array<float, K> bias{};  ///< b_j
  float noise = 1;              ///< kappa, >= 1: measured over predicted variance of the histories' differences
  float fresh = 1;              ///< how much of the reference's age the gaps span, <= 1: what they say of it
};

/// [blend D] the window's mean of difference k, with its noise taken off what it differs from `expected` by.
inline float shrunkMean(const DriftRow& row, int k, int i, bool measuredNoise, float expected) {
  const float rest = row.mean(k, i) - expected;
  const float noise2 = measuredNoise ? row.safeNoise(k, i) : row.predictedNoise(k, i);     // [blend noise2]
  return expected + std::copysign(std::sqrt(std::max(0.0f, rest * rest - noise2)), rest);  // [blend trend]
}

/// [blend bias] b_j = D_j + b_r with D_j the mean difference from the reference, shrunk by its noise, and
/// b_r = G min(a_r, L/2 fresh), fresh = min(1, L / a_r), G the slope of all D_j against the gaps of age, L the longest.
/// Extrapolating further than ages reach is not supported by what was seen: a pixel without samples grows old without
/// learning anything. trend: of each difference, what its noise is shrunk towards ([blend trend]); 0 = towards none.
///
/// [blend kappa] kappa = max_j spread_j / (s2 Var(X_j - X_r)): noise that reuse or sharing correlates, so that
/// histories average less of it away than the power sums say.
template <int K>
WindowEvidence<K> windowEvidence(const Ledger<K>& ledger, const Against<K>& a, const DriftRow& row, int i,
                                 bool measuredNoise, const Trends& trend = {}) {
  WindowEvidence<K> e;
  const float s2 = row.meanSampleVariance(i), deviation = std::sqrt(s2);
  float slope = 0, gaps = 0, longest = 0;
  for (int k = 0; k < K - 1; ++k) {
    const int j = a.of[k];
    const float gap = ledger.age(j) - ledger.age(a.reference);
    const float shrunk = shrunkMean(row, k, i, measuredNoise, trend[k] * gap * row.meanBrightness(i));
    e.bias[j] = std::copysign(std::min(cappedRatio(std::abs(shrunk), deviation), 1e3f), shrunk);
    slope += e.bias[j] * gap, gaps += gap * gap, longest = std::max(longest, gap);
    const float predicted = s2 * pairOf(ledger, j, a.reference).difference();
    if (measuredNoise) e.noise = std::max(e.noise, cappedRatio(row.spread(k, i), predicted));  // [blend kappa]
  }
  if (!(gaps > 1e-3f)) return e;
  const float age = ledger.age(a.reference);
  e.fresh = longest < age ? std::max(longest, 0.0f) / age : 1.0f;
  const float own = slope / gaps * std::min(age, 0.5f * longest * e.fresh);
  for (float& b : e.bias) b += own;  // [blend bias]
  return e;
}

/// [blend lag] with M = kappa C + rho b b', rho the share of b b' that nothing takes away later. A slower history may
/// get a negative weight, down to [blend limit], in proportion to the evidence of its bias (b_j^2 over its variance, at
/// most 1); the reference never.
template <int K>
std::array<float, K> lagWeights(const Ledger<K>& ledger, const Against<K>& a, const WindowEvidence<K>& e, float rho,
                                float lowest) {
  Matrix<K, float> m = covarianceOf(ledger);
  std::array<float, K> limit{};
  for (int j = 0; j < K; ++j) {
    const float variance = e.noise * m[j][j];
    for (int k = 0; k < K; ++k) m[j][k] = e.noise * m[j][k] + rho * e.bias[j] * e.bias[k];
    if (j != a.reference)
      limit[j] = lowest * std::min(1.0f, cappedRatio(e.bias[j] * e.bias[j], variance));  // [blend limit]
  }
  return leastErrorWeights<K, float>(m, limit);  // [blend lag]
}

}  // namespace twohistory
