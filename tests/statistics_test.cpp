// Statistics against published tables, closed forms and direct sums.
#include "core/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.h"

namespace core {
namespace {

TEST(RunningMoments, AgreeWithTwoPassSumsFarFromZero) {
  // A naive sum of squares in double precision loses all digits of this variance.
  const std::vector<double> values{1e9 + 4, 1e9 + 7, 1e9 + 13, 1e9 + 16};
  RunningMoments moments;
  for (const double x : values) moments.add(x);
  EXPECT_DOUBLE_EQ(moments.mean(), 1e9 + 10);
  EXPECT_DOUBLE_EQ(moments.variance(), 30);
  EXPECT_DOUBLE_EQ(moments.meanVariance(), 7.5);
}

TEST(RunningMoments, MergingTwoStreamsGivesOne) {
  Rng rng(1, Pass::lab, 0, 0);
  for (int split = 0; split <= 50; ++split) {
    RunningMoments whole, left, right;
    for (int i = 0; i < 50; ++i) {
      const double x = 100 + rng.uniform();
      whole.add(x);
      (i < split ? left : right).add(x);
    }
    left.merge(right);
    EXPECT_EQ(left.count(), whole.count());
    EXPECT_NEAR(left.mean(), whole.mean(), 1e-11);
    EXPECT_NEAR(left.variance(), whole.variance(), 1e-11);
  }
}

TEST(RunningMoments, FewerThanTwoNumbersHaveNoVariance) {
  RunningMoments moments;
  EXPECT_EQ(moments.variance(), 0);
  moments.add(3);
  EXPECT_EQ(moments.variance(), 0);
  EXPECT_EQ(moments.mean(), 3);
}

struct Quantile {
  double dof, probability, t;
};

// Published tables of Student's t (NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2), three decimals.
TEST(Student, QuantilesAgreeWithPublishedTables) {
  for (const auto& [dof, probability, t] : std::vector<Quantile>{{1, .975, 12.706},
                                                                 {2, .975, 4.303},
                                                                 {3, .975, 3.182},
                                                                 {4, .975, 2.776},
                                                                 {9, .975, 2.262},
                                                                 {30, .975, 2.042},
                                                                 {100, .975, 1.984},
                                                                 {1, .95, 6.314},
                                                                 {5, .99, 3.365},
                                                                 {2, .999, 22.327}})
    EXPECT_NEAR(studentQuantile(probability, dof), t, 5.1e-4) << dof << " " << probability;
}

// Closed forms: one degree of freedom is Cauchy's distribution, two have t = (2p - 1) / sqrt(2 p (1 - p)).
TEST(Student, QuantilesAgreeWithClosedForms) {
  for (const double p : {1e-9, 1e-3, 0.02, 0.3, 0.5, 0.6, 0.975, 0.9999}) {
    const double cauchy = -1 / std::tan(std::numbers::pi * p), two = (2 * p - 1) / std::sqrt(2 * p * (1 - p));
    EXPECT_NEAR(studentQuantile(p, 1), cauchy, 1e-10 * (1 + std::abs(cauchy))) << p;
    EXPECT_NEAR(studentQuantile(p, 2), two, 1e-10 * (1 + std::abs(two))) << p;
  }
}

TEST(Student, CdfInvertsTheQuantileAndTendsToTheNormal) {
  for (const double dof : {1.0, 2.5, 7.0, 40.0, 1e4})
    for (const double p : {0.001, 0.2, 0.5, 0.9, 0.9995})
      EXPECT_NEAR(studentCdf(studentQuantile(p, dof), dof), p, 1e-12);
  EXPECT_NEAR(studentQuantile(0.975, 1e7), normalQuantile(0.975), 1e-6);
}

TEST(Normal, QuantilesAgreeWithAnotherImplementation) {
  // Python 3.11, statistics.NormalDist().inv_cdf.
  EXPECT_NEAR(normalQuantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normalQuantile(0.5), 0, 1e-12);
  EXPECT_NEAR(normalQuantile(1e-10), -6.361340902404056, 1e-10);
}

TEST(IncompleteBeta, AgreesWithClosedForms) {
  for (const double x : {0.0, 1e-8, 0.2, 0.5, 0.9, 1.0}) {
    EXPECT_NEAR(incompleteBeta(x, 1, 1), x, 1e-14);
    EXPECT_NEAR(incompleteBeta(x, 2, 1), x * x, 1e-14);
    EXPECT_NEAR(incompleteBeta(x, 1, 3), 1 - std::pow(1 - x, 3), 1e-13);
    EXPECT_NEAR(incompleteBeta(x, 0.5, 0.5), 2 / std::numbers::pi * std::asin(std::sqrt(x)), 1e-13);
  }
}

TEST(Sidak, BoundKeepsTheFamilyWiseSignificance) {
  EXPECT_NEAR(sidakBound(1, 0.05), normalQuantile(0.975), 1e-12);
  // P(all of N within the bound) = 1 - significance.
  for (const std::int64_t tests : {10, 1000, 1000000}) {
    const double z = sidakBound(tests, 1e-3);
    const double within = std::pow(1 - std::erfc(z / std::sqrt(2.0)), static_cast<double>(tests));
    EXPECT_NEAR(within, 1 - 1e-3, 1e-8) << tests;
    EXPECT_GT(z, normalQuantile(1 - 0.5e-3));
  }
}

/// Share of 4,000 sets of `size` normal numbers whose interval holds the true mean `mean + shift`.
double coverage(int size, double shift, double factorOfT) {
  int inside = 0;
  for (std::uint32_t trial = 0; trial < 4000; ++trial) {
    Rng rng(2, Pass::lab, trial, 0);
    std::vector<double> values;
    for (int i = 0; i < size; ++i) values.push_back(normalQuantile((rng.uniform() + 0x1p-25) * (1 - 0x1p-24)));
    const Interval interval = meanInterval(values);
    const double half = factorOfT * interval.halfWidth();
    inside += std::abs(interval.mean - shift) <= half;
  }
  return inside / 4000.0;
}

// Binomial, 4,000 trials at 0.95: standard error 0.00345; bound 4.9 standard errors (significance 1e-6).
TEST(MeanInterval, HoldsTheMeanInNinetyFivePercentOfSmallSamples) {
  for (const int size : {2, 3, 5}) EXPECT_NEAR(coverage(size, 0, 1), 0.95, 0.017) << size;
}
TEST(MeanInterval, NormalIntervalsOfThreeSeedsAreCaughtAsTooNarrow) {
  EXPECT_LT(coverage(3, 0, normalQuantile(0.975) / studentQuantile(0.975, 2)), 0.95 - 0.017);
}
TEST(MeanInterval, ABiasedMeanIsCaught) { EXPECT_LT(coverage(5, 0.5, 1), 0.95 - 0.017); }

TEST(MeanInterval, OneNumberHasNoInterval) {
  const Interval one = meanInterval(std::vector<double>{2.5});
  EXPECT_EQ(one.mean, 2.5);
  EXPECT_TRUE(std::isnan(one.low) && std::isnan(one.high));
  EXPECT_TRUE(std::isnan(meanInterval(std::vector<double>{}).mean));
}

TEST(GeometricMean, AndMedian) {
  EXPECT_DOUBLE_EQ(geometricMean(std::vector<double>{1, 4, 16}), 4);
  EXPECT_TRUE(std::isnan(geometricMean(std::vector<double>{1, 0})));
  EXPECT_TRUE(std::isnan(geometricMean(std::vector<double>{1, -2})));
  EXPECT_TRUE(std::isnan(geometricMean(std::vector<double>{})));
  EXPECT_EQ(median(std::vector<double>{9, 1, 5}), 5);
  EXPECT_EQ(median(std::vector<double>{9, 1, 5, 6}), 5.5);
  EXPECT_TRUE(std::isnan(median(std::vector<double>{})));
}

}  // namespace
}  // namespace core
