// Images of 64x48 after 32 frames, 256 independent sequences of a scene with occlusion, still and moving: every pixel
// by z-tests on the sequences' means (Sidak), and the whole light by its interval, which lies inside +-1 %. Constant
// weights must fail both.
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

constexpr int kWide = 64, kHigh = 48, kFrames = 32, kSequences = 256;
constexpr double kSignificance = 1e-6, kBound = 0.01;

RestirParameters wide(Mis mis, bool visibility = false) {
  RestirParameters p;
  p.mis = mis, p.targetVisibility = visibility;
  p.spatial.radius = 0.25f, p.spatial.normalCosine = -1, p.spatial.planeDistance = 100;
  return p;
}

/// Slow enough that lamps and walls stay in view for 32 frames.
Motion slowly() {
  Motion m;
  m.light = vec3(0.04f, 0, 0.01f), m.occluder = vec3(0.01f, 0, 0.006f), m.camera = vec3(0.01f, 0.004f, 0.006f);
  return m;
}

struct Verdict {
  double low, high;  ///< of the ratio of light, at 1 - 1e-6
  double worst;      ///< largest |z| of a pixel
};
Verdict verdictOf(const char* name, const World& world, const RestirParameters& p, const tests::Estimate& truth) {
  const auto c = tests::compare(tests::estimate(world, p, kSequences), truth);
  const Verdict v{c.ratio - c.detectable, c.ratio + c.detectable, c.worst};
  std::printf("%-22s ratio in %.4f .. %.4f, worst pixel %.2f of %.2f\n", name, v.low, v.high, v.worst,
              core::sidakBound(kWide * kHigh, kSignificance));
  std::fflush(stdout);
  return v;
}

void expectUnbiased(const char* name, const World& world, const RestirParameters& p, const tests::Estimate& truth) {
  const Verdict v = verdictOf(name, world, p, truth);
  EXPECT_GT(v.low, 1 - kBound);
  EXPECT_LT(v.high, 1 + kBound);
  EXPECT_LT(v.low, 1);
  EXPECT_GT(v.high, 1);
  EXPECT_LT(v.worst, core::sidakBound(kWide * kHigh, kSignificance));
}

TEST(ImageBias, StillImagesAreUnbiasedInEveryPixel) {
  const World world(tests::makeWorld({}, true), kFrames, kWide, kHigh);
  const auto truth = tests::reference(world, 64, 256);
  expectUnbiased("still, balance", world, wide(Mis::balance), truth);
  expectUnbiased("still, pairwise", world, wide(Mis::pairwise), truth);
  expectUnbiased("still, balance, V", world, wide(Mis::balance, true), truth);
  const Verdict v = verdictOf("still, constant", world, wide(Mis::constant), truth);
  EXPECT_LT(v.high, 1 - kBound);
  EXPECT_GT(v.worst, core::sidakBound(kWide * kHigh, kSignificance));
}

TEST(ImageBias, MovingImagesAreUnbiasedInEveryPixel) {
  const World world(tests::makeWorld(slowly(), true), kFrames, kWide, kHigh);
  const auto truth = tests::reference(world, 64, 256);
  expectUnbiased("moving, balance", world, wide(Mis::balance), truth);
  expectUnbiased("moving, pairwise", world, wide(Mis::pairwise), truth);
  expectUnbiased("moving, balance, V", world, wide(Mis::balance, true), truth);
}

}  // namespace
