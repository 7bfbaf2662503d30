// The filter on frames without a renderer: constants stay, scale does not matter, bad input is a frame without samples,
// holes are filled, output does not depend on threads; blends order as their derivation says.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "tests/synthetic.h"

namespace {

using core::Planes;
using core::vec3;
using experiments::FilterState;
using experiments::Shaded;
using experiments::Variant;
using experiments::variantByName;
using tests::Synthetic;

constexpr int kWidth = 40, kHeight = 28;

int eightOrOne(int x, int, int frame) { return (x + frame) % 20 < 8 ? 8 : 1; }
vec3 grey(int, int, int) { return vec3(1); }

bool sameBits(const Planes& a, const Planes& b) {
  for (int c = 0; c < 3; ++c)
    if (std::memcmp(a.view().plane[c].data, b.view().plane[c].data, sizeof(float) * a.width() * a.height()) != 0)
      return false;
  return true;
}

class EveryVariant : public testing::TestWithParam<std::string> {
 protected:
  Variant variant_ = variantByName(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Variants, EveryVariant, testing::ValuesIn(experiments::variantNames()), [](const auto& param) {
  std::string name = param.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryVariant, LeavesAConstantImageAlone) {
  Synthetic input(kWidth, kHeight, 1, grey, eightOrOne);
  FilterState state(variant_, kWidth, kHeight);
  Planes out(kWidth, kHeight);
  for (int i = 0; i < 12; ++i) {
    Shaded frame = input.frame(i);
    core::forEachPixel(kWidth, kHeight, [&](int x, int y) { input.radiance().view().store(x, y, vec3(0.5f, 1, 2)); });
    filter(frame, variant_, {}, state, out);
  }
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(out.view().load(x, y)[c] / vec3(0.5f, 1, 2)[c], 1, 1e-5);
}

TEST_P(EveryVariant, IsInvariantToRadianceScale) {
  // Powers of two change no rounding but that of denormal numbers, so outputs scale bit for bit; 1e-4 .. 1e6 in
  // between.
  for (const float scale : {0x1p-14f, 0x1p20f}) {
    Synthetic one(kWidth, kHeight, 2, grey, eightOrOne);
    Synthetic scaled(
        kWidth, kHeight, 2, [&](int, int, int) { return vec3(scale); }, eightOrOne);
    const Planes a = filterSequence(one, variant_, 10), b = filterSequence(scaled, variant_, 10);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        ASSERT_EQ(b.view().load(x, y).x / scale, a.view().load(x, y).x) << x << ", " << y;
  }
}

// Four times the samples of a quarter of the weight each: the same frames, counted in another unit.
TEST_P(EveryVariant, IsInvariantToTheUnitOfCounts) {
  const auto fourTimes = [](int x, int y, int frame) { return 4 * eightOrOne(x, y, frame); };
  Synthetic one(kWidth, kHeight, 3, grey, eightOrOne, 4), four(kWidth, kHeight, 3, grey, fourTimes, 1);
  const Planes a = filterSequence(one, variant_, 20), b = filterSequence(four, variant_, 20);
  if (std::string(GetParam()) == "published")
    EXPECT_FALSE(sameBits(a, b));  // the control: its formula mixes powers of n (docs/history.md)
  else
    EXPECT_TRUE(sameBits(a, b));
}

TEST_P(EveryVariant, StaysFiniteWhereSquaresUnderflowOrNothingIsLit) {
  for (const float scale : {1e-20f, 1e-30f, 1e-42f, 0.0f, 1e18f}) {
    Synthetic input(
        kWidth, kHeight, 6, [&](int x, int, int) { return vec3(x < 20 ? scale : 0); }, eightOrOne);
    const Planes out = filterSequence(input, variant_, 8);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) ASSERT_TRUE(core::isFinite(out.view().load(x, y))) << scale;
  }
}

TEST_P(EveryVariant, HasTheSameBitsForAnyNumberOfThreads) {
  Planes results[2];
  for (const int threads : {1, 2}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Synthetic input(kWidth, kHeight, 3, grey, eightOrOne);
    results[threads - 1] = filterSequence(input, variant_, 8);
  }
  EXPECT_TRUE(sameBits(results[0], results[1]));
}

TEST_P(EveryVariant, TreatsNotFiniteRadianceAsAFrameWithoutSamples) {
  const auto run = [&](bool poison) {
    Synthetic input(kWidth, kHeight, 4, grey, [&](int x, int y, int frame) {
      return !poison && frame == 5 && x == 7 && y == 9 ? 0 : eightOrOne(x, y, frame);
    });
    FilterState state(variant_, kWidth, kHeight);
    Planes out(kWidth, kHeight);
    for (int i = 0; i < 9; ++i) {
      Shaded frame = input.frame(i);
      if (poison && i == 5) input.radiance().view().store(7, 9, vec3(std::numeric_limits<float>::infinity(), 0, NAN));
      filter(frame, variant_, {}, state, out);
    }
    EXPECT_EQ(state.badPixels(), poison ? 1 : 0);
    return out;
  };
  EXPECT_TRUE(sameBits(run(true), run(false)));
}

TEST_P(EveryVariant, FillsPixelsThatNeverSawASampleFromTheirNeighbours) {
  Synthetic input(kWidth, kHeight, 5, grey,
                  [](int x, int y, int) { return x > 10 && x < 14 && y > 10 && y < 14 ? 0 : 4; });
  const Planes out = filterSequence(input, variant_, 6);
  for (int y = 11; y < 14; ++y)
    for (int x = 11; x < 14; ++x) EXPECT_NEAR(out.view().load(x, y).y, 1, 0.35) << x << ", " << y;
}

double meanOf(const Planes& image) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) sum += image.view().load(x, y).y;
  return sum / (image.width() * image.height());
}

