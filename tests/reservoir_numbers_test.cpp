// No number breaks reservoirs, null samples count, and counts neither stall nor wrap.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "restir/mis.h"
#include "twohistory/history.h"

namespace {

using core::LightSample;
using restir::Mis;
using restir::Reservoir;
using restir::ReservoirBuilder;

core::Rng anyRng() { return {1, core::Pass::lab, 0, 0}; }

/// A target over a few lights.
struct Table {
  std::vector<float> values;
  float operator()(const LightSample& y) const { return values[y.light]; }
};

bool inOrder(const Reservoir& r) { return std::isfinite(r.unbiasedWeight) && r.unbiasedWeight >= 0; }

const float kInf = std::numeric_limits<float>::infinity(), kNaN = std::numeric_limits<float>::quiet_NaN();
const std::vector<float> kOdd{0.0f, 1e-45f, 1e-38f, 1e-30f, 1, 1e30f, 3e38f, kInf, -kInf, kNaN, -1};

/// What comes of a candidate with odd numbers followed by a good one.
template <class Builder>
Reservoir afterOdd(float target, float weight, float confidence) {
  core::Rng rng = anyRng();
  Builder builder;
  builder.add({0, {}}, target, weight, rng);
  builder.add({1, {}}, 1, 1, rng);
  return builder.finish(confidence, 0);
}

TEST(Reservoir, NoNumberBreaksIt) {
  for (float target : kOdd)
    for (float weight : kOdd)
      for (float confidence : {0.0f, 1.0f, 1e30f}) {
        const Reservoir r = afterOdd<ReservoirBuilder>(target, weight, confidence);
        EXPECT_TRUE(inOrder(r)) << target << " " << weight;
        EXPECT_EQ(r.confidence, confidence);
        // A stored weight or target that is out of order must not spread through a merge either.
        const Reservoir stored{{0, {}}, weight, confidence, 0}, good{{1, {}}, 1, 1, 0};
        for (Mis mis : {Mis::constant, Mis::contribution, Mis::balance, Mis::pairwise}) {
          const std::vector<restir::Source<Table>> sources{{good, {{target, 1}}}, {stored, {{target, 1}}}};
          core::Rng rng = anyRng();
          const Reservoir merged = restir::mergeReservoirs<Table>(sources, mis, 0, rng);
          EXPECT_TRUE(inOrder(merged)) << target << " " << weight;
          EXPECT_EQ(merged.confidence, 1 + confidence);
        }
      }
}

/// The stream as the papers write it: every number is taken as it comes.
struct Credulous {
  LightSample sample;
  float target = 1;
  double sum = 0;
  void add(const LightSample& y, float p, double w, core::Rng& rng) {
    sum += w;
    if (rng.uniform() * sum < w) sample = y, target = p;
  }
  Reservoir finish(float confidence, std::uint32_t frame) const {
    return {sample, static_cast<float>(sum / target), confidence, frame};
  }
};

TEST(Reservoir, OddNumbersSpreadThroughAStreamThatTakesThem) {
  EXPECT_TRUE(inOrder(afterOdd<Credulous>(1, 1, 1)));
  for (float odd : {kNaN, kInf, -kInf}) EXPECT_FALSE(inOrder(afterOdd<Credulous>(1, odd, 1))) << odd;
  EXPECT_FALSE(inOrder(afterOdd<Credulous>(1e-38f, 3e38f, 1)));
}

TEST(Reservoir, NullSamplesKeepTheirConfidence) {
  const Reservoir null{{}, 0, 5, 0}, good{{0, {}}, 2, 3, 0};
  core::Rng rng = anyRng();
  const std::vector<restir::Source<Table>> sources{{null, {{1}}}, {good, {{1}}}};
  const Reservoir merged = restir::mergeReservoirs<Table>(sources, Mis::balance, 7, rng);
  EXPECT_EQ(merged.confidence, 8);
  EXPECT_EQ(merged.frame, 7u);
  EXPECT_FLOAT_EQ(merged.unbiasedWeight, 2 * 3.0f / 8);  // it found nothing five times out of eight
}

TEST(Reservoir, CountsNeitherStallNorWrapOverTenThousandFramesOf4096) {
  // No forgetting: the weight grows, and a fresh count of 4096 still matters.
  twohistory::Ledger<1> ledger;
  const twohistory::Policies<1> keepAll{
      twohistory::Policy{twohistory::Weighting::samples, twohistory::Forgetting::none, 0}};
  Reservoir history{{}, 0, 0, 0};
  core::Rng rng = anyRng();
  for (int f = 0; f < 10'000; ++f) {
    const auto change = twohistory::advanceOf(ledger, keepAll, 4096.0f);
    history.confidence = change.factor[0] * ledger.weight[0];
    const Reservoir fresh{{std::uint32_t(f & 1), {}}, 1, change.fresh[0], 0};
    const std::vector<restir::Source<Table>> sources{{fresh, {{1, 1}}}, {history, {{1, 1}}}};
    history = restir::mergeReservoirs<Table>(sources, Mis::balance, f, rng);
    ledger = twohistory::advance(ledger, change, 4096.0f);
    ASSERT_NEAR(history.unbiasedWeight, 1, 1e-4) << f;
    ASSERT_EQ(history.confidence, ledger.weight[0]);
  }
  EXPECT_EQ(history.confidence, 10'000 * 4096.0f);
}

TEST(Reservoir, CountsOneByOneInFloatStallAndSixteenBitsWrap) {
  float oneByOne = 0;
  std::uint16_t sixteen = 0;
  for (int f = 0; f < 10'000; ++f) {
    for (int i = 0; i < 4096; ++i) oneByOne += 1;
    sixteen = static_cast<std::uint16_t>(sixteen + 4096);
  }
  EXPECT_EQ(oneByOne, 0x1p24f);  // 2.4 times too few
  EXPECT_EQ(sixteen, 0);
}

}  // namespace
