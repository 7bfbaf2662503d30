// The ledger holds what depends on sample counts alone: weights, ages and power sums of K histories of one input.
//
// It never sees a value, so a history's weight cannot depend on the samples it weighs and reuse stays unbiased by
// construction. With C_gh the power sum of histories g and h, of weights W, and s2 the variance of one sample:
//
//   [ledger 1]  W(t)    = d W(t-1) + w,            w = n^e, 0 where n = 0; d = factor forgotten that frame
//   [ledger 2]  A(t)    = d (A(t-1) + W(t-1)),     mean age in frames = A / W
//   [ledger 3]  C_gh(t) = d_g d_h C_gh(t-1) + w_g w_h / n
//   [ledger 4]  Cov(X_g, X_h) = s2 C_gh / (W_g W_h)
//
// For the slides' pair (same decay, e = 0 and 1) C_uu = S_-1, C_uw = S_0, C_ww = S_1. Source: [Tu24] "First phase of
// blending"; the recursion for any pair of decays is this project's.
#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "core/image.h"
#include "twohistory/policy.h"
#include "twohistory/taps.h"

namespace twohistory {

/// Index of the pair (g, h) in an upper triangle stored row by row; g and h in [0, K), any order.
template <int K>
constexpr int pairIndex(int g, int h) {
  const int a = g < h ? g : h, b = g < h ? h : g;
  return a * K - a * (a - 1) / 2 + (b - a);
}

/// One policy a history.
template <int K>
using Policies = std::type_identity_t<std::array<Policy, K>>;

template <int K, class Real = float>
struct Ledger {
  static constexpr int kPairs = K * (K + 1) / 2;
  std::array<Real, K> weight{};          ///< W
  std::array<Real, K> ageSum{};          ///< A
  std::array<Real, kPairs> powerSums{};  ///< C_gh

  /// Mean age of history j in frames; 0 where it is empty.
  Real age(int j) const { return weight[j] > 0 ? ageSum[j] / weight[j] : Real(0); }
  /// [ledger 4] in units of s2; 0 where a history is empty.
  Real covariance(int g, int h) const {
    if (!(weight[g] > 0 && weight[h] > 0)) return 0;
    return powerSums[pairIndex<K>(g, h)] / weight[g] / weight[h];  // [ledger 4]; W_g W_h could underflow
  }
};

/// How much of each history one frame forgets, and what it adds.
template <int K, class Real = float>
struct Advance {
  std::array<Real, K> factor{};  ///< d, in [0, 1]
  std::array<Real, K> fresh{};   ///< w(n)
};

template <int K, class Real>
Advance<K, Real> advanceOf(const Ledger<K, Real>& gathered, const Policies<K>& policies, Real n) {
  Advance<K, Real> a;
  for (int j = 0; j < K; ++j) {
    a.fresh[j] = freshWeight(policies[j], n);
    a.factor[j] = forgetFactor(policies[j].forgetting, policies[j].amount, gathered.weight[j], a.fresh[j]);
  }
  return a;
}

/// The ledger after a frame of n >= 0 samples. gathered: what the taps know, all zero after a reset.
template <int K, class Real>
Ledger<K, Real> advance(const Ledger<K, Real>& gathered, const Advance<K, Real>& a, Real n) {
  Ledger<K, Real> now;
  for (int g = 0; g < K; ++g) {
    now.weight[g] = a.factor[g] * gathered.weight[g] + a.fresh[g];            // [ledger 1]
    now.ageSum[g] = a.factor[g] * (gathered.ageSum[g] + gathered.weight[g]);  // [ledger 2]
    for (int h = g; h < K; ++h) {
      const int i = pairIndex<K>(g, h);
      const Real kept = a.factor[g] * a.factor[h];
      const Real added = n > 0 ? a.fresh[g] * a.fresh[h] / n : Real(0);
      now.powerSums[i] = kept * gathered.powerSums[i] + added;  // [ledger 3]
    }
  }
  return now;
}

template <int K, class Real>
Ledger<K, Real> advance(const Ledger<K, Real>& gathered, const Policies<K>& policies, Real n) {
  return advance(gathered, advanceOf(gathered, policies, n), n);
}

/// What the taps of the previous frame know [ledger taps]. Weights and age sums are sums, so they mix with b; power
/// sums mix with b^1.5, between b^2 (independent taps) and b (fully dependent ones): measured, see docs/decisions.md.
/// before: anything whose at(index) is or becomes a Ledger<K, Real>.
template <int K, class Real, class Before>
Ledger<K, Real> gatherFrom(const Taps& taps, const Before& before) {
  Ledger<K, Real> sum;
  for (int k = 0; k < 4; ++k) {
    const Real b = taps.b[k];
    if (!(b > 0)) continue;
    const Ledger<K, Real>& tap = before.at(taps.pixel[k]);
    const Real power = b * std::sqrt(b);  // [ledger taps]
    for (int j = 0; j < K; ++j) {
      sum.weight[j] += b * tap.weight[j];
      sum.ageSum[j] += b * tap.ageSum[j];
    }
    for (int i = 0; i < Ledger<K, Real>::kPairs; ++i) sum.powerSums[i] += power * tap.powerSums[i];
  }
  return sum;
}

template <int K, class Real>
Ledger<K, Real> gather(const Taps& taps, std::type_identity_t<core::In<Ledger<K, Real>>> before) {
  return gatherFrom<K, Real>(taps, before);
}

}  // namespace twohistory
