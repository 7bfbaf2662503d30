// Candidates from presampled tiles: the same light with the same density as without, and images of the same mean. The
// smallest bias of a frame's light that is detected half of the time is 1 %; the control has more.
#include "restir/light_tiles.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/chi_square.h"
#include "tests/restir_worlds.h"

namespace {

using core::LightFeatures;
using core::vec3;
using restir::LightTiles;
using restir::TileUse;

constexpr LightFeatures kAll{true, true};
const double kLargestZ = core::sidakBound(1, 1e-6);

tests::World worldOf(int frames = 1) {
  tests::Motion motion;
  if (frames > 1) motion.light = {0.05f, 0, 0.02f}, motion.camera = {0.02f, 0, 0.01f};
  return tests::World(tests::makeWorld(motion, true), frames);
}

TEST(LightTiles, APackedSampleShinesAsItselfBitForBit) {
  const auto world = worldOf();
  const core::Lights& lights = *world.moment(0).lights;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    core::Rng rng(3, core::Pass::other, i, 0);
    const core::LightSample y = lights.sample(rng);
    const vec3 at = 4.0f * rng.uniform3() - 2.0f;
    const auto packed = lights.presample<kAll>(y);
    const auto a = lights.incident<kAll>(y, at), b = lights.incident<kAll>(packed, at);
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(a.radiance, b.radiance);
    EXPECT_EQ(a.geometry, b.geometry);
    EXPECT_EQ(lights.pdf(y), packed.pdf);
  }
}

TEST(LightTiles, LightsAreDrawnWithTheirDensity) {
  const auto world = worldOf();
  const core::Lights& lights = *world.moment(0).lights;
  std::vector<double> counts(lights.size()), expected(lights.size());
  double total = 0;
  for (std::uint32_t frame = 0; frame < 200; ++frame) {
    LightTiles tiles;
    tiles.fill(TileUse::always, lights, kAll, 1, 9, frame);
    for (int block = 0; block < 4; ++block)
      for (const auto& y : tiles.of(block * LightTiles::kBlock, 0)) ++counts[y.sample.light], ++total;
  }
  for (std::uint32_t i = 0; i < lights.size(); ++i) expected[i] = total * lights.probability(i);
  // Blocks may share a tile, so counts repeat up to four times; a quarter of them are independent.
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] /= 4, expected[i] /= 4;
  EXPECT_GT(tests::chiSquareP(counts, expected), 1e-6);
  std::swap(expected[0], expected[5]);
  EXPECT_LT(tests::chiSquareP(counts, expected), 1e-6) << "control";
}

TEST(LightTiles, BlocksShareATileAndFramesDoNot) {
  const auto world = worldOf();
  const core::Lights& lights = *world.moment(0).lights;
  LightTiles tiles;
  tiles.fill(TileUse::always, lights, kAll, 1 << 20, 9, 0);
  EXPECT_EQ(tiles.of(0, 0).data(), tiles.of(15, 15).data());
  EXPECT_EQ(tiles.of(0, 0).size(), static_cast<std::size_t>(LightTiles::kTileSize));
  std::vector<const void*> seen;
  for (int i = 0; i < 64; ++i) seen.push_back(tiles.of(16 * i, 0).data());
  std::sort(seen.begin(), seen.end());
  EXPECT_GT(std::unique(seen.begin(), seen.end()) - seen.begin(), 32);
  const auto first = tiles.of(0, 0)[0].sample;
  tiles.fill(TileUse::always, lights, kAll, 1 << 20, 9, 1);
  EXPECT_NE(tiles.of(0, 0)[0].sample.uv, first.uv);
}

TEST(LightTiles, FewLightsNeedNone) {
  const auto world = worldOf();
  LightTiles tiles;
  tiles.fill(TileUse::automatic, *world.moment(0).lights, kAll, 1 << 20, 9, 0);
  EXPECT_TRUE(tiles.of(0, 0).empty());
  tiles.fill(TileUse::always, core::Lights(), kAll, 1 << 20, 9, 0);
  EXPECT_TRUE(tiles.of(0, 0).empty());
}

restir::RestirParameters with(TileUse use, restir::Mis mis = restir::Mis::balance) {
  restir::RestirParameters p;
  p.mis = mis, p.candidates.lightTiles = use;
  p.spatial = tests::farAndAroundCorners();
  return p;
}

TEST(LightTiles, ImagesKeepTheirMean) {
  const auto world = worldOf(4);
  const auto truth = tests::reference(world, 64, 512);
  const auto c = tests::compare(tests::estimate(world, with(TileUse::always), 1500), truth);
  EXPECT_LT(std::abs(c.z), kLargestZ) << c.ratio;
  EXPECT_LT(c.worst, core::sidakBound(tests::kPixels, 1e-6));
  EXPECT_LT(c.detectable, 0.01);
  const auto constant = with(TileUse::always, restir::Mis::constant);
  const auto control = tests::compare(tests::estimate(world, constant, 500), truth);
  EXPECT_TRUE(tests::isBiased(control)) << control.ratio;
}

TEST(LightTiles, BitsDoNotDependOnTiles) {
  const auto world = worldOf(3);
  core::Planes a(world.width(), world.height()), b = a;
  tests::renderSequence(world, with(TileUse::always), {}, 4, a, 5);
  tests::renderSequence(world, with(TileUse::always), {}, 4, b, 64);
  for (int i = 0; i < tests::kPixels; ++i) EXPECT_EQ(a.view().at(i), b.view().at(i));
}

}  // namespace
