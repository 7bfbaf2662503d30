// Hard cases of history arithmetic: each shows the naive form failing and ours holding. Rows whose tests are elsewhere:
//
//   constant n                         combination_test (ControlCancellingDenominatorFails), history_properties_test
//   decay of the power sums            ledger_test (ControlConstantDecayOfPowerSumsIsCaught)
//   decay 1, long runs                 LongRuns, below, and history_properties_test (...ForAMillionFrames)
//   E[x^2] - m^2                       filter_test (InnovationsSurviveWhereSquaresCancel)
//   variance floor                     VarianceFloor, below, and filter_test (IsInvariantToRadianceScale)
//   not finite input                   filter_test (TreatsNotFiniteRadianceAsAFrameWithoutSamples), and below
//   firefly                            Fireflies, below; the clamp is off by default, and costs energy where it is on
//   half storage, memory               packed_ledger_test
//   reset                              Reset, below, and history_properties_test (AResetIsAFreshStart)
#include <gtest/gtest.h>

#include <cmath>

#include "svgf/moments.h"
#include "tests/schedule.h"
#include "tests/synthetic.h"
#include "twohistory/combination.h"
#include "twohistory/gradient.h"
#include "twohistory/mean.h"

namespace {

using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::Step;
using twohistory::Weighting;

const Policy kU{Weighting::frames, Forgetting::decay, 0.95}, kW{Weighting::samples, Forgetting::decay, 0.95};

/// The nearest number with the 11 significant bits of half precision; infinite above its range.
float roundToHalf(float x) {
  int exponent = 0;
  const float fraction = std::frexp(x, &exponent);
  const float rounded = std::ldexp(std::nearbyint(std::ldexp(fraction, 11)), exponent - 11);
  return std::abs(rounded) > 65504 ? std::copysign(std::numeric_limits<float>::infinity(), x) : rounded;
}

TEST(NoSamples, NaiveFormsDivideByZeroAndOursSkips) {
  const float naive = 0.9025f * 10 + 1 / std::floor(0.5f);  // S_-1 <- b^2 S_-1 + 1 / n
  EXPECT_FALSE(std::isfinite(naive));
  Ledger<2> l;
  for (int i = 0; i < 50; ++i) l = advance(l, {kU, kW}, 2.0f);
  const Ledger<2> waited = advance(l, {kU, kW}, 0.0f);
  EXPECT_EQ(waited.weight[0], 0.95f * l.weight[0]);
  EXPECT_NEAR(waited.covariance(0, 0), l.covariance(0, 0), 1e-6f * l.covariance(0, 0));
  EXPECT_NEAR(waited.age(0), l.age(0) + 1, 1e-4f);
}

TEST(ManySamples, OverflowHalfAndStayFiniteHere) {
  Ledger<2> l;
  for (int i = 0; i < 200; ++i) l = advance(l, {kU, kW}, 4096.0f);
  EXPECT_FALSE(std::isfinite(roundToHalf(l.weight[1])));  // 81920 > 65504
  EXPECT_TRUE(std::isfinite(l.weight[1]));
  EXPECT_NEAR(roundToHalf(l.weight[1] / l.weight[0]), 4096, 1);  // the ratio fits
}

TEST(LongRuns, NaiveHalfAveragesStallAndFloatOnesArrive) {
  float half = 0, full = 0;
  for (int i = 0; i < 10'000; ++i) {
    half = roundToHalf(half + roundToHalf(0.05f * (1 - half)));
    full += 0.05f * (1 - full);
  }
  EXPECT_GT(std::abs(half - 1), 2e-3f);  // stops where 0.05 (1 - x) is below half a unit in the last place
  EXPECT_NEAR(full, 1, 1e-5f);
}

/// One history in double by its definition, with the limit that a float history needs.
struct InDouble {
  double weight = 0, ageSum = 0, powerSum = 0;
  void step(const Policy& p, double n) {
    const double fresh = n > 0 ? (p.weighting == Weighting::samples ? n : 1) : 0;
    double kept = p.forgetting == Forgetting::decay ? p.amount : 1;
    if (fresh > 0 && weight > 0) {
      if (p.forgetting == Forgetting::relativeCap) kept = std::min(kept, p.amount * fresh / weight);
      if (p.forgetting == Forgetting::absoluteCap) kept = std::min(kept, p.amount / weight);
      kept = std::min(kept, 0x1p22 * fresh / weight);
    }
    ageSum = kept * (ageSum + weight), weight = kept * weight + fresh;
    powerSum = kept * kept * powerSum + (n > 0 ? fresh * fresh / n : 0);
  }
};

TEST(LongRuns, AMillionFramesOfEveryPolicyAgreeWithDouble) {
  for (const Policy& p :
       {kU, kW, Policy{Weighting::frames, Forgetting::decay, 0.5}, Policy{Weighting::samples, Forgetting::decay, 0.999},
        Policy{Weighting::frames, Forgetting::decay, 1}, Policy{Weighting::samples, Forgetting::decay, 1},
        Policy{Weighting::samples, Forgetting::relativeCap, 20}, Policy{Weighting::frames, Forgetting::absoluteCap, 64},
        Policy{Weighting::samples, Forgetting::decay, 0}, Policy{Weighting::frames, Forgetting::none, 0}}) {
    Ledger<1> l;
    InDouble exact;
    core::Rng rng(31, core::Pass::other, 0, 0);
    const std::array<int, 8> counts{1, 8, 0, 2, 64, 1, 1, 4096};
    for (int i = 0; i < 1'000'000; ++i) {
      const int n = counts[rng.below(counts.size())];
      l = advance(l, {p}, static_cast<float>(n));
      exact.step(p, n);
      if (i % 1000 != 999 || !(exact.weight > 0)) continue;
      ASSERT_NEAR(l.weight[0], exact.weight, 1e-3 * exact.weight) << i;
      ASSERT_NEAR(l.age(0), exact.ageSum / exact.weight, 1e-3 * (1 + exact.ageSum / exact.weight)) << i;
      const double covariance = exact.powerSum / (exact.weight * exact.weight);
      ASSERT_NEAR(l.covariance(0, 0), covariance, 2e-3 * covariance) << i;
    }
  }
}

TEST(NoSamples, MergedAtWeightOneAreBlackAndOursStay) {
  const twohistory::Mean<float> mean;
  Ledger<1> l, wrong;
  float ours = 0, naive = 0;
  for (int i = 0; i < 200; ++i) {
    const float n = i % 2 == 0 ? 1.0f : 0.0f, x = n > 0 ? 1.0f : 0.0f;  // no sample: black
    const auto change = advanceOf(l, {kU}, n), all = advanceOf(wrong, {kU}, 1.0f);
    Step step;
    step.kept = change.factor[0] * l.weight[0], step.fresh = change.fresh[0];
    ours = mean.merge(ours, x, step);
    step.kept = all.factor[0] * wrong.weight[0], step.fresh = all.fresh[0];
    naive = mean.merge(naive, x, step);
    l = advance(l, change, n), wrong = advance(wrong, all, 1.0f);
  }
  EXPECT_NEAR(ours, 1, 1e-6f);
  EXPECT_LT(naive, 0.6f);
}

/// What is left of a history without forgetting after 2^24 + 2^20 frames of one sample: its weight, and how far a step
/// of the signal from 0 to 1 in the last 2^20 of them got. cap: whether the weight is one that the ledger allows.
std::pair<float, float> afterAStep(bool cap) {
  const Policy forever{Weighting::frames, Forgetting::none, 0};
  Ledger<1> l;
  float naiveWeight = 0, mean = 0;
  for (int i = 0; i < (1 << 24) + (1 << 20); ++i) {
    l = advance(l, {forever}, 1.0f), naiveWeight += 1;
    const float x = i < (1 << 24) ? 0.0f : 1.0f;
    mean += 1 / (cap ? l.weight[0] : naiveWeight) * (x - mean);
  }
  return {cap ? l.weight[0] : naiveWeight, mean};
}

TEST(LongRuns, WithoutForgettingNaiveSumsStallAndOursStayWhereFramesCount) {
  const auto naive = afterAStep(false), ours = afterAStep(true);
  EXPECT_EQ(naive.first, 0x1p24f);  // one more frame is no longer counted: nobody chose this memory
  EXPECT_EQ(ours.first, 0x1p22f + 1);
  EXPECT_NEAR(ours.second, 1 - std::exp(-0.25), 1e-3);  // an average over 2^22 frames, as the ledger says
}

TEST(UnequalTaps, NaiveMixingOfMeansClaimsTwentyTimesTooLittleVariance) {
  // A tap with one sample and one with 160 frames' worth, half and half.
  core::Image<Ledger<1>> before(2, 1);
  before(0, 0) = advance(Ledger<1>{}, {kW}, 1.0f);
  const Policy forever{Weighting::samples, Forgetting::none, 0};
  for (int i = 0; i < 20; ++i) before(1, 0) = advance(before(1, 0), {forever}, 8.0f);
  const twohistory::Taps taps{{0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
  const Ledger<1> mixed = gather<1, float>(taps, before, {kW}, 1.0f);
  const float naiveTrue = 0.25f * before(0, 0).covariance(0, 0) + 0.25f * before(1, 0).covariance(0, 0);
  EXPECT_NEAR(naiveTrue, 0.25f, 0.01f);              // of the mean of means
  EXPECT_NEAR(1 / mixed.weight[0], 0.0124f, 1e-3f);  // what the interpolated weight would claim: 20 times less
  const twohistory::Taps b = twohistory::premultiplied<1>(taps, before.view(), 0);
  const float ours = b.b[0] * b.b[0] * before(0, 0).covariance(0, 0) + b.b[1] * b.b[1] * before(1, 0).covariance(0, 0);
  EXPECT_LT(ours, 0.0065f);                 // of the premultiplied mix
  EXPECT_GE(mixed.covariance(0, 0), ours);  // what we claim is no less
  EXPECT_LT(mixed.covariance(0, 0), 2 * ours);
}

TEST(Infinities, NaiveTestForNaNAloneKeepsThemForEver) {
  float naive = 1, ours = 1;
  const twohistory::Mean<float> mean;
  for (int i = 0; i < 100; ++i) {
    const float x = i == 10 ? std::numeric_limits<float>::infinity() : 1;
    if (!std::isnan(x)) naive += 0.05f * (x - naive);
    Step step;
    step.kept = 19, step.fresh = std::isfinite(x) ? 1.0f : 0.0f;  // as dropBadSamples decides
    ours = mean.merge(ours, x, step);
  }
  EXPECT_FALSE(std::isfinite(naive));
  EXPECT_EQ(ours, 1);
}

TEST(NegativeVariance, NaiveDifferenceOfSquaresGoesBelowZeroAndInnovationsDoNot) {
  float first = 0, second = 0, lowest = 1;
  svgf::Moments m;
  const svgf::MomentsMerge merge;
  core::Rng rng(32, core::Pass::other, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    const float x = 1000 + 0.05f * (rng.uniform() - 0.5f);
    first += 0.05f * (x - first), second += 0.05f * (x * x - second);
    if (i > 200) lowest = std::min(lowest, second - first * first);
    Step step;
    step.kept = i > 0 ? 19.0f : 0.0f, step.fresh = 1, step.samples = 1, step.varianceBefore = 0.0256f;
    m = merge.merge(m, x, step);
  }
  EXPECT_LT(lowest, 0);
  EXPECT_NEAR(m.sampleVariance, 0.05f * 0.05f / 12, 0.5f * 0.05f * 0.05f / 12);
}

TEST(Denormals, SquaredWeightsUnderflowWhereDividingTwiceDoesNot) {
  // A pixel last seen 1,000 frames ago: one sample, decay 0.95.
  Ledger<1> l = advance(Ledger<1>{}, {kU}, 1.0f);
  for (int i = 0; i < 1000; ++i) l = advance(l, {kU}, 0.0f);
  const float naive = l.powerSums[0] / (l.weight[0] * l.weight[0]);
  EXPECT_FALSE(naive > 0.5f && naive < 2);
  EXPECT_NEAR(l.weight[0], std::pow(0.95, 1000), 1e-25);
}

TEST(Denormals, LeaveBlendsFiniteAndInRange) {
  for (const float scale : {1e-38f, 1e-42f, 1e-45f}) {
    const twohistory::PairCovariance<float> c{3 * scale, 2 * scale, scale};
    const float p = leastVarianceWeight(c);
    EXPECT_TRUE(p >= 0 && p <= 1);
    EXPECT_TRUE(std::isfinite(lagWeight(c, 19.0f, 4.0f, scale)));
  }
}

/// Largest share of the seed's q = |g| / deviation over pixels after a step by a half, at some radiance; floor: least
/// variance, as the author shipped it (1e-6), or none.
float largestQ(float radiance, float floor) {
  constexpr float kGradient = 0.5f * 0.2f, kDeviation = 0.05f;  // relative to the radiance
  return std::min(1.0f, kGradient * radiance / std::sqrt(std::max(floor, std::pow(kDeviation * radiance, 2.0f))));
}

TEST(VarianceFloor, NaiveOneHidesAnyChangeInTheDarkAndOurBlendSeesIt) {
  EXPECT_EQ(largestQ(1, 1e-6f), 1);
  EXPECT_LT(largestQ(1e-4f, 1e-6f), 0.02f);       // the same step, darker: q = 0.01, as if nothing had happened
  const auto shareOfFirst = [](float radiance) {  // of the seed after a step in the light
    constexpr int kSide = 32;
    experiments::Variant v = experiments::variantByName("seed");
    tests::Synthetic input(
        kSide, kSide, 42, [=](int, int, int f) { return core::vec3(f < 40 ? radiance : 1.5f * radiance); },
        [](int x, int, int f) { return x < 16 && f > 30 ? 8 : 1; }, 16);
    experiments::FilterState state(v, kSide, kSide);
    core::Planes out(kSide, kSide);
    for (int i = 0; i < 44; ++i) filter(input.frame(i), v, {}, state, out);
    double sum = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < 16; ++x) sum += state.blendWeight()(x, y);
    return sum / (16 * kSide);
  };
  const double bright = shareOfFirst(1);
  EXPECT_GT(bright, 0.8);
  EXPECT_NEAR(shareOfFirst(1e-4f), bright, 1e-3);
}

TEST(Reset, NaiveGradientIsTheWholeSignalAndOursIsZero) {
  const float x = 3, naive = 0.8f * 0 + 0.2f * (x - 0);  // nothing gathered: history counts as black
  EXPECT_GT(naive, 0.5f);
  constexpr int kSide = 8;
  tests::Synthetic input(
      kSide, kSide, 43, [](int, int, int) { return core::vec3(3); }, [](int, int, int) { return 1; }, 16);
  const experiments::Variant v = experiments::variantByName("seed");
  svgf::FilterState<2> s(kSide, kSide);
  twohistory::GradientState gradient;
  gradient.fit(kSide, kSide);
  for (int i = 0; i < 12; ++i) {
    experiments::Shaded frame = input.frame(i);
    core::Image<twohistory::Taps> none(kSide, kSide);
    if (i == 11) frame.taps = none;  // everything is disoccluded
    s.swapFrames();
    svgf::dropBadSamples(frame.radiance, frame.samples, s.samples);
    svgf::accumulate<2>(v.filter, {v.histories[0], v.histories[1]}, frame.taps, frame.radiance, s);
    twohistory::updateGradient<2>({}, frame.guide, frame.taps, s.samples, s.ledger[1 - s.now], 0, s.history.views()[0],
                                  frame.radiance, gradient);
    if (i == 10) {
      EXPECT_NE(gradient.gradient.view().load(3, 3), core::vec3(0));  // control: noise has one
    }
    svgf::estimateVariance(v.filter, frame.guide, s);
    svgf::filterHistories(v.filter, frame.guide, s);
  }
  for (int i = 0; i < kSide * kSide; ++i) {
    EXPECT_EQ(gradient.gradient.view().at(i), core::vec3(0));
    EXPECT_EQ(s.ledgerAt(i % kSide, i / kSide).weight[0], 1);
    EXPECT_EQ(s.moments[s.now](i % kSide, i / kSide).innovations, 0);
  }
}

/// Frames of a grey wall with one firefly; luminance of its pixel by frame.
std::vector<float> fireflyFades(float clamp, double* clamped = nullptr) {
  constexpr int kSide = 8, kAt = 30, kFrames = 400;
  experiments::Variant v = experiments::variantByName("unweighted");
  v.filter.levels = 0, v.filter.fireflyClamp = clamp;
  tests::Synthetic input(
      kSide, kSide, 40, [](int, int, int) { return core::vec3(1); }, [](int, int, int) { return 1; }, 16);
  experiments::FilterState state(v, kSide, kSide);
  core::Planes out(kSide, kSide);
  std::vector<float> fades;
  for (int i = 0; i < kFrames; ++i) {
    const experiments::Shaded frame = input.frame(i);
    if (i == kAt) input.radiance().view().store(3, 3, core::vec3(1e6f));
    filter(frame, v, {}, state, out);
    fades.push_back(core::luminance(out.view().load(3, 3)));
  }
  if (clamped) *clamped = state.clampedEnergy();
  return fades;
}

TEST(Fireflies, FadeForHundredsOfFramesUnlessTheyAreClampedAndTheirEnergyIsCounted) {
  const std::vector<float> naive = fireflyFades(0);
  EXPECT_GT(naive[30 + 200], 2);  // 0.05 x 1e6 x 0.95^200 = 1.7 above the truth
  double clamped = 0;
  const std::vector<float> ours = fireflyFades(8, &clamped);
  EXPECT_NEAR(ours[31], 1, 0.5f);
  EXPECT_NEAR(clamped, 1e6, 0.01e6);
}

TEST(Fireflies, ClampLetsAChangeOfTheLightThroughAndTakesLittleOfPlainNoise) {
  experiments::Variant v = experiments::variantByName("unweighted");
  v.filter.fireflyClamp = 8;
  double energy = 0;
  tests::Synthetic input(
      32, 32, 41, [&](int, int, int f) { return core::vec3(f < 40 ? 1.0f : 100.0f); }, [](int, int, int) { return 1; });
  experiments::FilterState state(v, 32, 32);
  core::Planes out(32, 32);
  for (int i = 0; i < 120; ++i) {
    filter(input.frame(i), v, {}, state, out);
    if (i == 39) energy = state.clampedEnergy();
  }
  EXPECT_LT(energy / (40 * 32 * 32), 5e-3);  // exponential noise
  double mean = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) mean += core::luminance(out.view().load(x, y)) / (32 * 32);
  EXPECT_NEAR(mean, 100, 5);
}

}  // namespace
