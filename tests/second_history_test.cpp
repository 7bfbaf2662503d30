// Two histories of reservoirs: blended by counts they keep the mean, and where both forget alike they are worth more
// than one. The smallest bias of a frame's light that is detected half of the time is 1 %; the control has more.
#include "restir/second.h"

#include <gtest/gtest.h>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::RestirParameters;
using restir::RestirState;
using restir::SecondBlend;
using restir::SecondHistory;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kFrames = 6;

RestirParameters with(SecondBlend blend, double secondCap = 3) {
  RestirParameters p;
  p.second = {true, {twohistory::Weighting::samples, twohistory::Forgetting::relativeCap, secondCap}, blend};
  p.spatial = tests::farAndAroundCorners();
  return p;
}

/// A fovea that sweeps over the image, and pixels that rest.
float counts(int frame, int x, int y) {
  if (frame < kFrames - 1 && (x + y + frame) % 5 == 0) return 0;
  return std::abs(x - 3 * frame) <= 3 ? 8.0f : 1.0f;
}

/// Luminance of the last frame; weight: what the blend gave the first history there.
core::Planes render(const tests::World& world, RestirParameters p, std::uint64_t seed,
                    core::Image<float>* weight = nullptr) {
  p.demodulate = false;
  RestirState first(world.width(), world.height());
  SecondHistory second(world.width(), world.height());
  core::Planes out(world.width(), world.height());
  core::Image<float> samples(world.width(), world.height());
  for (int f = 0; f < world.frames(); ++f) {
    for (int y = 0; y < world.height(); ++y)
      for (int x = 0; x < world.width(); ++x) samples(x, y) = counts(f, x, y);
    const restir::Frame frame = world.frame(f, samples, seed);
    drawCandidates(p, frame, first);
    reuseTemporally(p, frame, first);
    reuseSpatiallyAndShade(p, frame, first, out);
    if (p.second.on) second.blendInto(p, frame, first, out);
  }
  if (weight) {
    *weight = core::Image<float>(world.width(), world.height());
    for (int y = 0; y < world.height(); ++y)
      for (int x = 0; x < world.width(); ++x) (*weight)(x, y) = second.weight()(x, y);
  }
  return out;
}

tests::Estimate estimateOf(const tests::World& world, const RestirParameters& p, int sequences) {
  tests::Estimate e(world.width(), world.height());
  std::vector<core::Planes> images(sequences);
  tbb::parallel_for(0, sequences, [&](int i) { images[i] = render(world, p, static_cast<std::uint64_t>(i + 1)); });
  for (const auto& image : images) e.add(image);
  return e;
}

tests::World world(bool moving) {
  tests::Motion m;
  if (moving) m.light = vec3(0.1f, 0, 0.03f), m.camera = vec3(0.03f, 0, 0.01f);
  return tests::World(tests::makeWorld(m), kFrames);
}

TEST(SecondHistory, BlendedByCountsIsUnbiased) {
  const auto moving = world(true);
  const auto truth = tests::reference(moving, 32, 512);
  const auto c = tests::compare(estimateOf(moving, with(SecondBlend::counts), 1200), truth);
  EXPECT_LT(std::abs(c.z), kLargestZ) << c.ratio;
  EXPECT_LT(c.detectable, 0.01);
  RestirParameters biased = with(SecondBlend::counts);
  biased.mis = restir::Mis::constant;
  const auto control = tests::compare(estimateOf(moving, biased, 300), truth);
  EXPECT_TRUE(tests::isBiased(control)) << control.ratio;
}

TEST(SecondHistory, HalfOfEachIsUnbiased) {
  const auto moving = world(true);
  const auto c = tests::compare(estimateOf(moving, with(SecondBlend::mean), 1200), tests::reference(moving, 32, 512));
  EXPECT_LT(std::abs(c.z), kLargestZ) << c.ratio;
  EXPECT_LT(c.detectable, 0.01);
}

TEST(SecondHistory, WeightsAreCountsAlone) {
  const auto still = world(false);
  core::Image<float> a, b;
  render(still, with(SecondBlend::counts), 1, &a);
  render(still, with(SecondBlend::counts), 2, &b);
  float least = 1, most = 0;
  for (int i = 0; i < tests::kPixels; ++i) {
    EXPECT_EQ(a.view().at(i), b.view().at(i));
    least = std::min(least, a.view().at(i)), most = std::max(most, a.view().at(i));
  }
  EXPECT_GE(least, 0);
  EXPECT_LE(most, 1);
  render(still, with(SecondBlend::measured), 1, &a);
  render(still, with(SecondBlend::measured), 2, &b);
  int differ = 0;
  for (int i = 0; i < tests::kPixels; ++i) differ += a.view().at(i) != b.view().at(i);
  EXPECT_GT(differ, 50) << "control: measured weights depend on samples";
}

TEST(SecondHistory, TwoThatForgetAlikeAreQuieterThanOne) {
  const auto still = world(false);
  RestirParameters one = with(SecondBlend::mean, 20);
  const double both = tests::totalVariance(estimateOf(still, one, 200));
  one.second.on = false;
  EXPECT_LT(both, 0.95 * tests::totalVariance(estimateOf(still, one, 200)));
}

}  // namespace