/// Mean of a filtered grey wall: 6 seeds x 1120 pixels, standard error below 0.5 %.
double filteredMean(const Variant& variant, int variatesPerSample) {
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Synthetic input(kWidth, kHeight, 60 + seed, grey, eightOrOne, variatesPerSample);
    sum += meanOf(filterSequence(input, variant, 25));
  }
  return sum / 6;
}

// Weights underflow on the way; values must outlive them.
TEST_P(EveryVariant, RemembersThroughThousandsOfFramesWithoutSamples) {
  constexpr int kSide = 8, kLit = 40, kFrames = 3000;
  Synthetic input(kSide, kSide, 9, grey, [](int, int, int frame) { return frame < kLit ? 4 : 0; });
  FilterState state(variant_, kSide, kSide);
  Planes out(kSide, kSide);
  double lit = 0;
  for (int i = 0; i < kFrames; ++i) {
    filter(input.frame(i), variant_, {}, state, out);
    if (i == kLit - 1) lit = meanOf(out);
    if (i % 100 == 99) {
      ASSERT_NEAR(meanOf(out), lit, 0.1 * lit) << "frame " << i;
    }
  }
}

TEST_P(EveryVariant, KeepsTheMeanOfAStationarySignal) {
  EXPECT_NEAR(filteredMean(variant_, 4), 1, 0.02);  // relative noise 0.5 a sample
}

TEST(Filter, ControlVerySkewedNoiseLosesEnergyToTheLuminanceWeight) {
  // Exponential noise without history: bright outliers keep to themselves. docs/results.md says how much.
  EXPECT_LT(filteredMean(variantByName("none"), 1), 0.96);
}

double errorOf(const char* name, const Synthetic::Signal& signal, int frames) {
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Synthetic input(kWidth, kHeight, 100 + seed, signal, eightOrOne);
    sum += squaredError(filterSequence(input, variantByName(name), frames), input, frames - 1);
  }
  return sum;
}

TEST(Blends, UnderConstantTruthLeastVarianceBeatsItsParts) {
  const double optimal = errorOf("optimal", grey, 40);
  EXPECT_LT(optimal, errorOf("unweighted", grey, 40));
  EXPECT_LT(optimal, errorOf("none", grey, 40) / 3);
}

TEST(Blends, UnderDriftLagRegressionLagsLess) {
  const auto ramp = [](int, int, int frame) { return vec3(0.5f + 0.05f * static_cast<float>(frame)); };
  const double unweighted = errorOf("unweighted", ramp, 40);
  EXPECT_LT(errorOf("lag-wf", ramp, 40), 0.5 * unweighted);
  EXPECT_LT(errorOf("lag-safe", ramp, 40), 0.8 * unweighted);
  EXPECT_GT(errorOf("unweighted-98", ramp, 40), 1.5 * unweighted);  // control: a longer memory lags more
}

