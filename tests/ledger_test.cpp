// The ledger is the sum that defines it: weights, ages and power sums against brute force over the whole sequence.
#include "twohistory/ledger.h"

#include <gtest/gtest.h>

#include "tests/schedule.h"
#include "twohistory/combination.h"

namespace {

using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::Weighting;

constexpr Weighting kFrames = Weighting::frames, kSamples = Weighting::samples;

Policy decaying(Weighting weighting, double decay) { return {weighting, Forgetting::decay, decay}; }

template <class Real>
Ledger<2, Real> run(const std::vector<int>& counts, const Policy& g, const Policy& h) {
  Ledger<2, Real> ledger;
  for (const int n : counts) ledger = advance(ledger, {g, h}, static_cast<Real>(n));
  return ledger;
}

/// Largest relative error of all sums of a pair of histories.
template <class Real>
double worstError(const std::vector<int>& counts, const Policy& g, const Policy& h) {
  const Ledger<2, Real> ledger = run<Real>(counts, g, h);
  double worst = 0;
  const auto check = [&](Real value, long double truth) {
    const long double error = truth > 1e-30L ? std::abs(value - truth) / truth : std::abs(value - truth) * 1e30L;
    worst = std::max(worst, static_cast<double>(error));
  };
  const tests::BruteForce gh(counts, g.amount, g.weighting, h.amount, h.weighting);
  const tests::BruteForce gg(counts, g.amount, g.weighting, g.amount, g.weighting);
  const tests::BruteForce hh(counts, h.amount, h.weighting, h.amount, h.weighting);
  check(ledger.weight[0], gh.weightG);
  check(ledger.weight[1], gh.weightH);
  check(ledger.ageSum[0], gg.ageSumG);
  check(ledger.ageSum[1], hh.ageSumG);
  check(ledger.powerSums[0], gg.cross);
  check(ledger.powerSums[1], gh.cross);
  check(ledger.powerSums[2], hh.cross);
  return worst;
}

Policy randomPolicy(core::Rng& rng) {
  return decaying(rng.uniform() < 0.5f ? kFrames : kSamples, tests::randomDecay(rng));
}

TEST(Ledger, MatchesTheDefinitionForAnyPairOfHistoriesInDouble) {
  for (std::uint32_t i = 0; i < 2000; ++i) {
    core::Rng rng(1, core::Pass::other, i, 0);
    const auto counts = tests::randomCounts(rng, 1 + static_cast<int>(rng.below(300)), 64);
    ASSERT_LE(worstError<double>(counts, randomPolicy(rng), randomPolicy(rng)), 1e-11) << "schedule " << i;
  }
}

TEST(Ledger, MatchesTheDefinitionInFloatWhileDecaysAreRepresentable) {
  // A float decay is off by up to 3e-8 and an entry of age a carries a times that, so decays are multiples of 2^-8
  // here.
  for (std::uint32_t i = 0; i < 2000; ++i) {
    core::Rng rng(2, core::Pass::other, i, 0);
    const auto counts = tests::randomCounts(rng, 1 + static_cast<int>(rng.below(300)), 64);
    const auto policy = [&] {
      return decaying(rng.uniform() < 0.5f ? kFrames : kSamples, std::floor(tests::randomDecay(rng) * 256) / 256);
    };
    ASSERT_LE(worstError<float>(counts, policy(), policy()), 1e-5) << "schedule " << i;
  }
}

/// A history by what it holds: the weight that each frame still has in it, forgotten one by one.
struct Holdings {
  std::vector<long double> weight;  ///< of frame i; all 0 before a reset
  void step(const Policy& p, int n) {
    const long double fresh = n == 0 ? 0 : p.weighting == kSamples ? n : 1;
    long double total = 0, kept = p.forgetting == Forgetting::decay ? p.amount : 1;
    for (const long double w : weight) total += w;
    const long double cap = p.amount * (p.forgetting == Forgetting::relativeCap ? fresh : 1);
    const bool capped = p.forgetting == Forgetting::relativeCap || p.forgetting == Forgetting::absoluteCap;
    if (capped && fresh > 0 && total > cap) kept = cap / total;
    for (long double& w : weight) w *= kept;
    weight.push_back(fresh);
  }
};

Policy anyPolicy(core::Rng& rng) {
  const auto forgetting = static_cast<Forgetting>(rng.below(4));
  const double amount = forgetting == Forgetting::decay ? tests::randomDecay(rng) : std::floor(rng.uniform() * 200) / 2;
  return {rng.uniform() < 0.5f ? kFrames : kSamples, forgetting, amount};
}

// Caps at changing counts, resets in any frame, and pairs that forget in different ways: the power sums decay by what
// was forgotten in each frame, or they would not be these.
TEST(Ledger, HoldsWhatEveryWayOfForgettingLeavesThroughResets) {
  double worst = 0, naive = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    core::Rng rng(4, core::Pass::other, i, 0);
    const auto counts = tests::randomCounts(rng, 1 + static_cast<int>(rng.below(100)), 64);
    const twohistory::Policies<2> p{anyPolicy(rng), anyPolicy(rng)};
    Ledger<2, double> ledger;
    std::array<Holdings, 2> holds;
    for (std::size_t f = 0; f < counts.size(); ++f) {
      if (rng.below(40) == 0) {
        ledger = {};
        for (Holdings& h : holds) h.weight.assign(f, 0);
      }
      ledger = advance(ledger, p, static_cast<double>(counts[f]));
      for (int j = 0; j < 2; ++j) holds[j].step(p[j], counts[f]);
    }
    long double total = 0, age = 0, cross = 0, square = 0;
    for (std::size_t f = 0; f < counts.size(); ++f) {
      const long double w = holds[0].weight[f];
      total += w, age += w * static_cast<long double>(counts.size() - 1 - f);
      if (counts[f] > 0) cross += w * holds[1].weight[f] / counts[f], square += w * w / counts[f];
    }
    const auto error = [](double value, long double truth) {
      return static_cast<double>(std::abs(value - truth) / std::max(truth, 1e-30L));
    };
    worst = std::max({worst, error(ledger.weight[0], total), error(ledger.ageSum[0], age),
                      error(ledger.powerSums[0], square), error(ledger.powerSums[1], cross)});
    naive = std::max(naive, error(ledger.weight[0] * ledger.weight[0] / 64, square));
  }
  EXPECT_LE(worst, 1e-11);
  EXPECT_GT(naive, 0.1);  // control: variance from the weight alone
}

