// Predicted weights, power sums, ages, p and variances against sums over the whole sequence in long double.
#include "experiments/predict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace experiments {
namespace {

using twohistory::Weighting;
using Long = long double;

/// Every quantity by its definition: sum over all frames i of decay^(t - i) ...
struct BruteForce {
  Long weight[2] = {0, 0}, age[2] = {0, 0}, sum[3] = {0, 0, 0};

  BruteForce(const std::vector<double>& counts, Long decay) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const Long n = counts[i], frames = static_cast<Long>(counts.size() - 1 - i);
      if (n == 0) continue;
      const Long left = std::pow(decay, frames), twice = std::pow(decay, 2 * frames);
      weight[0] += left, weight[1] += left * n;
      age[0] += left * frames, age[1] += left * n * frames;
      sum[0] += twice / n, sum[1] += twice, sum[2] += twice * n;
    }
  }
  Long variance(int j) const { return sum[2 * j] / (weight[j] * weight[j]); }
  Long covariance() const { return sum[1] / (weight[0] * weight[1]); }
  Long blend(Long p) const {
    return (1 - p) * (1 - p) * variance(1) + 2 * p * (1 - p) * covariance() + p * p * variance(0);
  }
  /// Least variance over p in [0, 1], by golden section: independent of any closed form.
  Long leastVariance() const {
    Long low = 0, high = 1;
    const Long ratio = (std::sqrt(Long(5)) - 1) / 2;
    for (int i = 0; i < 200; ++i) {
      const Long a = high - ratio * (high - low), b = low + ratio * (high - low);
      (blend(a) < blend(b) ? high : low) = blend(a) < blend(b) ? b : a;
    }
    return std::min({blend((low + high) / 2), blend(0), blend(1)});
  }
};

struct Schedule {
  double decay;
  std::vector<double> counts;
};

/// n in 0..64, often 0, often constant for a while; decay 0, 1, 0.999 or uniform.
Schedule randomSchedule(std::uint32_t index) {
  core::Rng rng(11, core::Pass::lab, index, 0);
  constexpr double kSpecial[] = {0, 1, 0.999, 0.95, 0.5};
  Schedule schedule{index % 10 < 5 ? kSpecial[index % 5] : double{rng.uniform()}, {}};
  const std::uint32_t length = 1 + rng.below(200);
  double n = rng.below(65);
  while (schedule.counts.size() < length) {
    const float choice = rng.uniform();
    if (choice < 0.5f) n = rng.below(65);
    schedule.counts.push_back(choice > 0.7f ? 0 : n);
  }
  return schedule;
}

Prediction follow(const Schedule& s) {
  Prediction prediction(s.decay);
  for (const double n : s.counts) prediction.advance(n);
  return prediction;
}

void expectNear(double value, Long expected, const char* what, std::uint32_t index) {
  EXPECT_NEAR(value, static_cast<double>(expected), 1e-5 * std::abs(static_cast<double>(expected)) + 1e-290)
      << what << ", schedule " << index;
}

constexpr std::uint32_t kSchedules = 1000;

TEST(Predict, WeightsAndPowerSumsAgreeWithSumsOverTheWholeSequence) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    const Prediction p = follow(s);
    const BruteForce truth(s.counts, s.decay);
    expectNear(p.weight(Weighting::frames), truth.weight[0], "W_u", i);
    expectNear(p.weight(Weighting::samples), truth.weight[1], "W_w", i);
    for (int k = -1; k <= 1; ++k) expectNear(p.powerSum(k), truth.sum[k + 1], "S", i);
  }
}

TEST(Predict, AgesAndVariancesAgreeAndBlendHasNoRegret) {
  int compared = 0;
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    const Prediction p = follow(s);
    const BruteForce truth(s.counts, s.decay);
    if (truth.weight[0] < 1e-150L) continue;  // squares would not be normal numbers in double precision
    ++compared;
    expectNear(p.age(Weighting::frames), truth.age[0] / truth.weight[0], "age u", i);
    expectNear(p.age(Weighting::samples), truth.age[1] / truth.weight[1], "age w", i);
    expectNear(p.variance(Weighting::frames), truth.variance(0), "V_u", i);
    expectNear(p.variance(Weighting::samples), truth.variance(1), "V_w", i);
    expectNear(p.blendVariance(), truth.blend(p.blendWeight()), "V", i);
    EXPECT_GE(p.blendWeight(), 0);
    EXPECT_LE(p.blendWeight(), 1);
    EXPECT_LE(truth.blend(p.blendWeight()), truth.leastVariance() * (1 + 1e-5L)) << i;
  }
  EXPECT_GT(compared, 900);
}

