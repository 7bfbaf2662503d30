// Convex and extrapolating combinations of histories: the closed forms behind every blend, one pixel at a time.
//
// X_1, X_2 are two histories of one input with Cov(X_g, X_h) = s2 C_gh / (W_g W_h) ([ledger 4]). p always weighs the
// history named first: blend = p X_1 + (1 - p) X_2.
// Sources: [Tu24] "First phase of blending" (its headline formula is kept as publishedWeight for reproduction); lag
// regression and the consistent blend are this project's, derived in docs/history.md.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "twohistory/ledger.h"

namespace twohistory {

/// Variances and covariance of two histories in units of one sample's variance.
template <class Real = float>
struct PairCovariance {
  Real first, second, cross;

  Real gainOfFirst() const { return second - cross; }  ///< A: what moving to the first history saves
  Real gainOfSecond() const { return first - cross; }  ///< B
  /// Var(X_1 - X_2), >= 0.
  Real difference() const { return std::max(Real(0), gainOfFirst() + gainOfSecond()); }
  /// Variance of p X_1 + (1 - p) X_2, never negative through rounding.
  Real blend(Real p) const {
    const Real q = 1 - p;
    return std::max(Real(0), q * q * second + 2 * p * q * cross + p * p * first);
  }
};

template <int K, class Real>
PairCovariance<Real> pairOf(const Ledger<K, Real>& ledger, int first, int second) {
  return {ledger.covariance(first, first), ledger.covariance(second, second), ledger.covariance(first, second)};
}

/// [blend opt] p_opt = A / (A + B) with A = V_2 - C, B = V_1 - C: least variance with p in [0, 1]. No cancelling
/// denominator: 1 where B <= 0 (also where both histories are the same), 0 where A <= 0.
template <class Real>
Real leastVarianceWeight(const PairCovariance<Real>& c) {
  const Real a = c.gainOfFirst(), b = c.gainOfSecond();
  if (!(b > 0)) return 1;
  if (!(a > 0)) return 0;
  return a / (a + b);  // [blend opt]
}

/// [blend published] p as the slides' headline prints it, S_0 and S_1 in each other's places; for reproduction only.
/// first must be the frames history, second the samples history. 1 where the printed denominator is 0.
template <int K, class Real>
Real publishedWeight(const Ledger<K, Real>& l, int first, int second) {
  const Real wu = l.weight[first], ww = l.weight[second];
  const Real sMinus = l.powerSums[pairIndex<K>(first, first)], s0 = l.powerSums[pairIndex<K>(first, second)],
             s1 = l.powerSums[pairIndex<K>(second, second)];
  const Real denominator = wu * wu * s1 - 2 * wu * ww * s1 + ww * ww * sMinus;
  if (denominator == 0) return 1;
  return std::clamp((wu * wu * s0 - wu * ww * s1) / denominator, Real(0), Real(1));  // [blend published]
}

/// [blend consistent] p = (A + kappa) / (A + B + kappa): least variance plus squared difference from the first
/// history's bias. kappa = max(0, D^2 - noise^2) / s2 >= 0, may be infinite.
template <class Real>
Real consistentWeight(const PairCovariance<Real>& c, Real kappa) {
  const Real a = std::max(Real(0), c.gainOfFirst()), b = std::max(Real(0), c.gainOfSecond());
  if (!(b > 0) || !(kappa < std::numeric_limits<Real>::infinity())) return 1;
  return (a + kappa) / (a + b + kappa);  // [blend consistent]
}

/// Squared drift per frame in units of s2 [blend G2]: max(0, D^2 - noise2) / (a_1 - a_2)^2, 0 where the ages differ by
/// less than 1e-3 frames. excess = max(0, D^2 - noise2) / s2.
template <class Real>
Real squaredDrift(Real excess, Real firstAge, Real secondAge) {
  const Real gap = firstAge - secondAge;
  return std::abs(gap) < Real(1e-3) ? Real(0) : excess / (gap * gap);  // [blend G2]
}

/// [blend lag, two] p = (M_22 - M_12) / (M_11 - 2 M_12 + M_22) with M_jk = C_jk + g a_j a_k, written without
/// cancelling terms; g = G2 / s2. Not clamped. 1 where the denominator vanishes against the variances.
template <class Real>
Real lagWeight(const PairCovariance<Real>& c, Real firstAge, Real secondAge, Real g) {
  const Real gap = secondAge - firstAge;
  const Real numerator = c.gainOfFirst() + g * secondAge * gap;  // [blend lag, two]
  const Real denominator = c.gainOfFirst() + c.gainOfSecond() + g * gap * gap;
  return denominator > Real(1e-6) * (c.first + c.second) ? numerator / denominator : Real(1);
}

template <int K, class Real>
using Matrix = std::array<std::array<Real, K>, K>;

/// Covariances of all K histories in units of s2 [ledger 4].
template <int K, class Real>
Matrix<K, Real> covarianceOf(const Ledger<K, Real>& ledger) {
  Matrix<K, Real> c{};
  for (int j = 0; j < K; ++j)
    for (int k = 0; k <= j; ++k) c[j][k] = c[k][j] = ledger.covariance(j, k);
  return c;
}

/// lambda' C lambda, never negative through rounding.
template <int K, class Real>
Real varianceOf(const Matrix<K, Real>& c, const std::array<Real, K>& lambda) {
  Real sum = 0;
  for (int j = 0; j < K; ++j)
    for (int k = 0; k < K; ++k) sum += lambda[j] * lambda[k] * c[j][k];
  return std::max(Real(0), sum);
}

/// x with (m + ridge) x = right, by Cholesky; m symmetric, positive semi-definite, ridge > 0.
template <int K, class Real>
std::array<Real, K> solvePositive(const Matrix<K, Real>& m, const std::array<Real, K>& right, Real ridge) {
  Matrix<K, Real> l{};  // m + ridge = l l'
  for (int j = 0; j < K; ++j) {
    for (int k = 0; k <= j; ++k) {
      Real sum = m[j][k] + (j == k ? ridge : Real(0));
      for (int i = 0; i < k; ++i) sum -= l[j][i] * l[k][i];
      l[j][k] = j == k ? std::sqrt(std::max(sum, ridge)) : sum / l[k][k];
    }
  }
  std::array<Real, K> x = right;
  for (int j = 0; j < K; ++j) {
    for (int i = 0; i < j; ++i) x[j] -= l[j][i] * x[i];
    x[j] /= l[j][j];
  }
  for (int j = K - 1; j >= 0; --j) {
    for (int i = j + 1; i < K; ++i) x[j] -= l[i][j] * x[i];
    x[j] /= l[j][j];
  }
  return x;
}

/// x with (m + ridge) x = 1, otherwise the same.
template <int K, class Real>
std::array<Real, K> solveOnes(const Matrix<K, Real>& m, Real ridge) {
  std::array<Real, K> ones;
  ones.fill(1);
  return solvePositive<K, Real>(m, ones, ridge);
}

/// Weights of sum 1 with the least lambda' C lambda among the histories whose bit is set in `subset`; 0 for the others.
/// Histories that are the same within rounding give weights that may be anything, NaN included.
template <int K>
std::array<double, K> subsetWeights(const Matrix<K, double>& c, unsigned subset) {
  const auto in = [subset](int j) { return (subset >> j & 1u) != 0; };
  Matrix<K, double> m{};
  double trace = 0, total = 0;
  for (int j = 0; j < K; ++j) {
    for (int k = 0; k < K; ++k) m[j][k] = in(j) && in(k) ? c[j][k] : double(j == k);
    if (in(j)) trace += c[j][j];
  }
  std::array<double, K> x = solveOnes<K, double>(m, 1e-12 * trace);
  for (int j = 0; j < K; ++j) total += x[j] = in(j) ? x[j] : 0.0;
  for (double& w : x) w /= total;
  return x;
}

/// Moves weights of sum 1 towards the single history `best` until none lies below its limit (<= 0).
template <int K, class Real>
std::array<Real, K> shrunk(std::array<Real, K> lambda, int best, const std::array<Real, K>& lowest) {
  Real keep = 1;  // share of lambda that stays within the limits
  for (int j = 0; j < K; ++j) {
    const Real target = j == best ? Real(1) : Real(0);
    if (lambda[j] < lowest[j]) keep = std::min(keep, (lowest[j] - target) / (lambda[j] - target));
  }
  for (int j = 0; j < K; ++j) {
    const Real target = j == best ? Real(1) : Real(0);
    lambda[j] = target + keep * (lambda[j] - target);
  }
  return lambda;
}

/// [blend lag] lambda = M^-1 1 / (1' M^-1 1), the weights of sum 1 with the least lambda' M lambda, with a ridge of
/// 1e-4 of the mean diagonal; then shrunk until none lies below its limit (<= 0). Without limits three histories were
/// unstable (up to 15 times the error of one).
template <int K, class Real>
std::array<Real, K> leastErrorWeights(const Matrix<K, Real>& m, const std::array<Real, K>& lowest) {
  Real trace = 0;
  int best = 0;
  for (int j = 0; j < K; ++j) {
    trace += m[j][j];
    if (m[j][j] < m[best][best]) best = j;
  }
  std::array<Real, K> lambda{};
  lambda[best] = 1;
  const Real ridge = Real(1e-4) * trace / K;
  if (!(ridge > 0)) return lambda;
  std::array<Real, K> x = solveOnes<K, Real>(m, ridge);
  Real total = 0;
  for (const Real w : x) total += w;
  if (!(total > 0)) return lambda;
  for (Real& w : x) w /= total;
  return shrunk<K, Real>(x, best, lowest);
}

/// [blend opt] for any K: weights >= 0 of sum 1 with the least lambda' C lambda. The optimum is the unconstrained one
/// of some subset of the histories, so all subsets whose weights are not negative are tried; one history alone always
/// is. Where several are equal, the one with the earliest histories. Cost 2^K small systems, in double: meant for K
/// <= 4.
template <int K, class Real>
std::array<Real, K> leastVarianceWeights(const Matrix<K, Real>& covariance) {
  Matrix<K, double> c{};
  for (int j = 0; j < K; ++j)
    for (int k = 0; k < K; ++k) c[j][k] = static_cast<double>(covariance[j][k]);
  std::array<double, K> best{1};
  double least = c[0][0];
  for (unsigned subset = 2; subset < 1u << K; ++subset) {
    const std::array<double, K> x = subsetWeights<K>(c, subset);
    if (std::any_of(x.begin(), x.end(), [](double w) { return !(w >= 0); })) continue;
    const double variance = varianceOf<K, double>(c, x);
    if (variance < least) least = variance, best = x;
  }
  std::array<Real, K> result;
  std::transform(best.begin(), best.end(), result.begin(), [](double w) { return static_cast<Real>(w); });
  return result;
}

/// The same for one drift g = G^2 / s2 a frame, M_jk = C_jk + g a_j a_k, and one limit.
template <int K, class Real>
std::array<Real, K> lagWeights(const Ledger<K, Real>& ledger, Real g, Real lowest) {
  Matrix<K, Real> m{};
  for (int j = 0; j < K; ++j)
    for (int k = 0; k < K; ++k) m[j][k] = ledger.covariance(j, k) + g * ledger.age(j) * ledger.age(k);
  std::array<Real, K> limits;
  limits.fill(lowest);
  return leastErrorWeights<K, Real>(m, limits);
}

}  // namespace twohistory
