// The passes themselves: what they promise about counts, waiting reservoirs, bits and output, and that their mean is
// the light that is there. The smallest bias of a frame's light that the energy tests detect half of the time is 2 %;
// statistical/restir_bias_test.cpp is sharper.
#include "restir/restir.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::Mis;
using restir::RestirParameters;
using restir::Reuse;
using tests::Hooks;
using tests::Motion;
using tests::World;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kFrames = 6;

/// Neighbours from everywhere, so that targets differ as much as they can.
RestirParameters wide(Reuse reuse = Reuse::both, Mis mis = Mis::balance) {
  RestirParameters p;
  p.reuse = reuse, p.mis = mis;
  p.spatial = tests::farAndAroundCorners();
  return p;
}

void expectUnbiased(const World& world, const RestirParameters& p, int sequences, const Hooks& hooks = {}) {
  const auto c =
      tests::compare(tests::estimate(world, p, sequences, hooks), tests::reference(world, 16, 512, hooks.compared));
  EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
}
void expectBiased(const World& world, const RestirParameters& p, int sequences, const Hooks& hooks = {}) {
  const auto c =
      tests::compare(tests::estimate(world, p, sequences, hooks), tests::reference(world, 16, 512, hooks.compared));
  EXPECT_GT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_GT(std::abs(c.ratio - 1), 0.02);
}

TEST(Restir, EveryBalancedReuseIsUnbiased) {
  const World world(tests::makeWorld({}, true), kFrames);
  for (Reuse reuse : {Reuse::none, Reuse::temporal, Reuse::spatial, Reuse::both})
    expectUnbiased(world, wide(reuse), 768);
}

TEST(Restir, ContributionAndPairwiseAreUnbiased) {
  const World world(tests::makeWorld({}, true), kFrames);
  for (Mis mis : {Mis::contribution, Mis::pairwise}) expectUnbiased(world, wide(Reuse::both, mis), 1024);
}

TEST(Restir, TreeSamplesLeaveItUnbiasedUnderMovingLights) {
  Motion m;
  m.light = vec3(0.1f, 0, 0.03f);
  const World world(tests::makeWorld(m, true), kFrames);
  for (Reuse reuse : {Reuse::none, Reuse::both}) {
    RestirParameters p = wide(reuse);
    p.candidates.treeSamples = 2, p.candidates.lightSamples = 2, p.candidates.bsdfSamples = 0.25;
    expectUnbiased(world, p, 768, {tests::patchwork(kFrames), {}});
  }
}

TEST(Restir, ConstantWeightsAreBiasedInSpace) {
  const World world(tests::makeWorld(), kFrames);
  expectBiased(world, wide(Reuse::spatial, Mis::constant), 512);
  expectBiased(world, wide(Reuse::both, Mis::constant), 512);
}

TEST(Restir, MotionOfLightOccluderAndCameraLeavesItUnbiased) {
  Motion light, occluder, camera;
  light.light = vec3(0.2f, 0, 0.05f), occluder.occluder = vec3(0.05f, 0, 0.03f),
  camera.camera = vec3(0.05f, 0.02f, 0.03f);
  for (const Motion& motion : {light, occluder, camera})
    expectUnbiased(World(tests::makeWorld(motion), kFrames), wide(), 768);
}

TEST(Restir, CountsThatVaryAndVanishLeaveItUnbiased) {
  Motion motion;
  motion.light = vec3(0.2f, 0, 0.05f);
  const World world(tests::makeWorld(motion), kFrames);
  expectUnbiased(world, wide(), 768, {tests::patchwork(kFrames), {}, {}});
}

/// A frame of samples, then none while a lamp rises from below the floor, then one.
float pause(int frame, int, int, const vec3&) { return frame == 0 ? 8.0f : frame == kFrames - 1 ? 1.0f : 0.0f; }

World worldOfARisingLamp() {
  Motion motion;
  motion.light = vec3(0.05f, 0.4f, 0.05f);
  motion.lightStart = vec3(-0.2f, -1.9f, -0.2f);
  return World(tests::makeWorld(motion), kFrames);
}

TEST(Restir, ReservoirsThatWaitedWhileLightsMovedAreUnbiased) {
  expectUnbiased(worldOfARisingLamp(), wide(Reuse::temporal), 1536, {pause, {}, {}});
}

TEST(Restir, ReservoirsThatForgetTheirFrameAreBiased) {
  // The stamp is moved to the last frame, as if the target had been evaluated with its lights.
  const auto restamp = [](int frame, restir::RestirState& state) {
    for (int i = 0; i < tests::kPixels; ++i) state.now.data()[i].frame = static_cast<std::uint32_t>(frame);
  };
  expectBiased(worldOfARisingLamp(), wide(Reuse::temporal), 1536, {pause, restamp, {}});
}

