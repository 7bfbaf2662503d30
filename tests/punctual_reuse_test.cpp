// A spot that swings and a sun that turns, beside a point light and lamps: reuse keeps their light. Significance 1e-6;
// the smallest bias of a frame's light that is detected half of the time is 2 %, and each of the two gives more than
// 5 % of it.
#include <gtest/gtest.h>

#include "tests/restir_worlds.h"

namespace {

using core::PunctualLight;
using core::vec3;
using restir::Mis;
using restir::RestirParameters;
using restir::Reuse;
using tests::World;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kFrames = 6;

/// A node that turns about the z axis, from one angle in the first frame to another in the last; -z of it points down
/// at 0.
int addTurningNode(core::Scene& scene, vec3 place, float from, float to) {
  const auto turned = [](float angle) {
    const core::quat q = glm::angleAxis(angle, vec3(0, 0, 1)) * glm::angleAxis(-0.5f * core::kPi, vec3(1, 0, 0));
    return core::vec4(q.x, q.y, q.z, q.w);
  };
  core::Node node;
  node.translation = place;
  node.rotationTrack.times = {0, (kFrames - 1) / 30.0f};
  node.rotationTrack.values = {turned(from), turned(to)};
  scene.nodes.push_back(node);
  return static_cast<int>(scene.nodes.size()) - 1;
}

/// The world with a moving lamp; spot, sun: their intensities, 0 = without.
core::Scene worldOf(float spot, float sun) {
  tests::Motion motion;
  motion.light = vec3(0.1f, 0, 0.03f);
  core::Scene scene = tests::makeWorld(motion, true);
  if (spot > 0) {
    const int node = addTurningNode(scene, {-1.2f, 1.8f, 0.8f}, -0.9f, 0.5f);
    scene.punctual.push_back({PunctualLight::Type::spot, vec3(spot), 0.15f, 0.4f, node});
  }
  if (sun > 0) {
    const int node = addTurningNode(scene, {}, -0.8f, 0.4f);
    scene.punctual.push_back({PunctualLight::Type::directional, vec3(sun), 0, 0, node});
  }
  return scene;
}
constexpr float kSpot = 16, kSun = 1;

RestirParameters with(Reuse reuse, Mis mis = Mis::balance) {
  RestirParameters p;
  p.reuse = reuse, p.mis = mis;
  p.spatial = tests::farAndAroundCorners();
  return p;
}

tests::Comparison comparisonOf(const RestirParameters& p, int sequences) {
  static const World world(worldOf(kSpot, kSun), kFrames);
  static const tests::Estimate truth = tests::reference(world, 16, 512);
  return tests::compare(tests::estimate(world, p, sequences, {tests::patchwork(kFrames), {}}), truth);
}
void expectUnbiased(const RestirParameters& p) {
  const auto c = comparisonOf(p, 768);
  EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
}

double lightOf(float spot, float sun) {
  return tests::reference(World(worldOf(spot, sun), kFrames), 4, 256).total.mean();
}

TEST(PunctualReuse, SpotAndSunGiveMuchOfTheLight) {
  const double all = lightOf(kSpot, kSun);
  EXPECT_LT(lightOf(0, kSun), 0.95 * all);
  EXPECT_LT(lightOf(kSpot, 0), 0.95 * all);
}

TEST(PunctualReuse, SwingingSpotAndTurningSunLeaveItUnbiased) { expectUnbiased(with(Reuse::both)); }

TEST(PunctualReuse, SwingingSpotAndTurningSunLeaveItUnbiasedWithVisibilityInTheTarget) {
  RestirParameters p = with(Reuse::both);
  p.targetVisibility = true;
  expectUnbiased(p);
}

/// Control: what the spot reaches now it did not reach before.
TEST(PunctualReuse, ASwingingSpotNeedsTheConeThatWas) {
  RestirParameters p = with(Reuse::temporal);
  p.temporal.previousLights = false;
  const auto c = comparisonOf(p, 256);
  EXPECT_GT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.ratio, 0.98);
}

TEST(PunctualReuse, ConstantWeightsAreBiased) {
  const auto c = comparisonOf(with(Reuse::both, Mis::constant), 256);
  EXPECT_GT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.ratio, 0.98);
}

}  // namespace