TEST(Ledger, ControlConstantDecayOfPowerSumsIsCaught) {
  // The shipped method decayed its power sums by 0.64 a frame whatever the history's own decay.
  core::Rng rng(3, core::Pass::other, 0, 0);
  const auto counts = tests::randomCounts(rng, 60, 64);
  double shipped = 0;
  for (const int n : counts) shipped = 0.64 * shipped + (n > 0 ? 1 : 0);
  const tests::BruteForce truth(counts, 0.95, kFrames, 0.95, kSamples);
  EXPECT_GT(std::abs(shipped / static_cast<double>(truth.cross) - 1), 0.5);
}

TEST(Ledger, FramesWithoutSamplesDecayAndAgeButAddNothing) {
  Ledger<1, double> ledger;
  ledger = advance(ledger, {decaying(kSamples, 0.5)}, 4.0);
  ledger = advance(ledger, {decaying(kSamples, 0.5)}, 0.0);
  EXPECT_DOUBLE_EQ(ledger.weight[0], 2);
  EXPECT_DOUBLE_EQ(ledger.age(0), 1);
  EXPECT_DOUBLE_EQ(ledger.powerSums[0], 1);
  EXPECT_DOUBLE_EQ(ledger.covariance(0, 0), 0.25);  // still four samples' worth
}

TEST(Ledger, CapsDoNotActOnFramesWithoutSamples) {
  for (const Forgetting forgetting : {Forgetting::relativeCap, Forgetting::absoluteCap}) {
    Ledger<1, double> ledger;
    const Policy policy{kSamples, forgetting, 3};
    for (int i = 0; i < 20; ++i) ledger = advance(ledger, {policy}, 2.0);
    const Ledger<1, double> before = ledger;
    for (int i = 0; i < 5; ++i) ledger = advance(ledger, {policy}, 0.0);
    EXPECT_DOUBLE_EQ(ledger.weight[0], before.weight[0]);
    EXPECT_DOUBLE_EQ(ledger.covariance(0, 0), before.covariance(0, 0));
  }
}

TEST(Ledger, BindingRelativeCapForgetsLikeDecayAtConstantCounts) {
  // Q = 19 is decay 0.95: the fresh value's share is 1 / (1 + Q) = 0.05.
  Ledger<2, double> ledger;
  const Policy cap{kSamples, Forgetting::relativeCap, 19}, decay = decaying(kSamples, 0.95);
  for (int i = 0; i < 2000; ++i) ledger = advance(ledger, {cap, decay}, 3.0);
  EXPECT_NEAR(ledger.weight[0], ledger.weight[1], 1e-9 * ledger.weight[1]);
  EXPECT_NEAR(ledger.covariance(0, 0), ledger.covariance(1, 1), 1e-9 * ledger.covariance(1, 1));
}