/// As pause, but in the last frame every other pixel has no samples either: its reservoir waits on, and its neighbours
/// reuse it with the surface, viewer and lights that it had.
float pauseHalf(int frame, int x, int y, const vec3& before) {
  return frame == kFrames - 1 && (x + y) % 2 ? 0.0f : pause(frame, x, y, before);
}
bool shadedByPauseHalf(int x, int y) { return (x + y) % 2 == 0; }

TEST(Restir, NeighboursThatWaitAreReusedUnbiased) {
  expectUnbiased(worldOfARisingLamp(), wide(), 1536, {pauseHalf, {}, shadedByPauseHalf});
}

TEST(Restir, NeighboursThatForgetTheirFrameAreBiased) {
  const auto restamp = [](int frame, restir::RestirState& state) {
    for (int i = 0; i < tests::kPixels; ++i) state.now.data()[i].frame = static_cast<std::uint32_t>(frame);
  };
  expectBiased(worldOfARisingLamp(), wide(), 1536, {pauseHalf, restamp, shadedByPauseHalf});
}

TEST(Restir, TargetsOfTheLastFrameNeedItsLights) {
  RestirParameters p = wide(Reuse::temporal);
  expectUnbiased(worldOfARisingLamp(), p, 1024);
  p.temporal.previousLights = false;
  expectBiased(worldOfARisingLamp(), p, 1024);
}

TEST(Restir, CountsFromTheLastEstimateAreBiased) {
  const World world(tests::makeWorld(), kFrames);
  RestirParameters p = wide(Reuse::temporal);
  p.candidates = {1, 0};
  const auto scheduled = [](int f, int x, int y, const vec3&) { return (f + x + y) % 2 ? 1.0f : 8.0f; };
  const auto driven = [](int f, int, int, const vec3& before) {
    return f == 0 || core::luminance(before) > 0.5f ? 1.0f : 16.0f;
  };
  expectUnbiased(world, p, 1024, {scheduled, {}, {}});
  expectBiased(world, p, 1024, {driven, {}, {}});
}

TEST(Restir, MeanOfManyResultsIsTheMeanOfOne) {
  const World world(tests::makeWorld(), 3);
  const auto one = tests::estimate(world, wide(), 1024);
  const auto many = tests::estimate(world, wide(), 512, {[](int, int, int, const vec3&) { return 4.0f; }, {}});
  const auto c = tests::compare(many, one);
  EXPECT_LT(std::abs(c.z), kLargestZ) << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
  EXPECT_LT(many.total.variance(), 0.7 * one.total.variance());
}

core::Planes imageOf(const World& world, const RestirParameters& p, int tile = core::kDefaultTile) {
  core::Planes image(tests::kWidth, tests::kHeight);
  tests::renderSequence(world, p, {tests::patchwork(kFrames), {}, {}}, 3, image, tile);
  return image;
}

TEST(Restir, BitsDependNeitherOnThreadsNorOnTiles) {
  const World world(tests::makeWorld({vec3(0.1f), vec3(0), vec3(0.02f)}, true), kFrames);
  const core::Planes image = imageOf(world, wide());
  for (int tile : {1, 5, 64}) EXPECT_TRUE(tests::sameBits(image, imageOf(world, wide(), tile)));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(tests::sameBits(image, imageOf(world, wide())));
}

/// An image whose pixels draw from one stream of random numbers, in the order in which they are visited.
core::Planes inOrderOfVisits(int tile) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  core::Planes image(tests::kWidth, tests::kHeight);
  core::Rng rng(1, core::Pass::lab, 0, 0);
  core::forEachPixel(
      tests::kWidth, tests::kHeight, [&](int x, int y) { image.view().store(x, y, vec3(rng.uniform())); }, tile);
  return image;
}

TEST(Restir, BitsOfOneStreamOfRandomNumbersDependOnTiles) {
  EXPECT_TRUE(tests::sameBits(inOrderOfVisits(64), inOrderOfVisits(64)));
  EXPECT_FALSE(tests::sameBits(inOrderOfVisits(64), inOrderOfVisits(5)));
}

TEST(Restir, KernelsForEverythingGiveTheSameBits) {
  const World world(tests::makeWorld(), kFrames);
  RestirParameters all = wide();
  all.features = restir::Features::all;
  EXPECT_TRUE(tests::sameBits(imageOf(world, wide()), imageOf(world, all)));
}

/// Renders frames by hand with one count everywhere each.
struct Sequence {
  const World& world;
  RestirParameters p = wide();
  restir::RestirState state{tests::kWidth, tests::kHeight};
  core::Planes image{tests::kWidth, tests::kHeight};
  int frame = 0;

  void render(float n, const RestirParameters& parameters) {
    core::Image<float> samples(tests::kWidth, tests::kHeight, n);
    const restir::Frame f = world.frame(frame++, samples, 1);
    restir::drawCandidates(parameters, f, state);
    restir::reuseTemporally(parameters, f, state);
    restir::reuseSpatiallyAndShade(parameters, f, state, image);
  }
  void render(float n) { render(n, p); }
  const restir::Reservoir& centre() const { return state.now(tests::kWidth / 2 + 2, tests::kHeight / 2 + 2); }
};

