// The alias table draws what probability() says, and probability() is what the weights ask for.
#include "core/alias_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/random.h"
#include "tests/chi_square.h"

namespace {

constexpr double kSignificance = 1e-6;

std::vector<float> decades(int count) {
  std::vector<float> weights(count);
  for (int i = 0; i < count; ++i) weights[i] = static_cast<float>(std::pow(10.0, -6.0 * i / count));
  return weights;
}

double chiSquareOf(const core::AliasTable& drawn, const core::AliasTable& claimed, int draws) {
  core::Rng rng(7, core::Pass::lab, 0, 0);
  std::vector<double> counts(drawn.size()), expected(drawn.size());
  for (int i = 0; i < draws; ++i) {
    const std::uint32_t bin = rng.bits(), keep = rng.bits();
    ++counts[drawn.sample(bin, keep)];
  }
  for (std::uint32_t i = 0; i < expected.size(); ++i) expected[i] = draws * double(claimed.probability(i));
  return tests::chiSquareP(counts, expected);
}

TEST(AliasTable, DrawsInProportionToWeights) {
  for (const auto& weights : {std::vector<float>{1, 1, 1}, std::vector<float>{0, 3, 0, 1}, decades(100)})
    EXPECT_GT(chiSquareOf(core::AliasTable(weights), core::AliasTable(weights), 1'000'000), kSignificance);
}

TEST(AliasTable, ChiSquareCatchesWeightsWrongByFivePercent) {
  std::vector<float> wrong = decades(100);
  wrong[3] *= 1.05f;
  EXPECT_LT(chiSquareOf(core::AliasTable(wrong), core::AliasTable(decades(100)), 5'000'000), kSignificance);
}

TEST(AliasTable, ProbabilityIsWeightOverSum) {
  const auto weights = decades(1000);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  const core::AliasTable table(weights);
  double total = 0;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(table.probability(i), weights[i] / sum, 1e-6 * weights[i] / sum + 1e-9);
    total += table.probability(i);
  }
  EXPECT_NEAR(total, 1, 1e-6);
}

TEST(AliasTable, ProbabilityIsWhatIsDrawnWhereRoundingMatters) {
  // A weight far below 2^-32 of the mean is rounded up to 2^-32 of a bin, and probability() says so.
  const std::vector<float> weights{1e-30f, 1, 1, 1};
  const core::AliasTable table(weights);
  EXPECT_EQ(table.probability(0), static_cast<float>(0x1p-32 / 4));
  EXPECT_EQ(table.sample(0, 0), 0u);
  EXPECT_NE(table.sample(0, 1), 0u);
}

TEST(AliasTable, NeverDrawsZeroWeight) {
  std::vector<float> weights(64, 0.0f);
  weights[5] = 1e-30f, weights[40] = 1e30f;
  const core::AliasTable table(weights);
  for (std::uint32_t bin = 0; bin < 64; ++bin)
    for (std::uint32_t keep : {0u, 1u, 0x7fffffffu, 0xffffffffu}) {
      const std::uint32_t i = table.sample(bin << 26, keep);
      EXPECT_TRUE(i == 5 || i == 40);
      EXPECT_GT(table.probability(i), 0);
    }
  EXPECT_EQ(table.probability(0), 0);
}

TEST(AliasTable, NoWeightAtAllIsEmpty) {
  EXPECT_TRUE(core::AliasTable().empty());
  EXPECT_TRUE(core::AliasTable(std::vector<float>{}).empty());
  EXPECT_TRUE(core::AliasTable(std::vector<float>{0, 0}).empty());
}

}  // namespace
