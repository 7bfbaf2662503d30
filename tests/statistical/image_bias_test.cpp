// Images of 64x48 after 32 frames, independent sequences of a scene with occlusion, still (256) and moving (1,024):
// every pixel by z-tests on the sequences' means (Sidak), and the whole light by its interval, which lies inside +-1 %.
// Constant weights must fail both.
//
// Why more in motion: where a reservoir holds a hidden sample its pixel is black. With probability 0.05 that happens to
// 13 of 256 sequences, or to one, once in 10^4 pixels; a normal approximation then sees 6 standard errors of too much
// light in a pixel whose next 256 sequences make up for it. Of 1,024, fifty are black, and the approximation holds.
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

constexpr int kWide = 64, kHigh = 48, kFrames = 32, kStill = 256, kMoving = 1024;
constexpr double kSignificance = 1e-6, kBound = 0.01;

RestirParameters wide(Mis mis, bool visibility = false) {
  RestirParameters p;
  p.mis = mis, p.targetVisibility = visibility;
  p.spatial = tests::farAndAroundCorners();
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
Verdict verdictOf(const char* name, const World& world, const RestirParameters& p, const tests::Estimate& truth,
                  int sequences) {
  const auto c = tests::compare(tests::estimate(world, p, sequences), truth);
  const Verdict v{c.ratio - c.detectable, c.ratio + c.detectable, c.worst};
  std::printf("%-22s ratio in %.4f .. %.4f, worst pixel %.2f of %.2f\n", name, v.low, v.high, v.worst,
              core::sidakBound(kWide * kHigh, kSignificance));
  std::fflush(stdout);
  return v;
}

void expectUnbiased(const char* name, const World& world, const RestirParameters& p, const tests::Estimate& truth,
                    int sequences) {
  const Verdict v = verdictOf(name, world, p, truth, sequences);
  EXPECT_GT(v.low, 1 - kBound);
  EXPECT_LT(v.high, 1 + kBound);
  EXPECT_LT(v.low, 1);
  EXPECT_GT(v.high, 1);
  EXPECT_LT(v.worst, core::sidakBound(kWide * kHigh, kSignificance));
}

TEST(ImageBias, StillImagesAreUnbiasedInEveryPixel) {
  const World world(tests::makeWorld({}, true), kFrames, kWide, kHigh);
  const auto truth = tests::reference(world, 64, 256);
  expectUnbiased("still, balance", world, wide(Mis::balance), truth, kStill);
  expectUnbiased("still, pairwise", world, wide(Mis::pairwise), truth, kStill);
  expectUnbiased("still, balance, V", world, wide(Mis::balance, true), truth, kStill);
  const Verdict v = verdictOf("still, constant", world, wide(Mis::constant), truth, kStill);
  EXPECT_LT(v.high, 1 - kBound);
  EXPECT_GT(v.worst, core::sidakBound(kWide * kHigh, kSignificance));
}

TEST(ImageBias, MovingImagesAreUnbiasedInEveryPixel) {
  const World world(tests::makeWorld(slowly(), true), kFrames, kWide, kHigh);
  const auto truth = tests::reference(world, 64, 256);
  expectUnbiased("moving, balance", world, wide(Mis::balance), truth, kMoving);
  expectUnbiased("moving, pairwise", world, wide(Mis::pairwise), truth, kMoving);
  expectUnbiased("moving, balance, V", world, wide(Mis::balance, true), truth, kMoving);
  const Verdict v = verdictOf("moving, constant", world, wide(Mis::constant), truth, kStill);
  EXPECT_LT(v.high, 1 - kBound);
  EXPECT_GT(v.worst, core::sidakBound(kWide * kHigh, kSignificance));
}

}  // namespace
