// What the denoiser is told: closed forms, and that it follows from counts alone.
#include "restir/told.h"

#include <gtest/gtest.h>

#include "tests/restir_worlds.h"

namespace {

using restir::RestirParameters;
using restir::Told;
using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::Weighting;

Ledger<1> steady(double cap, float n, int frames = 500) {
  Ledger<1> l;
  for (int i = 0; i < frames; ++i) l = advance(l, {Policy{Weighting::samples, Forgetting::relativeCap, cap}}, n);
  return l;
}

TEST(EffectiveCount, UnderARelativeCapIsOneInTwiceTheCapPlusOne) {
  for (const double cap : {0.0, 1.0, 5.0, 20.0, 100.0})
    for (const float n : {1.0f, 8.0f})
      EXPECT_NEAR(restir::effectiveCount(n, 1, steady(cap, n), n), 1 / (2 * cap + 1), 1e-5) << cap;
}

TEST(EffectiveCount, OfIndependentResultsIsTheirNumberAndOfAFirstFrameOnlySharesTheReservoir) {
  EXPECT_EQ(restir::effectiveCount(8, 0, steady(20, 8), 8), 8);
  EXPECT_EQ(restir::effectiveCount(8, 1, steady(20, 8, 1), 8), 1);
  EXPECT_NEAR(restir::effectiveCount(8, 0.5f, steady(20, 8, 1), 8), 1 / (0.5f + 0.0625f), 1e-6f);
  EXPECT_EQ(restir::effectiveCount(0, 0.5f, steady(20, 8), 0), 0);
}

TEST(EffectiveCount, RisesMoreThanTheCountWhereTheFoveaArrives) {
  Ledger<1> l = steady(20, 1);
  const float before = restir::effectiveCount(1, 0.23f, l, 1);
  l = advance(l, {Policy{Weighting::samples, Forgetting::relativeCap, 20}}, 8.0f);
  EXPECT_GT(restir::effectiveCount(8, 0.23f, l, 8), 5 * before);
}

/// What every pixel's radiance stands for after some frames of a world with counts 0, 1 and 4.
core::Image<float> toldIn(const tests::World& world, Told told, std::uint64_t seed) {
  RestirParameters p;
  p.tellAll = true;
  core::Image<float> result(tests::kWidth, tests::kHeight);
  tests::Hooks hooks;
  hooks.samples = [](int f, int x, int y, const core::vec3&) {
    return std::array{0.0f, 1.0f, 4.0f}[static_cast<std::size_t>((x + y + (f == 3)) % 3)];
  };
  hooks.after = [&](int, restir::RestirState& state) {
    result = told == Told::samples ? state.shaded : told == Told::confidence ? state.confidence : state.effective;
  };
  core::Planes out(tests::kWidth, tests::kHeight);
  renderSequence(world, p, hooks, seed, out);
  return result;
}

TEST(Told, DependsOnCountsAloneAndIsZeroWithoutSamples) {
  const tests::World world(tests::makeWorld(), 4);
  const core::Image<float> samples = toldIn(world, Told::samples, 1);
  bool differs = false;
  for (const Told told : {Told::confidence, Told::effective}) {
    const core::Image<float> one = toldIn(world, told, 1), other = toldIn(world, told, 2);
    for (int i = 0; i < tests::kPixels; ++i) {
      ASSERT_EQ(one.data()[i], other.data()[i]);
      ASSERT_EQ(one.data()[i] > 0, samples.data()[i] > 0);
      if (told == Told::confidence) {
        ASSERT_GE(one.data()[i], samples.data()[i]);
      }
      if (told == Told::effective) {
        ASSERT_LE(one.data()[i], samples.data()[i]);
      }
      differs |= one.data()[i] != samples.data()[i];
    }
  }
  EXPECT_TRUE(differs);
}

}  // namespace
