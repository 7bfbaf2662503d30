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

TEST(NewShare, UnderARelativeCapIsOneInTwiceTheCapPlusOne) {
  for (const float cap : {0.0f, 1.0f, 5.0f, 20.0f, 100.0f})
    for (const float n : {1.0f, 8.0f}) {
      const Policy policy{Weighting::samples, Forgetting::relativeCap, cap};
      Ledger<1> l;
      for (int i = 0; i < 500; ++i) l = advance(l, {policy}, n);
      EXPECT_NEAR(restir::newShare(l, n), 1 / (2 * cap + 1), 1e-5f) << cap;
    }
}

TEST(NewShare, IsAllOfAFirstFrameAndMoreWhereTheFoveaArrives) {
  const Policy policy{Weighting::samples, Forgetting::relativeCap, 20};
  Ledger<1> l = advance(Ledger<1>{}, {policy}, 1.0f);
  EXPECT_EQ(restir::newShare(l, 1), 1);
  for (int i = 0; i < 100; ++i) l = advance(l, {policy}, 1.0f);
  const float steady = restir::newShare(l, 1);
  l = advance(l, {policy}, 8.0f);
  EXPECT_NEAR(restir::newShare(l, 8), 8.0f / (2 * 21 + 8), 1e-5f);
  EXPECT_GT(restir::newShare(l, 8), 5 * steady);
}

TEST(EffectiveResults, RunFromOneToAllOfThem) {
  EXPECT_EQ(restir::effectiveResults(8, 0), 8);
  EXPECT_EQ(restir::effectiveResults(8, 1), 1);
  EXPECT_EQ(restir::effectiveResults(0, 0.5f), 0);
  EXPECT_NEAR(restir::effectiveResults(8, 0.5f), 1 / (0.5f + 0.0625f), 1e-6f);
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
