// Thousands of independent sequences: the mean of every pixel, and of the frame, is the light that is there.
//
// Significance 1e-6 a test, seeds 1, 2, ...; the smallest bias of a frame's light that is detected half of the time is
// 1 %, and single pixels are tested by Sidak's bound. Constant weights must fail.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::Mis;
using restir::RestirParameters;
using restir::Reuse;
using tests::Hooks;
using tests::Motion;
using tests::World;

constexpr int kFrames = 8, kSequences = 3072;
const double kLargestZ = core::sidakBound(1, 1e-6), kLargestPixelZ = core::sidakBound(tests::kPixels, 1e-6);

RestirParameters wide(Reuse reuse, Mis mis = Mis::balance) {
  RestirParameters p;
  p.reuse = reuse, p.mis = mis;
  p.spatial.radius = 0.25f, p.spatial.normalCosine = -1, p.spatial.planeDistance = 100;
  return p;
}

float patchwork(int frame, int x, int y, const vec3&) {
  static constexpr std::array<float, 5> kCounts{0, 1, 0, 4, 2};
  return frame == kFrames - 1 ? 1.0f : kCounts[(x + 2 * y + 3 * frame) % 5];
}

void expectUnbiased(const char* name, const World& world, const RestirParameters& p, const Hooks& hooks = {}) {
  const auto c = tests::compare(tests::estimate(world, p, kSequences, hooks), tests::reference(world, 64, 2048));
  std::printf("%-24s ratio %.4f +- %.4f, z %.2f, worst pixel %.2f\n", name, c.ratio, c.detectable / kLargestZ * 1.96,
              c.z, c.worst);
  EXPECT_LT(std::abs(c.z), kLargestZ) << c.ratio;
  EXPECT_LT(c.worst, kLargestPixelZ);
  EXPECT_LT(c.detectable, 0.01);
}

TEST(RestirBias, StillWorld) {
  const World world(tests::makeWorld({}, true), kFrames);
  expectUnbiased("none", world, wide(Reuse::none));
  expectUnbiased("temporal", world, wide(Reuse::temporal));
  expectUnbiased("spatial", world, wide(Reuse::spatial));
  expectUnbiased("both", world, wide(Reuse::both));
}

TEST(RestirBias, ConstantWeightsAreCaught) {
  const World world(tests::makeWorld({}, true), kFrames);
  for (Reuse reuse : {Reuse::spatial, Reuse::both}) {
    const auto c = tests::compare(tests::estimate(world, wide(reuse, Mis::constant), kSequences / 4),
                                  tests::reference(world, 64, 2048));
    EXPECT_GT(std::abs(c.z), kLargestZ);
    EXPECT_GT(c.worst, kLargestPixelZ);
    EXPECT_LT(c.ratio, 0.99);
  }
}

TEST(RestirBias, MovingLight) {
  Motion motion;
  motion.light = vec3(0.2f, 0, 0.05f);
  expectUnbiased("light moves", World(tests::makeWorld(motion), kFrames), wide(Reuse::both));
}

TEST(RestirBias, RisingLightAfterFramesWithoutSamples) {
  Motion motion;
  motion.light = vec3(0.05f, 0.3f, 0.05f);
  motion.lightStart = vec3(-0.2f, -1.9f, -0.2f);
  expectUnbiased("light rises, n varies", World(tests::makeWorld(motion), kFrames), wide(Reuse::both), {patchwork, {}});
}

TEST(RestirBias, MovingOccluder) {
  Motion motion;
  motion.occluder = vec3(0.05f, 0, 0.03f);
  expectUnbiased("occluder moves", World(tests::makeWorld(motion), kFrames), wide(Reuse::both));
}

TEST(RestirBias, MovingCamera) {
  Motion motion;
  motion.camera = vec3(0.05f, 0.02f, 0.03f);
  expectUnbiased("camera moves", World(tests::makeWorld(motion), kFrames), wide(Reuse::both));
}

TEST(RestirBias, EnergyDoesNotDriftOverAThousandFrames) {
  // Light of frames 800..1000 over that of frames 20..220, a ratio a sequence.
  constexpr int kLong = 1000, kWindow = 200, kStart = 20, kCount = 112;
  const World world(tests::makeWorld(), kLong);
  std::vector<double> ratios(kCount);
  tbb::parallel_for(0, kCount, [&](int i) {
    double early = 0, late = 0;
    core::Planes image(tests::kWidth, tests::kHeight);
    Hooks hooks;
    hooks.after = [&](int f, restir::RestirState&) {
      double sum = 0;
      for (int p = 0; p < tests::kPixels; ++p) sum += core::luminance(image.view().at(p));
      if (f >= kStart && f < kStart + kWindow) early += sum;
      if (f >= kLong - kWindow) late += sum;
    };
    tests::renderSequence(world, wide(Reuse::both), hooks, static_cast<std::uint64_t>(i + 1), image);
    ratios[i] = late / early;
  });
  const core::Interval interval = core::meanInterval(ratios, 1 - 1e-6);
  std::printf("drift over 780 frames: %.4f .. %.4f\n", interval.low, interval.high);
  EXPECT_LT(interval.low, 1);
  EXPECT_GT(interval.high, 1);
  EXPECT_LT(interval.halfWidth(), 0.01);
}

}  // namespace
