// What n pays for: n spatial reuses and n shadow rays a pixel (one for each sample with all shaded), none where n = 0;
// and one shadow ray, whatever n, for temporal reuse alone. The pass itself is compiled here once more, with what it
// calls counted.
#include <gtest/gtest.h>

#include <atomic>

#include "restir/direct.h"
#include "restir/kernel.h"
#include "restir/visibility.h"
#include "tests/restir_worlds.h"

namespace restir {

struct Counted {
  std::atomic<int> reuses{0}, merged{0}, rays{0};  ///< merged: reservoirs, the pixel's own included
} counted;

Neighbours countedNeighbours(const core::Moment& now, core::ivec2 pixel, const SpatialParameters& p, core::Rng& rng) {
  const Neighbours found = chooseNeighbours(now, pixel, p, rng);
  ++counted.reuses, counted.merged += 1 + found.count;
  return found;
}

bool countedRay(const core::Tracer& tracer, const Surface& surface, const Incident& in) {
  ++counted.rays;
  return visible(tracer, surface, in);
}

void countedShading(const RestirParameters& parameters, const Frame& frame, RestirState& state,
                    PlanesView<float> radiance);

}  // namespace restir

#define chooseNeighbours countedNeighbours
#define visible countedRay
#define reuseSpatiallyAndShade countedShading
#define shadeCheckSamples countedCheckSamples
#include "restir/shade.cpp"
#undef chooseNeighbours
#undef visible
#undef reuseSpatiallyAndShade
#undef shadeCheckSamples

namespace {

using restir::RestirParameters;
using restir::Reuse;
using restir::Shaded;

constexpr int kFrames = 3;

/// One floor, wider than the view, under one lamp above the camera: every reservoir shines on every pixel.
core::Scene openWorld() {
  core::Scene scene = tests::makeWorld();
  scene.meshes.clear(), scene.instances.clear();
  tests::addQuad(scene, tests::matte(), {-9, 0, 9}, {18, 0, 0}, {0, 0, -18});
  tests::addQuad(scene, tests::emitter({8, 6, 2}), {-1, 6, -1}, {2, 0, 0}, {0, 0, 2});
  return scene;
}

struct Counts {
  int reuses, merged, rays;
};

/// Of the last frame; samples: n of every pixel in every frame.
Counts countsOf(const RestirParameters& p, const core::Image<float>& samples) {
  static const tests::World world(openWorld(), kFrames);
  restir::RestirState state(tests::kWidth, tests::kHeight);
  core::Planes image(tests::kWidth, tests::kHeight);
  for (int f = 0; f < kFrames; ++f) {
    const restir::Frame frame = world.frame(f, samples, 1);
    restir::drawCandidates(p, frame, state);
    restir::reuseTemporally(p, frame, state);
    restir::counted.reuses = restir::counted.merged = restir::counted.rays = 0;
    restir::countedShading(p, frame, state, image);
  }
  return {restir::counted.reuses, restir::counted.merged, restir::counted.rays};
}
Counts countsOf(const RestirParameters& p, float n) {
  return countsOf(p, core::Image<float>(tests::kWidth, tests::kHeight, n));
}

RestirParameters with(Reuse reuse, Shaded shaded = Shaded::chosen) {
  RestirParameters p;
  p.reuse = reuse, p.shaded = shaded;
  return p;
}

TEST(ShadowRays, SpatialReuseTakesNOfEverything) {
  for (Reuse reuse : {Reuse::spatial, Reuse::both})
    for (int n : {1, 2, 8, 0}) {
      const Counts c = countsOf(with(reuse), static_cast<float>(n));
      EXPECT_EQ(c.reuses, n * tests::kPixels) << n;
      EXPECT_EQ(c.rays, n * tests::kPixels) << n;
    }
}

TEST(ShadowRays, AllShadedTakesOneForEverySample) {
  for (int n : {1, 2, 8, 0}) {
    const Counts c = countsOf(with(Reuse::both, Shaded::all), static_cast<float>(n));
    EXPECT_EQ(c.reuses, n * tests::kPixels) << n;
    EXPECT_EQ(c.rays, c.merged) << n;
    EXPECT_GE(c.merged, 3 * n * tests::kPixels) << n;
  }
}

TEST(ShadowRays, EveryPixelTakesItsOwnCount) {
  core::Image<float> samples(tests::kWidth, tests::kHeight);
  int sum = 0;
  for (int i = 0; i < tests::kPixels; ++i) {
    const int n = std::array{1, 2, 8, 0, 0}[static_cast<std::size_t>(i % 5)];
    samples.data()[i] = static_cast<float>(n), sum += n;
  }
  const Counts c = countsOf(with(Reuse::both), samples);
  EXPECT_EQ(c.reuses, sum);
  // In every frame the same pixels have none: their reservoirs are empty, but never chosen.
  EXPECT_EQ(c.rays, sum);
}

TEST(ShadowRays, TemporalReuseAloneShadesOneResultWhateverN) {
  for (int n : {1, 2, 8, 0}) {
    const Counts c = countsOf(with(Reuse::temporal), static_cast<float>(n));
    EXPECT_EQ(c.reuses, 0) << n;
    EXPECT_EQ(c.rays, n > 0 ? tests::kPixels : 0) << n;
  }
}

TEST(ShadowRays, WithoutReuseNResultsTakeNRays) {
  for (int n : {1, 2, 8, 0}) EXPECT_EQ(countsOf(with(Reuse::none), static_cast<float>(n)).rays, n * tests::kPixels);
}

TEST(ShadowRays, TargetsThatIncludeVisibilityNeedNoneForShading) {
  RestirParameters p = with(Reuse::both);
  p.targetVisibility = true;
  for (int n : {1, 8}) {
    const Counts c = countsOf(p, static_cast<float>(n));
    EXPECT_EQ(c.reuses, n * tests::kPixels) << n;
    EXPECT_EQ(c.rays, 0) << n;
  }
}

}  // namespace