TEST(Restir, ConfidenceIsTheCountAndCapsAtItsMultiple) {
  const World world(tests::makeWorld(), kFrames);
  Sequence s{world};
  s.p.temporal.policy.amount = 2;
  s.render(4);
  EXPECT_EQ(s.centre().confidence, 4);
  s.render(4);
  EXPECT_EQ(s.centre().confidence, 8);
  s.render(4);
  EXPECT_EQ(s.centre().confidence, 12);
  s.render(1);
  EXPECT_EQ(s.centre().confidence, 3);  // 2 x 1 + 1
  s.p.temporal.policy.weighting = twohistory::Weighting::frames;
  s.render(4);
  EXPECT_EQ(s.centre().confidence, 3);
}

TEST(Restir, WithoutSamplesAReservoirWaitsUnchanged) {
  const World world(tests::makeWorld(), kFrames);
  Sequence s{world};
  s.render(2);
  s.render(2);
  const restir::Reservoir kept = s.centre();
  s.render(0);
  s.render(0);
  EXPECT_EQ(std::memcmp(&kept, &s.centre(), sizeof(kept)), 0);
  EXPECT_EQ(s.centre().frame, 1u);
  s.render(2);
  EXPECT_EQ(s.centre().frame, 4u);
  EXPECT_EQ(s.centre().confidence, kept.confidence + 2);
}

TEST(Restir, ReservoirsThatWaitTooLongAreDropped) {
  const int wait = static_cast<int>(restir::PastMoments::kFrames);
  const World world(tests::makeWorld(), wait + 3);
  for (int extra : {-1, 0}) {
    Sequence s{world};
    s.render(2);
    for (int i = 0; i < wait + extra - 1; ++i) s.render(0);
    s.render(2);
    EXPECT_EQ(s.centre().confidence, extra < 0 ? 4 : 2);
  }
}

TEST(Restir, PixelsWithoutSamplesShowTheirNeighbours) {
  const World world(tests::makeWorld(), 1);
  RestirParameters p = wide();
  core::Planes full(tests::kWidth, tests::kHeight), holes(tests::kWidth, tests::kHeight);
  tests::renderSequence(world, p, {}, 1, full);
  const int hx = 3, hy = 4;
  Hooks hooks;
  hooks.samples = [&](int, int x, int y, const vec3&) { return x == hx && y == hy ? 0.0f : 1.0f; };
  float shadedAtHole = -1, shadedBeside = -1;
  hooks.after = [&](int, restir::RestirState& state) {
    shadedAtHole = state.shaded(hx, hy), shadedBeside = state.shaded(hx + 1, hy);
  };
  tests::renderSequence(world, p, hooks, 1, holes);
  EXPECT_EQ(shadedAtHole, 0);
  EXPECT_EQ(shadedBeside, 1);
  EXPECT_GT(core::luminance(holes.view().load(hx, hy)), 0);
  Sequence dark{world};
  dark.render(0);
  for (int i = 0; i < tests::kPixels; ++i) EXPECT_EQ(dark.image.view().at(i), vec3(0));
}

TEST(Restir, RadianceIsDividedByTheAlbedo) {
  const World world(tests::makeWorld(), 1);
  Sequence raw{world}, demodulated{world};
  RestirParameters p = wide();
  demodulated.render(1, p);
  p.demodulate = false;
  raw.render(1, p);
  const core::Moment now = world.moment(0);
  for (int i = 0; i < tests::kPixels; ++i) {
    const vec3 albedo = core::demodulationAlbedo(now.surfaces.at(i));
    EXPECT_EQ(now.surfaces.at(i).hit() ? raw.image.view().at(i) / albedo : vec3(0), demodulated.image.view().at(i));
  }
}

TEST(Restir, LightsBeyondFloatStayOutOfTheImage) {
  core::Scene scene = tests::makeWorld();
  for (core::Material& m : scene.materials)
    if (m.emits()) m.emission *= 1e37f;
  const World world(scene, kFrames);
  Sequence s{world};
  for (int f = 0; f < kFrames; ++f) s.render(2);
  for (int i = 0; i < tests::kPixels; ++i) EXPECT_TRUE(core::isFinite(s.image.view().at(i)));
}

TEST(Restir, WorldsWithoutLightAreBlack) {
  core::Scene scene = tests::makeWorld();
  for (core::Material& m : scene.materials) m.emission = vec3(0);
  const World world(scene, 2);
  for (Reuse reuse : {Reuse::none, Reuse::both}) {
    Sequence s{world, wide(reuse)};
    s.render(1);
    s.render(1);
    for (int i = 0; i < tests::kPixels; ++i) EXPECT_EQ(s.image.view().at(i), vec3(0));
    EXPECT_EQ(s.state.badPixels(), 0);
  }
}

}  // namespace
