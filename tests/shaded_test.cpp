// Shading every sample that a pixel and its neighbours merge, in place of the one that is chosen: the same mean in
// every unbiased mode, less noise. Significance 1e-6; the smallest bias of a frame's light that is detected half of the
// time is 2 %.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::Mis;
using restir::Reuse;
using restir::Shaded;
using tests::Hooks;
using tests::World;

constexpr int kFrames = 6;
const double kLargestZ = core::sidakBound(1, 1e-6);

restir::RestirParameters with(Shaded shaded, Mis mis = Mis::balance, bool visibility = false) {
  restir::RestirParameters p;
  p.mis = mis, p.shaded = shaded, p.targetVisibility = visibility;
  p.spatial.radius = 0.25f, p.spatial.normalCosine = -1, p.spatial.planeDistance = 100;
  return p;
}

World movingWorld() {
  tests::Motion m;
  m.light = vec3(0.1f, 0, 0.03f), m.occluder = vec3(0.05f, 0, 0.03f), m.camera = vec3(0.03f, 0, 0.01f);
  return World(tests::makeWorld(m, true), kFrames);
}

/// Counts 0, 1, 2 and 4, by pixel and frame; 1 in the last.
float patchwork(int frame, int x, int y, const vec3&) {
  static constexpr std::array<float, 5> kCounts{0, 1, 0, 4, 2};
  return frame == kFrames - 1 ? 1.0f : kCounts[(x + 2 * y + 3 * frame) % 5];
}

class AllShaded : public testing::TestWithParam<std::tuple<Mis, bool>> {};
INSTANTIATE_TEST_SUITE_P(Modes, AllShaded,
                         testing::Combine(testing::Values(Mis::contribution, Mis::balance, Mis::pairwise),
                                          testing::Bool()));

TEST_P(AllShaded, IsUnbiasedUnderMotionAndChangingCounts) {
  const auto [mis, visibility] = GetParam();
  const World world = movingWorld();
  const auto c = tests::compare(tests::estimate(world, with(Shaded::all, mis, visibility), 1024, {patchwork, {}}),
                                tests::reference(world, 16, 512));
  EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
}

TEST(AllShaded, ConstantWeightsAreCaught) {
  const World world = movingWorld();
  const auto c =
      tests::compare(tests::estimate(world, with(Shaded::all, Mis::constant), 512), tests::reference(world, 16, 512));
  EXPECT_GT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
}

double variance(const tests::Estimate& e) {
  double sum = 0;
  for (const auto& p : e.pixels) sum += p.variance();
  return sum;
}

TEST(AllShaded, IsQuieterThanTheChosenOne) {
  const World world(tests::makeWorld(), kFrames);
  const auto varianceWith = [&](const restir::RestirParameters& p) {
    return variance(tests::estimate(world, p, 256, {}));
  };
  for (Mis mis : {Mis::balance, Mis::pairwise})
    EXPECT_LT(varianceWith(with(Shaded::all, mis)), 0.8 * varianceWith(with(Shaded::chosen, mis)));
}

core::Planes imageOf(const World& world, restir::RestirParameters p, int tile = core::kDefaultTile) {
  core::Planes image(tests::kWidth, tests::kHeight);
  tests::renderSequence(world, p, {patchwork, {}, {}}, 3, image, tile);
  return image;
}

bool sameBits(const core::Planes& a, const core::Planes& b) {
  for (int c = 0; c < 3; ++c)
    if (std::memcmp(a.view().plane[c].data, b.view().plane[c].data, sizeof(float) * tests::kPixels) != 0) return false;
  return true;
}

TEST(AllShaded, WithoutNeighboursIsTheChosenOne) {
  const World world = movingWorld();
  restir::RestirParameters all = with(Shaded::all), chosen = with(Shaded::chosen);
  EXPECT_FALSE(sameBits(imageOf(world, all), imageOf(world, chosen)));
  all.spatial.neighbours = chosen.spatial.neighbours = 0;
  const core::Planes a = imageOf(world, all), b = imageOf(world, chosen);
  for (int i = 0; i < tests::kPixels; ++i) {
    const vec3 x = a.view().at(i), y = b.view().at(i);
    EXPECT_LE(glm::length(x - y), 1e-5f * glm::length(y)) << i;
  }
}

TEST(AllShaded, BitsDependNeitherOnThreadsNorOnTiles) {
  const World world = movingWorld();
  const core::Planes image = imageOf(world, with(Shaded::all));
  EXPECT_TRUE(sameBits(image, imageOf(world, with(Shaded::all), 5)));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(sameBits(image, imageOf(world, with(Shaded::all))));
}

}  // namespace
