// Properties of the bookkeeping and of every closed-form blend over 100,000 random schedules each. The oracle is the
// same recursion in double, which ledger_test holds against sums over the whole sequence.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "tests/schedule.h"
#include "twohistory/lag.h"
#include "twohistory/mean.h"

namespace {

using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::PairCovariance;
using twohistory::Policies;
using twohistory::Policy;
using twohistory::Weighting;

constexpr std::uint32_t kSchedules = 100'000;

struct Schedule {
  std::vector<int> counts;
  Policies<3> policies;  ///< U, W of one decay, and a third of any weighting and decay
};

/// Up to 40 frames; hard decays are frequent; the last frame has samples.
Schedule randomSchedule(std::uint32_t index) {
  core::Rng rng(21, core::Pass::other, index, 0);
  Schedule s;
  s.counts = tests::randomCounts(rng, 1 + static_cast<int>(rng.below(40)), rng.uniform() < 0.2f ? 4096 : 64);
  s.counts.push_back(1 + static_cast<int>(rng.below(8)));
  const double decay = tests::randomDecay(rng);
  const Weighting third = rng.uniform() < 0.5f ? Weighting::frames : Weighting::samples;
  s.policies = {Policy{Weighting::frames, Forgetting::decay, decay},
                Policy{Weighting::samples, Forgetting::decay, decay},
                Policy{third, Forgetting::decay, tests::randomDecay(rng)}};
  return s;
}

template <class Real>
Ledger<3, Real> ledgerOf(const Schedule& s, int scale = 1) {
  Ledger<3, Real> l;
  for (const int n : s.counts) l = advance(l, s.policies, static_cast<Real>(n * scale));
  return l;
}

template <class L>
bool sameBits(const L& a, const L& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Window sums as random histories would leave them, for all closed forms that look at a window.
std::unique_ptr<twohistory::DriftRow> randomWindow(core::Rng& rng) {
  auto row = std::make_unique<twohistory::DriftRow>();
  const auto uniform = [&](float scale) { return scale * (rng.uniform() - 0.5f); };
  row->weight[0] = 20 + uniform(10), row->weightSquared[0] = 15 + uniform(5);
  row->sampleVariance[0] = row->weight[0] * rng.uniform();
  for (auto& sums : row->of) {
    sums.difference[0] = uniform(20), sums.noise[0] = 10 * rng.uniform();
    sums.squared[0] = sums.difference[0] * sums.difference[0] / row->weight[0] + 10 * rng.uniform();
    for (auto& q : sums.quadrant) q[0] = uniform(10);
  }
  for (auto& q : row->quadrantWeight) q[0] = 5;
  return row;
}

/// The same window at radiance times `scale`.
void scaleRadiance(twohistory::DriftRow& row, float scale) {
  row.sampleVariance[0] *= scale * scale;
  for (auto& sums : row.of) {
    sums.difference[0] *= scale, sums.squared[0] *= scale * scale, sums.noise[0] *= scale * scale;
    for (auto& q : sums.quadrant) q[0] *= scale;
  }
}

TEST(LeastVariance, IsInRangeWithoutRegretAndNoWorseThanEitherPart) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    const float p = leastVarianceWeight(twohistory::pairOf(ledgerOf<float>(s), 0, 1));
    ASSERT_TRUE(p >= 0 && p <= 1) << "schedule " << i;
    const PairCovariance<double> exact = twohistory::pairOf(ledgerOf<double>(s), 0, 1);
    const double got = exact.blend(p), best = exact.blend(leastVarianceWeight(exact));
    ASSERT_LE(got, best * (1 + 1e-5)) << "schedule " << i;
    ASSERT_LE(got, std::min(exact.first, exact.second) * (1 + 1e-5)) << "schedule " << i;
  }
}

/// Least variance of three histories over a fine grid of weights >= 0: never below the true least.
double leastOnAGrid(const twohistory::Matrix<3, double>& c) {
  constexpr int kSteps = 40;
  double least = 1e300;
  for (int a = 0; a <= kSteps; ++a)
    for (int b = 0; a + b <= kSteps; ++b) {
      const double x = static_cast<double>(a) / kSteps, y = static_cast<double>(b) / kSteps;
      least = std::min(least, twohistory::varianceOf<3, double>(c, {x, y, 1 - x - y}));
    }
  return least;
}

