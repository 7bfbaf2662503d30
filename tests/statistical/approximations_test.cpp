// What the cheaper targets of restir.temporal cost: one switch off at a time, in a world made for it.
//
// Balance weights sum to 1 over whatever targets they are given, so a wrong target biases nothing by itself. It does
// where it claims that the history could have found a sample that it could not: then part of that sample's light is
// left to a history that lacks it. Lights that appear, surfaces that turn to a lamp, occluders that leave do that. A
// viewer hides no light from a surface, so this frame's costs noise at most.
//
// Significance 1e-6 a test; the smallest bias of a frame's light that is detected half of the time is 1 %. Control of
// the unbiased ones: the same worlds with a switch off; of the biased: with all on.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::RestirParameters;
using restir::TemporalParameters;
using tests::Motion;
using tests::World;

constexpr int kFrames = 6, kSequences = 3072;
const double kLargestZ = core::sidakBound(1, 1e-6);

RestirParameters temporal(bool visibility = false) {
  RestirParameters p;
  p.reuse = restir::Reuse::temporal, p.targetVisibility = visibility, p.candidates.bsdfSamples = 4;
  return p;
}

/// All on and this one off, over the reference.
struct Measured {
  tests::Comparison on, off;
};

Measured measure(const char* name, const World& world, bool TemporalParameters::*flag, bool visibility = false,
                 int sequences = kSequences) {
  const tests::Estimate truth = tests::reference(world, 32, 2048);
  RestirParameters p = temporal(visibility);
  Measured m;
  m.on = tests::compare(tests::estimate(world, p, sequences), truth);
  p.temporal.*flag = false;
  m.off = tests::compare(tests::estimate(world, p, sequences), truth);
  std::printf("%-17s on %.4f +- %.4f, off %.4f +- %.4f\n", name, m.on.ratio, m.on.detectable / kLargestZ * 1.96,
              m.off.ratio, m.off.detectable / kLargestZ * 1.96);
  return m;
}

void expectBiasOf(const Measured& m) {
  EXPECT_LT(std::abs(m.on.z), kLargestZ) << m.on.ratio;
  EXPECT_LT(m.on.detectable, 0.01);
  EXPECT_GT(std::abs(m.off.z), kLargestZ) << m.off.ratio;
  EXPECT_LT(m.off.ratio, 0.99);
}

/// The world with both halves of its floor turning, 8 degrees a frame, towards a low lamp that stands at its side: the
/// last turn brings it over the horizon.
core::Scene turningFloor() {
  core::Scene scene = tests::makeWorld();
  const auto turned = [](float degrees) {
    const core::quat q = glm::angleAxis(degrees * core::kPi / 180, vec3(0, 0, 1));
    return core::vec4(q.x, q.y, q.z, q.w);
  };
  for (int floor : {0, 1}) {
    scene.nodes[floor].rotationTrack.times = {0, (kFrames - 1) / 30.0f};
    scene.nodes[floor].rotationTrack.values = {turned(8.0f * kFrames - 6), turned(2)};
  }
  tests::addQuad(scene, tests::emitter(vec3(20)), {2.2f, 0.1f, -1}, {0, 0, 2}, {0, 0.5f, 0});
  return scene;
}

World risingLamp() {
  Motion motion;
  motion.light = vec3(0.05f, 0.4f, 0.05f), motion.lightStart = vec3(-0.2f, -1.9f, -0.2f);
  return World(tests::makeWorld(motion), kFrames);
}

World movingOccluder() {
  Motion motion;
  motion.occluder = vec3(0.2f, 0, 0.1f);
  return World(tests::makeWorld(motion), kFrames);
}

/// All of the floor is glossy, and the camera flies over it.
World movingCamera() {
  Motion motion;
  motion.camera = vec3(0.1f, 0.04f, -0.06f);
  core::Scene scene = tests::makeWorld(motion);
  for (int floor : {0, 1}) scene.materials[floor] = tests::matte(0.35f, 0.7f);
  return World(scene, kFrames);
}

TEST(Approximations, ASurfaceThatTurnsNeedsTheHorizonItHad) {
  expectBiasOf(measure("previousSurface", World(turningFloor(), kFrames), &TemporalParameters::previousSurface));
}

TEST(Approximations, ALightThatRisesNeedsThePlaceItHad) {
  expectBiasOf(measure("previousLights", risingLamp(), &TemporalParameters::previousLights));
}

TEST(Approximations, AnOccluderThatLeavesNeedsThePlaceItHad) {
  expectBiasOf(measure("previousGeometry", movingOccluder(), &TemporalParameters::previousGeometry, true));
}

TEST(Approximations, AViewerThatMovesChangesTheImageButNotItsMean) {
  const World world = movingCamera();
  const Measured m = measure("previousCamera", world, &TemporalParameters::previousCamera, false, 2 * kSequences);
  for (const tests::Comparison& c : {m.on, m.off}) {
    EXPECT_LT(std::abs(c.z), kLargestZ) << c.ratio;
    EXPECT_LT(c.detectable, 0.01);
    EXPECT_LT(c.worst, core::sidakBound(tests::kPixels, 1e-6));
  }
  RestirParameters p = temporal();
  core::Planes on(tests::kWidth, tests::kHeight), off(tests::kWidth, tests::kHeight);
  tests::renderSequence(world, p, {}, 1, on);
  p.temporal.previousCamera = false;
  tests::renderSequence(world, p, {}, 1, off);
  EXPECT_FALSE(tests::sameBits(on, off));
}

}  // namespace
