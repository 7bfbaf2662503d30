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

#include <algorithm>
#include <array>
#include <type_traits>

#include "core/image.h"
#include "twohistory/mixing.h"
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

/// carried: of the frame's Taps.
template <int K, class Real>
Advance<K, Real> advanceOf(const Ledger<K, Real>& gathered, const Policies<K>& policies, Real n, Real carried = 1) {
  Advance<K, Real> a;
  for (int j = 0; j < K; ++j) {
    a.fresh[j] = freshWeight(policies[j], n);
    a.factor[j] = carried * forgetFactor(policies[j].forgetting, policies[j].amount, gathered.weight[j], a.fresh[j]);
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

/// Sums over the taps of the previous frame.
template <int K, class Real = float>
struct TapSums {
  Ledger<K, Real> ledger;                              ///< weights and age sums with b, power sums with b^2
  std::array<Real, Ledger<K, Real>::kPairs> shared{};  ///< power sums with b (1 - b)
};

/// before: anything whose at(index) is or becomes a Ledger<K, Real>.
template <int K, class Real, class Before>
TapSums<K, Real> sumTaps(const Taps& taps, const Before& before) {
  TapSums<K, Real> sum;
  for (int k = 0; k < 4; ++k) {
    const Real b = taps.b[k];
    if (!(b > 0)) continue;
    const Ledger<K, Real>& tap = before.at(taps.pixel[k]);
    for (int j = 0; j < K; ++j) {
      sum.ledger.weight[j] += b * tap.weight[j];
      sum.ledger.ageSum[j] += b * tap.ageSum[j];
    }
    for (int i = 0; i < Ledger<K, Real>::kPairs; ++i) {
      const Real part = b * tap.powerSums[i];
      sum.ledger.powerSums[i] += b * part;
      sum.shared[i] += part - b * part;
    }
  }
  return sum;
}

/// How alike the taps of each history are (mixing.h). walk: of the frames before, as SettledWalk; a: what the frame
/// that comes does to it; n: its samples.
template <int K, class Real, class Walk>
std::array<Real, K> likenesses(const TapSums<K, Real>& sums, const TapPairs& pairs, const Walk& walk,
                               const Policies<K>& policies, const Advance<K, Real>& a, Real n) {
  std::array<Real, K> r{};
  for (int j = 0; j < K; ++j) {
    const int i = pairIndex<K>(j, j);
    const Real noise = sums.ledger.powerSums[i] + sums.shared[i];
    if (!(noise > 0)) continue;
    const Remembered<Real> history{sums.ledger.weight[j], sums.ledger.ageSum[j], a.factor[j]};
    const Real freshShare = std::min(Real(1), walk.freshNoise(policies[j], n) / noise);
    r[j] = tapLikeness(pairs, walk.older(pairs, history, freshShare), freshShare,
                       walk.edge(pairs, policies[j], history, noise));
  }
  return r;
}

/// What the taps know [ledger taps]. Weights and age sums are sums, so they mix with b; power sums mix between b^2
/// (independent taps) and b (one value), by how alike they are. The harmonic mean of two histories' likenesses keeps
/// them a covariance matrix: 1 / (x_g + x_h) is positive semidefinite, and so is its product with another, term by
/// term. steps(taps, pairs): the walk of the frames before, or its steps (WalkMemory, LikelySteps); width:
/// of the image that the taps point into.
template <int K, class Real, class Steps>
Ledger<K, Real> mix(const TapSums<K, Real>& sums, const Taps& taps, int width, const Steps& steps,
                    const Policies<K>& policies, const Advance<K, Real>& a, Real n) {
  Ledger<K, Real> mixed = sums.ledger;
  const TapPairs pairs = pairsOf(taps, width);
  if (!(pairs.all() > 0)) return mixed;
  const std::array<Real, K> r = likenesses<K, Real>(sums, pairs, walkOf(steps(taps, pairs)), policies, a, n);
  for (int i = 0, g = 0; g < K; ++g)
    for (int h = g; h < K; ++h, ++i) {
      const Real both = g == h ? r[g] : 2 * r[g] * r[h] / std::max(r[g] + r[h], Real(1e-20));
      mixed.powerSums[i] += both * sums.shared[i];  // [ledger taps]
    }
  return mixed;
}

/// What a frame of n samples finds under its taps. before: without padding; steps: as for mix.
template <int K, class Real, class Steps = LikelySteps<Real>>
Ledger<K, Real> gather(const Taps& taps, std::type_identity_t<core::In<Ledger<K, Real>>> before,
                       const Policies<K>& policies, Real n, const Steps& steps = {}) {
  const auto sums = sumTaps<K, Real>(taps, before);
  return mix(sums, taps, before.width, steps, policies, advanceOf<K, Real>(sums.ledger, policies, n, taps.carried), n);
}

}  // namespace twohistory
