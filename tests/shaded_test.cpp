// Shading every sample that a pixel and its neighbours merge, in place of the one that is chosen: the same mean in
// every unbiased mode, less noise. Significance 1e-6; the smallest bias of a frame's light that is detected half of the
// time is 2 %, in shaded_test_thorough 1 %; the control has more than that.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::Mis;
using restir::Shaded;
using tests::World;

constexpr int kFrames = 6;
const double kLargestZ = core::sidakBound(1, 1e-6);

restir::RestirParameters with(Shaded shaded, Mis mis = Mis::balance, bool visibility = false) {
  restir::RestirParameters p;
  p.mis = mis, p.shaded = shaded, p.targetVisibility = visibility;
  p.spatial = tests::farAndAroundCorners();
  return p;
}

World movingWorld() {
  tests::Motion m;
  m.light = vec3(0.1f, 0, 0.03f), m.occluder = vec3(0.05f, 0, 0.03f), m.camera = vec3(0.03f, 0, 0.01f);
  return World(tests::makeWorld(m, true), kFrames);
}

class AllShaded : public testing::TestWithParam<std::tuple<Mis, bool>> {};
INSTANTIATE_TEST_SUITE_P(Modes, AllShaded,
                         testing::Combine(testing::Values(Mis::contribution, Mis::balance, Mis::pairwise),
                                          testing::Bool()));

TEST_P(AllShaded, IsUnbiasedUnderMotionAndChangingCounts) {
  const auto [mis, visibility] = GetParam();
  const World world = movingWorld();
  const auto c =
      tests::compare(tests::estimate(world, with(Shaded::all, mis, visibility), 1024, {tests::patchwork(kFrames), {}}),
                     tests::reference(world, 16, 512));
  EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
}

TEST(AllShaded, ConstantWeightsAreCaught) {
  const World world = movingWorld();
  const auto c =
      tests::compare(tests::estimate(world, with(Shaded::all, Mis::constant), 512), tests::reference(world, 16, 512));
  EXPECT_TRUE(tests::isBiased(c)) << "ratio " << c.ratio;
}

TEST(AllShaded, IsQuieterThanTheChosenOne) {
  const World world(tests::makeWorld(), kFrames);
  const auto varianceWith = [&](const restir::RestirParameters& p) {
    return tests::totalVariance(tests::estimate(world, p, 256, {}));
  };
  for (Mis mis : {Mis::balance, Mis::pairwise})
    EXPECT_LT(varianceWith(with(Shaded::all, mis)), 0.8 * varianceWith(with(Shaded::chosen, mis)));
}

core::Planes imageOf(const World& world, restir::RestirParameters p, int tile = core::kDefaultTile) {
  core::Planes image(tests::kWidth, tests::kHeight);
  tests::renderSequence(world, p, {tests::patchwork(kFrames), {}, {}}, 3, image, tile);
  return image;
}

TEST(AllShaded, WithoutNeighboursIsTheChosenOne) {
  const World world = movingWorld();
  restir::RestirParameters all = with(Shaded::all), chosen = with(Shaded::chosen);
  EXPECT_FALSE(tests::sameBits(imageOf(world, all), imageOf(world, chosen)));
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
  EXPECT_TRUE(tests::sameBits(image, imageOf(world, with(Shaded::all), 5)));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(tests::sameBits(image, imageOf(world, with(Shaded::all))));
}

}  // namespace
