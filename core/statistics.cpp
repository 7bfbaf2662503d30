#include "core/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/check.h"
#include "core/maths.h"

namespace core {

namespace {

/// P(N > x), accurate in the upper tail.
double normalUpperTail(double x) { return 0.5 * std::erfc(x / std::sqrt(2.0)); }

/// x >= 0 with upperTail(x) = tail, tail in (0, 0.5]: doubles an upper end, then bisects to the last bit.
template <class UpperTail>
double invertUpperTail(double tail, UpperTail&& upperTail) {
  double low = 0, high = 1;
  while (upperTail(high) > tail && high < 1e300) low = high, high *= 2;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (upperTail(middle) > tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Even part of the continued fraction of I_x(a, b) by the modified Lentz method [Abramowitz and Stegun 26.5.8].
double betaFraction(double x, double a, double b) {
  constexpr double kTiny = 1e-300;
  const auto guarded = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1, d = 1 / guarded(1 - (a + b) * x / (a + 1)), result = d;
  for (int m = 1; m < 100000; ++m) {
    const double m2 = 2.0 * m;
    const double even = m * (b - m) * x / ((a + m2 - 1) * (a + m2));
    d = 1 / guarded(1 + even * d), c = guarded(1 + even / c), result *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + m2) * (a + m2 + 1));
    d = 1 / guarded(1 + odd * d), c = guarded(1 + odd / c), result *= d * c;
    if (std::abs(d * c - 1) < 1e-16) break;
  }
  return result;
}

/// P(T > t) for t >= 0, accurate in the tail [Abramowitz and Stegun 26.7.1].
double studentUpperTail(double t, double dof) { return 0.5 * incompleteBeta(dof / (dof + t * t), 0.5 * dof, 0.5); }

}  // namespace

void RunningMoments::merge(const RunningMoments& other) {
  if (other.count_ == 0) return;
  const auto a = static_cast<double>(count_), b = static_cast<double>(other.count_);
  const double delta = other.mean_ - mean_;
  squares_ += other.squares_ + delta * delta * a * b / (a + b);
  mean_ += delta * b / (a + b);
  count_ += other.count_;
}

Interval meanInterval(const RunningMoments& moments, double confidence) {
  if (moments.count() == 0) return {kNaN, kNaN, kNaN};
  if (moments.count() == 1) return {moments.mean(), kNaN, kNaN};
  const double t = studentQuantile(0.5 + 0.5 * confidence, static_cast<double>(moments.count() - 1));
  const double half = t * std::sqrt(moments.meanVariance());
  return {moments.mean(), moments.mean() - half, moments.mean() + half};
}

Interval meanInterval(std::span<const double> values, double confidence) {
  RunningMoments moments;
  for (const double x : values) moments.add(x);
  return meanInterval(moments, confidence);
}

Interval geometricInterval(std::span<const double> values, double confidence) {
  RunningMoments logarithms;
  for (const double x : values) {
    if (!(x > 0)) return {kNaN, kNaN, kNaN};
    logarithms.add(std::log(x));
  }
  const Interval interval = meanInterval(logarithms, confidence);
  return {std::exp(interval.mean), std::exp(interval.low), std::exp(interval.high)};
}

double geometricMean(std::span<const double> values) { return geometricInterval(values).mean; }

double median(std::span<const double> values) {
  if (values.empty()) return kNaN;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

double incompleteBeta(double x, double a, double b) {
  CHECK(a > 0 && b > 0);
  if (!(x > 0)) return 0;
  if (x >= 1) return 1;
  const double logFactor = std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
  if (x < (a + 1) / (a + b + 2)) return std::exp(logFactor) * betaFraction(x, a, b) / a;
  return 1 - std::exp(logFactor) * betaFraction(1 - x, b, a) / b;
}

double normalQuantile(double probability) {
  CHECK(probability > 0 && probability < 1);
  const double x = invertUpperTail(std::min(probability, 1 - probability), normalUpperTail);
  return probability < 0.5 ? -x : x;
}

double studentCdf(double t, double dof) {
  CHECK_GT(dof, 0.0);
  const double tail = studentUpperTail(std::abs(t), dof);
  return t > 0 ? 1 - tail : tail;
}

double studentQuantile(double probability, double dof) {
  CHECK(probability > 0 && probability < 1 && dof > 0);
  const auto tail = [dof](double t) { return studentUpperTail(t, dof); };
  const double t = invertUpperTail(std::min(probability, 1 - probability), tail);
  return probability < 0.5 ? -t : t;
}

double sidakBound(std::int64_t tests, double significance) {
  CHECK(tests > 0 && significance > 0 && significance < 1);
  // Significance of one test: 1 - (1 - significance)^(1/tests), written so that it keeps its digits [Sidak 1967].
  const double single = -std::expm1(std::log1p(-significance) / static_cast<double>(tests));
  return invertUpperTail(0.5 * single, normalUpperTail);
}

}  // namespace core
