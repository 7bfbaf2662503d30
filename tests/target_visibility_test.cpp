// Targets that include visibility leave reuse unbiased only where every denominator includes it, with the geometry that
// each target had. The smallest bias of a frame's light that is detected half of the time is 2 %;
// statistical/restir_bias_test.cpp is sharper.
#include <gtest/gtest.h>

#include <cstring>

#include "restir/visibility.h"
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

RestirParameters seeing(Reuse reuse = Reuse::both, Mis mis = Mis::balance) {
  RestirParameters p;
  p.reuse = reuse, p.mis = mis, p.targetVisibility = true;
  p.spatial = tests::farAndAroundCorners();
  return p;
}

tests::Comparison comparisonOf(const World& world, const RestirParameters& p, int sequences, const Hooks& hooks = {}) {
  return tests::compare(tests::estimate(world, p, sequences, hooks), tests::reference(world, 16, 512, hooks.compared));
}
void expectUnbiased(const World& world, const RestirParameters& p, int sequences, const Hooks& hooks = {}) {
  const auto c = comparisonOf(world, p, sequences, hooks);
  EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
}
void expectBiased(const World& world, const RestirParameters& p, int sequences, const Hooks& hooks = {}) {
  const auto c = comparisonOf(world, p, sequences, hooks);
  EXPECT_GT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_GT(std::abs(c.ratio - 1), 0.02);
}

Motion ofLight() {
  Motion m;
  m.light = vec3(0.2f, 0, 0.05f);
  return m;
}
Motion ofOccluder() {
  Motion m;
  m.occluder = vec3(0.2f, 0, 0.1f);
  return m;
}

TEST(TargetVisibility, EveryUnbiasedModeStaysSo) {
  const World world(tests::makeWorld({}, true), kFrames);
  for (Mis mis : {Mis::contribution, Mis::balance, Mis::pairwise}) expectUnbiased(world, seeing(Reuse::both, mis), 768);
}

TEST(TargetVisibility, ConstantWeightsAreBiased) {
  expectBiased(World(tests::makeWorld(), kFrames), seeing(Reuse::spatial, Mis::constant), 512);
}

TEST(TargetVisibility, MovingLightLeavesItUnbiased) {
  expectUnbiased(World(tests::makeWorld(ofLight()), kFrames), seeing(), 768);
}

TEST(TargetVisibility, MovingOccludersNeedTheGeometryThatWas) {
  const World world(tests::makeWorld(ofOccluder()), kFrames);
  RestirParameters p = seeing(Reuse::temporal);
  expectUnbiased(world, p, 1024);
  p.temporal.previousGeometry = false;
  expectBiased(world, p, 1024);
}

/// Counts 0, 1, 2 and 4; reservoirs that wait remember the geometry that they saw.
TEST(TargetVisibility, CountsThatVaryAndVanishLeaveItUnbiased) {
  expectUnbiased(World(tests::makeWorld(ofOccluder()), kFrames), seeing(), 1024, {tests::patchwork(kFrames), {}, {}});
}

/// Shadow rays written back into history, every frame: a hidden sample becomes a null sample.
TEST(TargetVisibility, WrittenBackWithoutTheDenominatorsItIsBiased) {
  const World world(tests::makeWorld(ofOccluder()), kFrames);
  const auto writeBack = [&](int frame, restir::RestirState& state) {
    const core::Moment now = world.moment(frame);
    for (int i = 0; i < tests::kPixels; ++i) {
      restir::Reservoir& r = state.now.data()[i];
      if (!(r.unbiasedWeight > 0)) continue;
      const auto in = now.lights->incident<core::LightFeatures{true, true}>(r.sample, now.surfaces.at(i).position);
      if (!restir::visible(*now.tracer, now.surfaces.at(i), in)) r.unbiasedWeight = 0;
    }
  };
  RestirParameters p = seeing(Reuse::temporal);
  p.targetVisibility = false;
  expectUnbiased(world, p, 1024);
  expectBiased(world, p, 1024, {{}, writeBack, {}});
}

TEST(TargetVisibility, ReusedShadowRaysAgreeWithNewOnes) {
  // Whatever a pixel shades without a shadow ray of its own is visible to it.
  const World world(tests::makeWorld(ofOccluder(), true), kFrames);
  int kept = 0;
  Hooks hooks;
  hooks.after = [&](int frame, restir::RestirState& state) {
    const core::Moment now = world.moment(frame);
    for (int i = 0; i < tests::kPixels; ++i) {
      const restir::Reservoir& r = state.now.data()[i];
      if (!(r.unbiasedWeight > 0)) continue;
      const auto in = now.lights->incident<core::LightFeatures{true, true}>(r.sample, now.surfaces.at(i).position);
      EXPECT_TRUE(restir::visible(*now.tracer, now.surfaces.at(i), in));
      ++kept;
    }
  };
  core::Planes image(tests::kWidth, tests::kHeight);
  tests::renderSequence(world, seeing(), hooks, 1, image);
  EXPECT_GT(kept, tests::kPixels);
}

}  // namespace