TEST(Oracle, IsTheLimitOfInterpolation) {
  Synthetic input(kWidth, kHeight, 9, grey, eightOrOne);
  const Variant oracle = variantByName("oracle"), optimal = variantByName("optimal");
  FilterState a(oracle, kWidth, kHeight), b(optimal, kWidth, kHeight);
  Planes imageA(kWidth, kHeight), imageB(kWidth, kHeight), truth(kWidth, kHeight, 1);
  for (int i = 0; i < 20; ++i) {
    const Shaded frame = input.frame(i);
    filter(frame, oracle, i == 19 ? truth.view() : core::PlanesView<float>{}, a, imageA);
    filter(frame, optimal, {}, b, imageB);
  }
  EXPECT_LT(squaredError(imageA, input, 19), squaredError(imageB, input, 19));
}

TEST(Moments, SampleVarianceIsThatOfOneSampleWhateverTheCounts) {
  // True value 1 (exponential noise). Mean over 4 seeds x 1120 pixels of an estimator with 20 innovations' memory.
  for (const float brightness : {1e-4f, 1.0f, 1e6f}) {
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      Synthetic input(
          kWidth, kHeight, 200 + seed, [&](int, int, int) { return vec3(brightness); }, eightOrOne);
      svgf::FilterState<1> state(kWidth, kHeight);
      const svgf::FilterParameters parameters;
      for (int i = 0; i < 60; ++i) {
        const Shaded frame = input.frame(i);
        state.swapFrames();
        svgf::dropBadSamples(frame.radiance, frame.samples, state.samples);
        svgf::accumulate<1>(parameters, {twohistory::Policy{}}, frame.taps, frame.radiance, state);
        svgf::estimateVariance(parameters, frame.guide, state);
      }
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) sum += state.sampleVariance(x, y);
    }
    EXPECT_NEAR(sum / (4 * kWidth * kHeight) / (brightness * brightness), 1, 0.05) << brightness;
  }
}

TEST(Moments, InnovationsSurviveWhereSquaresCancel) {
  // Relative noise 1e-3: float E[x^2] - E[x]^2 is off by more than 10 %, the innovation form is not.
  svgf::MomentsMerge merge;
  svgf::Moments m;
  twohistory::Ledger<1> ledger;
  const twohistory::Policy none{twohistory::Weighting::frames, twohistory::Forgetting::none, 0};
  float square = 0, mean = 0;
  double sum = 0, exactSum = 0, exactMean = 0, exactVariance = 0;  // in double arithmetic
  constexpr int kFrames = 20000;
  for (int i = 0; i < kFrames; ++i) {
    core::Rng rng(7, core::Pass::lab, 0, static_cast<std::uint32_t>(i));
    const float x = 1000 + 2 * (rng.uniform() - 0.5f) * std::sqrt(3.0f);  // variance 1
    const auto change = advanceOf(ledger, {none}, 1.0f);
    twohistory::Step step;
    step.taps = i > 0 ? twohistory::stillTap(0) : twohistory::Taps{};
    step.kept = ledger.weight[0], step.fresh = 1, step.samples = 1, step.varianceBefore = ledger.covariance(0, 0);
    m = merge.merge(m, x, step);
    ledger = advance(ledger, change, 1.0f);
    const double d = x - exactMean, a = std::max(0.05, 1.0 / std::max(i, 1));
    if (i > 0) exactVariance += a * (d * d / (1 + 1.0 / i) - exactVariance);
    exactMean += d / (i + 1);
    if (i >= 100) sum += m.sampleVariance, exactSum += exactVariance;
    const float alpha = 1.0f / static_cast<float>(i + 1);
    mean += alpha * (x - mean), square += alpha * (x * x - square);
  }
  EXPECT_NEAR(sum / (kFrames - 100), 1, 0.02);
  EXPECT_NEAR(sum / exactSum, 1, 2e-5);
  EXPECT_GT(std::abs(square - mean * mean - 1), 0.1);  // control
}

}  // namespace