// Negative controls: a decay of the sums that is not the square is caught, and so is a p that is off.
TEST(Predict, TheComparisonCatchesAWrongDecayOfTheSumsAndAWrongWeight) {
  int wrongSums = 0, regret = 0;
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    const BruteForce truth(s.counts, s.decay), wrong(s.counts, std::sqrt(Long(s.decay)));
    wrongSums += std::abs(wrong.sum[1] - truth.sum[1]) > 1e-5L * truth.sum[1];
    if (truth.weight[0] < 1e-150L) continue;
    const Long p = std::min(Long(1), follow(s).blendWeight() + Long(0.05));
    regret += truth.blend(p) > truth.leastVariance() * (1 + 1e-5L);
  }
  EXPECT_GT(wrongSums, 500);
  EXPECT_GT(regret, 300);
}

TEST(Predict, NothingIsKnownBeforeTheFirstSample) {
  Prediction p(0.95);
  p.advance(0);
  p.advance(0);
  const Json json = predictionJson(p, 0);
  EXPECT_EQ(json["weight"]["frames"], 0.0);
  EXPECT_EQ(json["power_sums"]["-1"], 0.0);
  EXPECT_TRUE(json["p"].is_null());
  EXPECT_TRUE(json["age"]["samples"].is_null());
  EXPECT_TRUE(json["variance"]["blend"].is_null());
  p.advance(4);
  EXPECT_EQ(p.weight(Weighting::samples), 4);
  EXPECT_EQ(p.age(Weighting::frames), 0);
  EXPECT_EQ(p.variance(Weighting::frames), 0.25);
}

TEST(Predict, TheFormIsTheAgreedOne) {
  Prediction p(0.5);
  p.advance(1);
  p.advance(8);
  EXPECT_EQ(predictionJson(p, 8).dump().substr(0, 60),
            R"({"n":8,"weight":{"frames":1.5,"samples":8.5},"power_sums":{")");
  EXPECT_EQ(p.powerSum(-1), 0.375);
  EXPECT_EQ(p.powerSum(0), 1.25);
  EXPECT_EQ(p.powerSum(1), 8.25);
}

TEST(Predict, LongSilencesNeverGiveNumbersThatAreNotFinite) {
  Prediction p(0.5);
  p.advance(8);
  for (int i = 0; i < 3000; ++i) {
    p.advance(0);
    const Json json = predictionJson(p, 0);
    ASSERT_TRUE(json["p"].is_null() || (json["p"] >= 0.0 && json["p"] <= 1.0)) << i;
    ASSERT_TRUE(json["variance"]["blend"].is_null() || json["variance"]["blend"] > 0.0) << i;
  }
  EXPECT_EQ(p.weight(Weighting::frames), 0);
}

TEST(Predict, CountsAreReadStrictly) {
  EXPECT_EQ(parseCounts("1, 1,8\n0\t1\r\n", "x"), (std::vector<double>{1, 1, 8, 0, 1}));
  EXPECT_EQ(parseCounts("2.5", "x"), std::vector<double>{2.5});
  for (const char* wrong :
       {"", " , \n", "-1", "nan", "inf", "1e400", "1x", "1;2", "0x", "1,,2", "1,", ",1", "1e-30", "1e12", "--"})
    EXPECT_THROW(parseCounts(wrong, "x"), core::UsageError) << wrong;
}

TEST(Predict, DecayIsCheckedStrictly) {
  for (const char* wrong : {"-0.1", "1.1", "nan", "inf", "", "0.5x", "0x1p-1", "half"})
    EXPECT_THROW(experiments::parseDecay(wrong, "x"), core::UsageError) << wrong;
}

}  // namespace
}  // namespace experiments