TEST(LeastVariance, OfThreeHistoriesIsConvexAndNoWorseThanAnyGridOrPart) {
  bool single = true;  // control: the best single history alone would fail
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    const auto weights = twohistory::leastVarianceWeights<3, float>(covarianceOf(ledgerOf<float>(s)));
    ASSERT_TRUE(weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0) << "schedule " << i;
    ASSERT_NEAR(weights[0] + weights[1] + weights[2], 1, 1e-6) << "schedule " << i;
    const auto exact = covarianceOf(ledgerOf<double>(s));
    const double got = twohistory::varianceOf<3, double>(exact, {weights[0], weights[1], weights[2]});
    const double part = std::min({exact[0][0], exact[1][1], exact[2][2]});
    ASSERT_LE(got, part * (1 + 1e-5)) << "schedule " << i;
    if (i % 20 != 0) continue;
    const double least = leastOnAGrid(exact);
    ASSERT_LE(got, least * (1 + 1e-5)) << "schedule " << i;
    single &= part <= least * (1 + 1e-5);
  }
  EXPECT_FALSE(single);
}

TEST(LeastVariance, ControlTheCancellingQuotientLeavesItsRange) {
  int failures = 0;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const Ledger<3> l = ledgerOf<float>(randomSchedule(i));
    const float u = l.covariance(0, 0), w = l.covariance(1, 1), c = l.covariance(0, 1);
    const float p = (w - c) / (u - 2 * c + w);
    failures += !(p >= 0 && p <= 1);
  }
  EXPECT_GT(failures, 10);
}

TEST(Bookkeeping, OfAnyPairIsThatOfDoubleArithmetic) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    const Ledger<3> l = ledgerOf<float>(s);
    const Ledger<3, double> exact = ledgerOf<double>(s);
    for (int g = 0; g < 3; ++g) {
      ASSERT_NEAR(l.age(g), exact.age(g), 1e-4 * (1 + exact.age(g))) << "schedule " << i;
      for (int h = g; h < 3; ++h)
        ASSERT_NEAR(l.covariance(g, h), exact.covariance(g, h), 2e-5 * exact.covariance(g, h)) << "schedule " << i;
    }
  }
}

TEST(Bookkeeping, CovariancesArePositiveSemidefinite) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Ledger<3> l = ledgerOf<float>(randomSchedule(i));
    core::Rng rng(22, core::Pass::other, i, 0);
    const core::vec3 x = rng.uniform3() - 0.5f;
    float form = 0, trace = 0;
    for (int g = 0; g < 3; ++g) {
      trace += l.covariance(g, g);
      for (int h = 0; h < 3; ++h) form += x[g] * x[h] * l.covariance(g, h);
    }
    ASSERT_GE(form, -2e-6f * trace) << "schedule " << i;
  }
}

// Four times as many samples everywhere: a factor whose square root is exact too, so not a bit may change.
TEST(Blends, DoNotChangeWhenAllCountsGrowFourfold) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    const Ledger<3> one = ledgerOf<float>(s), four = ledgerOf<float>(s, 4);
    const auto a = twohistory::pairOf(one, 0, 1), b = twohistory::pairOf(four, 0, 1);
    ASSERT_EQ(leastVarianceWeight(a), leastVarianceWeight(b));
    ASSERT_EQ((twohistory::leastVarianceWeights<3, float>(covarianceOf(one))),
              (twohistory::leastVarianceWeights<3, float>(covarianceOf(four))));
    ASSERT_EQ(consistentWeight(a, 0.25f), consistentWeight(b, 0.0625f));  // kappa and g are in units of s2
    ASSERT_EQ(lagWeight(a, one.age(0), one.age(1), 0.25f), lagWeight(b, four.age(0), four.age(1), 0.0625f));
    ASSERT_EQ(twohistory::lagWeights(one, 0.25f, -0.5f), twohistory::lagWeights(four, 0.0625f, -0.5f));
  }
}

