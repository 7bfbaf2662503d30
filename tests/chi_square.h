// Pearson's chi-square test for the statistical proofs.
// Source: Abramowitz and Stegun, "Handbook of Mathematical Functions", 26.4.
#pragma once

#include <cmath>
#include <span>

namespace tests {

/// Regularised upper incomplete gamma function Q(a, x), a > 0, x >= 0.
inline double upperGamma(double a, double x) {
  if (x <= 0) return 1;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {  // series of P
    double term = 1 / a, sum = term;
    for (double k = a + 1; term > sum * 1e-16; ++k) sum += term *= x / k;
    return 1 - front * sum;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;  // continued fraction of Q, modified Lentz
  for (int i = 1; i < 10000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return front * h;
}

/// Probability of a chi-square at least this large if counts follow expected (same sum). Cells that expect fewer than
/// 5 are pooled.
inline double chiSquareP(std::span<const double> counts, std::span<const double> expected) {
  double statistic = 0, pooledCount = 0, pooledExpected = 0;
  int cells = 0;
  const auto add = [&](double count, double e) {
    statistic += (count - e) * (count - e) / e;
    ++cells;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] >= 5) {
      add(counts[i], expected[i]);
    } else {
      pooledCount += counts[i];
      pooledExpected += expected[i];
    }
  }
  if (pooledExpected > 0) add(pooledCount, pooledExpected);
  if (pooledExpected <= 0 && pooledCount > 0) return 0;  // the impossible happened
  return cells > 1 ? upperGamma(0.5 * (cells - 1), 0.5 * statistic) : 1;
}

}  // namespace tests
