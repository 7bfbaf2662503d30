// The closed forms behind the blends, against brute force over the sequence and over p.
#include "twohistory/combination.h"

#include <gtest/gtest.h>

#include "tests/schedule.h"

namespace {

using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::PairCovariance;
using twohistory::Policy;
using twohistory::Weighting;

const Policy kU{Weighting::frames, Forgetting::decay, 0.95}, kW{Weighting::samples, Forgetting::decay, 0.95},
    kF{Weighting::samples, Forgetting::decay, 0.8};

/// Variances of U and W and their covariance by definition.
struct Truth {
  long double u, w, cross;
  Truth(const std::vector<int>& counts, double decay) {
    const tests::BruteForce uu(counts, decay, Weighting::frames, decay, Weighting::frames);
    const tests::BruteForce uw(counts, decay, Weighting::frames, decay, Weighting::samples);
    const tests::BruteForce ww(counts, decay, Weighting::samples, decay, Weighting::samples);
    u = uu.cross / (uu.weightG * uu.weightG);
    w = ww.cross / (ww.weightG * ww.weightG);
    cross = uw.cross / (uw.weightG * uw.weightH);
  }
  long double blend(long double p) const { return p * p * u + 2 * p * (1 - p) * cross + (1 - p) * (1 - p) * w; }
  long double best() const {
    const long double a = w - cross, b = u - cross;
    const long double p = b <= 0 ? 1 : a <= 0 ? 0 : a / (a + b);
    return blend(p);
  }
};

template <class Real>
Ledger<2, Real> pairLedger(const std::vector<int>& counts, double decay) {
  Ledger<2, Real> ledger;
  const Policy u{Weighting::frames, Forgetting::decay, decay}, w{Weighting::samples, Forgetting::decay, decay};
  for (const int n : counts) ledger = advance(ledger, {u, w}, static_cast<Real>(n));
  return ledger;
}

TEST(LeastVarianceWeight, RegretOfFloatArithmeticIsBelow1e5) {
  double worst = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    core::Rng rng(11, core::Pass::other, i, 0);
    auto counts = tests::randomCounts(rng, 1 + static_cast<int>(rng.below(200)), rng.uniform() < 0.2f ? 4096 : 64);
    counts.push_back(1);  // some weight in the last frame
    const double decay = tests::randomDecay(rng);
    const float p = leastVarianceWeight(twohistory::pairOf(pairLedger<float>(counts, decay), 0, 1));
    ASSERT_GE(p, 0);
    ASSERT_LE(p, 1);
    const Truth truth(counts, decay);
    worst = std::max(worst, static_cast<double>(truth.blend(p) / truth.best() - 1));
    ASSERT_LE(truth.blend(p), std::min(truth.u, truth.w) * (1 + 1e-5L)) << "schedule " << i;
  }
  EXPECT_LE(worst, 1e-5);
}

TEST(LeastVarianceWeight, HasNextToNoRegretAtConstantCounts) {
  double worst = 0;
  for (const double decay : {0.5, 0.8, 0.9, 0.95})
    for (int n = 1; n <= 4096; n = n < 64 ? n + 1 : n + n / 7)
      for (const int length : {1, 10, 300}) {
        const std::vector<int> counts(length, n);
        const float p = leastVarianceWeight(twohistory::pairOf(pairLedger<float>(counts, decay), 0, 1));
        const Truth truth(counts, decay);
        worst = std::max(worst, static_cast<double>(truth.blend(p) / truth.best() - 1));
      }
  EXPECT_LE(worst, 1e-9);
}

TEST(LeastVarianceWeight, ControlCancellingDenominatorFails) {
  // V_u - 2 C + V_w by subtraction, as one would write it first: at constant counts it is rounding noise.
  int outside = 0;
  for (int n = 3; n < 100; n += 2) {
    const auto l = pairLedger<float>(std::vector<int>(300, n), 0.95);
    const float u = l.weight[0], w = l.weight[1];
    const float numerator = u * u * l.powerSums[2] - u * w * l.powerSums[1];
    const float denominator = u * u * l.powerSums[2] - 2 * u * w * l.powerSums[1] + w * w * l.powerSums[0];
    const float p = numerator / denominator;
    outside += !(p >= 0 && p <= 1);
  }
  EXPECT_GT(outside, 0);
}

TEST(PublishedWeight, IsTheSlidesHeadlineAndWorseThanTheProof) {
  const std::vector<int> counts{1, 1, 1, 8, 8, 1, 1};
  const auto l = pairLedger<double>(counts, 0.95);
  const double u = l.weight[0], w = l.weight[1], minus = l.powerSums[0], s0 = l.powerSums[1], s1 = l.powerSums[2];
  const double printed =
      std::clamp((u * u * s0 - u * w * s1) / (u * u * s1 - 2 * u * w * s1 + w * w * minus), 0.0, 1.0);
  EXPECT_DOUBLE_EQ(twohistory::publishedWeight(l, 0, 1), printed);
  const Truth truth(counts, 0.95);
  EXPECT_GT(truth.blend(printed), truth.best() * 1.001L);
}

