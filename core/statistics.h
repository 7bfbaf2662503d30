// Small-sample statistics in double precision: running moments, confidence intervals, multiple-test bounds.
// Sources: Chan, Golub, LeVeque, "Updating Formulae and a Pairwise Algorithm for Computing Sample Variances" (1979);
// Abramowitz and Stegun, "Handbook of Mathematical Functions", 26.5 and 26.7 (incomplete beta, Student's t).
#pragma once

#include <cstdint>
#include <span>

namespace core {

/// Mean and variance of a stream of numbers; merging two streams gives what one stream would have (to rounding).
class RunningMoments {
 public:
  void add(double x) {
    ++count_;
    const double delta = x - mean_;
    mean_ += delta / static_cast<double>(count_);
    squares_ += delta * (x - mean_);
  }
  void merge(const RunningMoments& other);

  std::int64_t count() const { return count_; }
  double mean() const { return mean_; }
  /// Unbiased sample variance; 0 for fewer than two numbers.
  double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }
  /// Variance of mean(), assuming independent numbers; 0 for fewer than two.
  double meanVariance() const { return count_ > 1 ? variance() / static_cast<double>(count_) : 0; }

 private:
  std::int64_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

/// A mean with a two-sided confidence interval. low and high are NaN where one number alone gives none.
struct Interval {
  double mean = 0, low = 0, high = 0;
  /// Half the interval's width; NaN where there is none.
  double halfWidth() const { return 0.5 * (high - low); }
};

/// Student's t interval of the mean. confidence in (0, 1). No numbers give NaN throughout.
Interval meanInterval(const RunningMoments& moments, double confidence = 0.95);
Interval meanInterval(std::span<const double> values, double confidence = 0.95);

/// Interval of the geometric mean, by Student's t on logarithms. NaN throughout if a value is not positive.
Interval geometricInterval(std::span<const double> values, double confidence = 0.95);

/// Geometric mean; NaN if empty or if a value is not positive.
double geometricMean(std::span<const double> values);
/// Middle value, mean of the two middle ones for an even count; NaN if empty.
double median(std::span<const double> values);

/// x with P(N(0,1) <= x) = probability, probability in (0, 1); relative accuracy about 1e-12.
double normalQuantile(double probability);
/// P(T <= t) for Student's t with dof > 0 degrees of freedom (need not be whole).
double studentCdf(double t, double dof);
/// t with P(T <= t) = probability, probability in (0, 1).
double studentQuantile(double probability, double dof);
/// Regularised incomplete beta function I_x(a, b), a, b > 0, x in [0, 1].
double incompleteBeta(double x, double a, double b);

/// |z| that the largest of `tests` independent two-sided z-tests exceeds with probability `significance` if nothing is
/// wrong. Source: Sidak, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions" (1967).
double sidakBound(std::int64_t tests, double significance);

}  // namespace core