TEST(Blends, DoNotChangeWithExposure) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Ledger<3> l = ledgerOf<float>(randomSchedule(i));
    core::Rng rng(23, core::Pass::other, i, 0);
    const auto row = randomWindow(rng);
    const twohistory::Against<3> against(2);
    const auto before = lagWeights(l, against, windowEvidence(l, against, *row, 0, true), 1, -0.5f);
    scaleRadiance(*row, i % 2 ? 0x1p-14f : 0x1p20f);
    ASSERT_EQ(before, lagWeights(l, against, windowEvidence(l, against, *row, 0, true), 1, -0.5f)) << "schedule " << i;
  }
}

TEST(Blends, OfThreeHistoriesSumToOneWithinTheirLimits) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Ledger<3> l = ledgerOf<float>(randomSchedule(i));
    core::Rng rng(24, core::Pass::other, i, 0);
    const auto row = randomWindow(rng);
    const twohistory::Against<3> against(2);
    const auto lambda = lagWeights(l, against, windowEvidence(l, against, *row, 0, true), 1, -0.5f);
    ASSERT_NEAR(lambda[0] + lambda[1] + lambda[2], 1, 1e-4f) << "schedule " << i;
    ASSERT_GE(std::min(lambda[0], lambda[1]), -0.5f - 1e-4f);
    ASSERT_GE(lambda[2], -1e-4f);
  }
}

/// What three histories of a schedule are from frame `first` on; `resetAt`: the frame that finds nothing where it was.
struct Remembered {
  Ledger<3> ledger;
  std::array<float, 3> value{};
};

Remembered remember(const Schedule& s, int first, int resetAt) {
  const twohistory::Mean<float> mean;
  core::Image<Ledger<3>> ledger(1, 1);
  std::array<core::Image<float>, 3> value;
  value.fill(core::Image<float>(1, 1, 0.0f));
  for (int f = first; f < static_cast<int>(s.counts.size()); ++f) {
    const twohistory::Taps taps = f == first || f == resetAt ? twohistory::Taps{} : twohistory::stillTap(0);
    const twohistory::Recall<3> recall(taps, core::In<Ledger<3>>(ledger), 1, s.policies,
                                       static_cast<float>(s.counts[f]));
    for (int j = 0; j < 3; ++j) {
      const twohistory::Step step = recall.step(j, {0, 0});
      value[j](0, 0) = mean.merge(mean.gather(core::In<float>(value[j]), step), 1.0f / static_cast<float>(f + 1), step);
    }
    ledger(0, 0) = recall.now;
  }
  return {ledger(0, 0), {value[0](0, 0), value[1](0, 0), value[2](0, 0)}};
}

bool sameBits(const Remembered& a, const Remembered& b) {
  return sameBits(a.ledger, b.ledger) && sameBits(a.value, b.value);
}

TEST(Bookkeeping, AResetIsAFreshStart) {
  int differs = 0;  // control: without the reset
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    const Schedule s = randomSchedule(i);
    core::Rng rng(27, core::Pass::other, i, 0);
    const int reset = static_cast<int>(rng.below(static_cast<std::uint32_t>(s.counts.size())));
    const Remembered fresh = remember(s, reset, reset);
    ASSERT_TRUE(sameBits(remember(s, 0, reset), fresh)) << "schedule " << i << ", frame " << reset;
    differs += !sameBits(remember(s, 0, 0), fresh);
  }
  EXPECT_GT(differs, static_cast<int>(kSchedules / 2));
}

/// Four neighbours of random pasts, and random weights of them.
struct Neighbours {
  core::Image<Ledger<3>> ledgers{2, 2};
  core::Image<float> values{2, 2};
  twohistory::Taps taps{{0, 1, 2, 3}, {}};

  Neighbours(std::uint32_t schedule, core::Rng& rng) {
    float sum = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
      ledgers.data()[k] = ledgerOf<float>(randomSchedule(schedule + k));
      values.data()[k] = rng.uniform();
      sum += taps.b[k] = rng.uniform();
    }
    for (float& b : taps.b) b /= sum;
  }
  /// Of history 1.
  float valueAt(const twohistory::Taps& t) const {
    twohistory::Step step;
    step.taps = twohistory::premultiplied<3>(t, ledgers.view(), 1);
    return twohistory::Mean<float>{}.gather(values.view(), step);
  }
};