TEST(LagWeight, WithoutDriftIsLeastVarianceWithoutItsLimits) {
  int inside = 0;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    core::Rng rng(13, core::Pass::other, i, 0);
    auto counts = tests::randomCounts(rng, 30, 8);
    counts.push_back(8);
    const auto l = pairLedger<double>(counts, 0.9);
    const auto c = twohistory::pairOf(l, 0, 1);
    const double p = twohistory::lagWeight(c, l.age(0), l.age(1), 0.0);
    inside += p > 0 && p < 1;
    ASSERT_NEAR(std::clamp(p, 0.0, 1.0), leastVarianceWeight(c), 1e-9) << "schedule " << i;
  }
  EXPECT_GT(inside, 100);
}

TEST(LagWeight, StrongDriftExtrapolatesToAgeZero) {
  Ledger<2, double> l;
  for (int i = 0; i < 200; ++i) l = advance(l, {kW, kF}, i % 3 ? 1.0 : 8.0);
  const double p = twohistory::lagWeight(twohistory::pairOf(l, 0, 1), l.age(0), l.age(1), 1e12);
  EXPECT_NEAR(p * l.age(0) + (1 - p) * l.age(1), 0, 1e-6);
  EXPECT_LT(p, 0);
}

TEST(LagWeight, MinimisesTheEstimatedErrorItIsDerivedFrom) {
  Ledger<2, double> l;
  for (int i = 0; i < 100; ++i) l = advance(l, {kU, kF}, i % 5 ? 1.0 : 8.0);
  const auto c = twohistory::pairOf(l, 0, 1);
  for (const double g : {0.0, 1e-4, 1e-2, 1.0}) {
    const auto error = [&](double p) {
      const double age = p * l.age(0) + (1 - p) * l.age(1);
      return c.blend(p) + g * age * age;
    };
    const double p = twohistory::lagWeight(c, l.age(0), l.age(1), g);
    for (const double step : {-1e-3, 1e-3}) EXPECT_GT(error(p + step), error(p)) << "g " << g;
  }
}

TEST(LagWeights, OfTwoHistoriesAgreeWithTheOneLine) {
  Ledger<2, double> l;
  for (int i = 0; i < 100; ++i) l = advance(l, {kU, kF}, i % 5 ? 1.0 : 8.0);
  for (const double g : {0.0, 1e-3, 1e-1}) {
    const auto lambda = twohistory::lagWeights(l, g, -10.0);
    const double p = twohistory::lagWeight(twohistory::pairOf(l, 0, 1), l.age(0), l.age(1), g);
    EXPECT_NEAR(lambda[0], p, 0.02 * std::max(1.0, std::abs(p)));  // the ridge moves it a little
    EXPECT_NEAR(lambda[0] + lambda[1], 1, 1e-12);
  }
}

TEST(LagWeights, OfThreeHistoriesRespectTheLimitAndSumToOne) {
  for (std::uint32_t i = 0; i < 5000; ++i) {
    core::Rng rng(12, core::Pass::other, i, 0);
    Ledger<3> l;
    for (const int n : tests::randomCounts(rng, 1 + static_cast<int>(rng.below(100)), 64))
      l = advance(l, {kU, kW, kF}, static_cast<float>(n));
    l = advance(l, {kU, kW, kF}, 1.0f);
    const float g = std::exp2(40 * rng.uniform() - 30);
    const auto lambda = twohistory::lagWeights(l, g, -0.5f);
    for (const float x : lambda) {
      ASSERT_TRUE(std::isfinite(x));
      ASSERT_GE(x, -0.5f - 1e-4f);
    }
    ASSERT_NEAR(lambda[0] + lambda[1] + lambda[2], 1, 1e-4);
  }
}

TEST(ConsistentWeight, RunsFromLeastVarianceToTheFirstHistory) {
  const auto c = twohistory::pairOf(pairLedger<double>({8, 8, 1, 1, 1, 8, 1}, 0.9), 0, 1);
  EXPECT_NEAR(twohistory::consistentWeight(c, 0.0), leastVarianceWeight(c), 1e-12);
  EXPECT_EQ(twohistory::consistentWeight(c, std::numeric_limits<double>::infinity()), 1);
  EXPECT_GT(twohistory::consistentWeight(c, 1.0), twohistory::consistentWeight(c, 0.1));
}

TEST(PairCovariance, BlendIsNeverNegative) {
  const PairCovariance<float> c{1e-7f, 1e-7f, 1.00001e-7f};
  for (float p = -1; p <= 2; p += 0.1f) EXPECT_GE(c.blend(p), 0);
  EXPECT_GE(c.difference(), 0);
}

}  // namespace