TEST(Ledger, ConstantCountsMakeBothWeightingsOneHistory) {
  for (const int n : {1, 2, 8, 64, 4096}) {  // powers of two: the same bits
    const auto ledger = run<float>(std::vector<int>(500, n), decaying(kFrames, 0.95), decaying(kSamples, 0.95));
    EXPECT_EQ(ledger.weight[1], static_cast<float>(n) * ledger.weight[0]);
    EXPECT_EQ(ledger.covariance(0, 0), ledger.covariance(1, 1));
    EXPECT_EQ(ledger.covariance(0, 0), ledger.covariance(0, 1));
    EXPECT_EQ(ledger.age(0), ledger.age(1));
    EXPECT_EQ(leastVarianceWeight(pairOf(ledger, 0, 1)), 1);
  }
  for (const int n : {3, 7, 100}) {
    const auto ledger = run<float>(std::vector<int>(500, n), decaying(kFrames, 0.95), decaying(kSamples, 0.95));
    EXPECT_NEAR(ledger.covariance(0, 0) / ledger.covariance(1, 1), 1, 1e-5);
  }
}

TEST(Ledger, TapsMixSumsAndOrderDoesNotMatter) {
  core::Image<Ledger<1>> before(2, 2);
  for (int i = 0; i < 4; ++i) {
    Ledger<1> l;
    for (int k = 0; k <= i * 40; ++k)
      l = advance(l, {decaying(kSamples, 0.95)}, 1.0f + static_cast<float>(7 * (i % 2)));
    before(i % 2, i / 2) = l;
  }
  const twohistory::Taps taps{{0, 1, 2, 3}, {0.1f, 0.2f, 0.3f, 0.4f}}, reversed{{3, 2, 1, 0}, {0.4f, 0.3f, 0.2f, 0.1f}};
  const twohistory::Policies<1> policy{decaying(kSamples, 0.95)};
  const auto a = gather<1, float>(taps, before, policy, 1.0f), b = gather<1, float>(reversed, before, policy, 1.0f);
  float expected = 0;
  for (int i = 0; i < 4; ++i) expected += taps.b[i] * before(i % 2, i / 2).weight[0];
  EXPECT_FLOAT_EQ(a.weight[0], expected);
  EXPECT_FLOAT_EQ(a.weight[0], b.weight[0]);
  EXPECT_FLOAT_EQ(a.powerSums[0], b.powerSums[0]);
  float kept = 0;
  for (int i = 0; i < 4; ++i) kept += taps.b[i] * before(i % 2, i / 2).powerSums[0];
  EXPECT_LT(a.powerSums[0], kept);  // mixing pixels averages their noise
  const auto one = gather<1, float>(twohistory::stillTap(2), before, policy, 1.0f);
  EXPECT_EQ(one.powerSums[0], before(0, 1).powerSums[0]);  // a camera at rest changes no bit
}

TEST(Ledger, WhatIsNotCarriedAlongIsForgottenAsByDecay) {
  const twohistory::Policies<2> policies{
      {{Weighting::frames, Forgetting::decay, 0.9}, {Weighting::samples, Forgetting::none, 0}}};
  const twohistory::Policies<2> less{
      {{Weighting::frames, Forgetting::decay, 0.9 * 0.75}, {Weighting::samples, Forgetting::decay, 0.75}}};
  core::Image<Ledger<2, double>> before(1, 1);
  for (const double n : {1.0, 4.0, 2.0}) before(0, 0) = advance(before(0, 0), policies, n);
  twohistory::Taps taps = twohistory::stillTap(0);
  taps.carried = 0.75f;
  const auto gathered = twohistory::gather<2, double>(taps, before, policies, 3.0);
  const auto now = advance(gathered, advanceOf<2, double>(gathered, policies, 3.0, taps.carried), 3.0);
  const auto expected = advance(before(0, 0), less, 3.0);
  for (int j = 0; j < 2; ++j) {
    EXPECT_DOUBLE_EQ(now.weight[j], expected.weight[j]);
    EXPECT_DOUBLE_EQ(now.ageSum[j], expected.ageSum[j]);
  }
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(now.powerSums[i], expected.powerSums[i]);
}

TEST(Ledger, ResetIsAFreshStart) {
  core::Image<Ledger<2>> before(1, 1);
  before(0, 0) = run<float>({8, 1, 1, 0, 3}, decaying(kFrames, 0.95), decaying(kSamples, 0.8));
  const twohistory::Policies<2> policies{decaying(kFrames, 0.95), decaying(kSamples, 0.8)};
  const auto gathered = twohistory::gather<2, float>(twohistory::Taps{}, before, policies, 5.0f);
  const auto after = advance(gathered, policies, 5.0f);
  const auto fresh = run<float>({5}, decaying(kFrames, 0.95), decaying(kSamples, 0.8));
  EXPECT_EQ(after.weight, fresh.weight);
  EXPECT_EQ(after.powerSums, fresh.powerSums);
  EXPECT_EQ(after.ageSum, fresh.ageSum);
}

}  // namespace