std::array<int, 4> randomOrder(core::Rng& rng) {
  std::array<int, 4> order{0, 1, 2, 3};
  for (int k = 3; k > 0; --k) std::swap(order[k], order[rng.below(static_cast<std::uint32_t>(k) + 1)]);
  return order;
}

TEST(Bookkeeping, DoesNotDependOnTheOrderOfTaps) {
  const auto near = [](float a, float b) { return std::abs(a - b) <= 2e-6f * a; };
  int moved = 0;  // control: the same weights on other taps
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    core::Rng rng(25, core::Pass::other, i, 0);
    const Neighbours four(i, rng);
    const std::array<int, 4> order = randomOrder(rng);
    twohistory::Taps turned, other;
    for (int k = 0; k < 4; ++k) {
      turned.pixel[k] = order[k], turned.b[k] = four.taps.b[order[k]];
      other.pixel[k] = order[k], other.b[k] = four.taps.b[k];
    }
    const auto n = static_cast<float>(rng.below(9));
    const auto gathered = [&](const twohistory::Taps& t) {
      return gather<3, float>(t, four.ledgers, randomSchedule(i).policies, n);
    };
    const Ledger<3> a = gathered(four.taps), b = gathered(turned);
    for (int j = 0; j < 3; ++j) ASSERT_TRUE(near(a.weight[j], b.weight[j]) && near(a.ageSum[j], b.ageSum[j]));
    for (int j = 0; j < Ledger<3>::kPairs; ++j) ASSERT_TRUE(near(a.powerSums[j], b.powerSums[j]));
    ASSERT_TRUE(near(four.valueAt(four.taps), four.valueAt(turned))) << "schedule " << i;
    moved += !near(a.ageSum[2], gathered(other).ageSum[2]);
  }
  EXPECT_GT(moved, static_cast<int>(kSchedules / 2));
}

TEST(Bookkeeping, ConstantCountsMakeBothWeightingsOneHistory) {
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    core::Rng rng(26, core::Pass::other, i, 0);
    const int length = 1 + static_cast<int>(rng.below(60));
    const bool exact = i % 2 == 0;
    const auto n = static_cast<float>(exact ? 1u << rng.below(13) : 1 + rng.below(4096));
    const double decay = tests::randomDecay(rng);
    const Policies<2> both{Policy{Weighting::frames, Forgetting::decay, decay},
                           Policy{Weighting::samples, Forgetting::decay, decay}};
    Ledger<2> l;
    float u = 0, w = 0;
    for (int f = 0; f < length; ++f) {
      const auto step = advanceOf(l, both, n);
      const float x = rng.uniform();
      l = advance(l, step, n);
      u += step.fresh[0] / l.weight[0] * (x - u), w += step.fresh[1] / l.weight[1] * (x - w);
    }
    ASSERT_NEAR(u, w, exact ? 0 : 1e-5f) << "schedule " << i;
    ASSERT_NEAR(l.age(0), l.age(1), exact ? 0 : 1e-5f * (1 + l.age(0)));
    ASSERT_NEAR(l.covariance(0, 0), l.covariance(1, 1), exact ? 0 : 1e-5f * l.covariance(0, 0));
  }
}

TEST(Bookkeeping, ConstantCountsMakeBothWeightingsOneHistoryForAMillionFrames) {
  for (const int n : {1, 8, 64, 4096, 8192})
    for (const double decay : {0.999, 1.0}) {
      const Policies<2> both{Policy{Weighting::frames, Forgetting::decay, decay},
                             Policy{Weighting::samples, Forgetting::decay, decay}};
      Ledger<2> l;
      for (int f = 0; f < 5'000'000; ++f) l = advance(l, both, static_cast<float>(n));  // heavier than 2^22
      EXPECT_EQ(l.age(0), l.age(1)) << n << ", " << decay;
      EXPECT_EQ(l.covariance(0, 0), l.covariance(1, 1)) << n << ", " << decay;
      EXPECT_EQ(l.weight[1], l.weight[0] * static_cast<float>(n)) << n << ", " << decay;
    }
}

}  // namespace
