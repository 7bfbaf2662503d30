// Candidates: what BSDF samples find, through occluders and in fractions, keeps the light that a target sees.
// Significance 1e-6; intervals are narrower than 1 %.
#include "restir/candidates.h"

#include <gtest/gtest.h>

#include <bit>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::CandidateParameters;
using restir::ThroughOccluders;
using tests::World;

/// A BSDF ray that stops at the first thing it hits.
struct FirstHit {
  template <class Body>
  void operator()(const core::Tracer& tracer, const core::Lights& lights, const vec3& origin, const vec3& direction,
                  Body&& body) const {
    const core::Hit hit = tracer.intersect(origin, direction);
    const std::uint32_t light = hit.hit() ? lights.lightOf(hit.instance, hit.primitive) : core::kNoLight;
    if (light != core::kNoLight) body(core::LightSample{light, hit.barycentric});
  }
};

/// Sum over pixels of the unshadowed light that one batch of candidates finds.
template <class Walk>
double unshadowedSum(const core::Moment& now, const CandidateParameters& parameters, std::uint32_t image) {
  return tests::unshadowedSum(now, image, [&](const auto& target, const auto& surface, auto& rng, auto& builder) {
    restir::Candidates<core::LightFeatures{false, false}, Walk>(target, surface, *now.tracer, parameters, 1)
        .addBatch(rng, builder);
  });
}

/// Interval at 1e-6 of the light that these candidates find, over light samples alone.
template <class Walk>
core::Interval unshadowedRatio(const CandidateParameters& parameters = {1, 16}) {
  const World world(tests::makeWorld(), 1);
  const core::Moment now = world.moment(0);
  std::vector<double> ratios(1500);
  tbb::parallel_for(std::size_t{0}, ratios.size(), [&](std::size_t i) {
    const auto image = static_cast<std::uint32_t>(i);
    ratios[i] = unshadowedSum<Walk>(now, parameters, image) / unshadowedSum<Walk>(now, {128, 0}, 1'000'000 + image);
  });
  return core::meanInterval(ratios, 1 - 1e-6);
}

TEST(Candidates, RaysThroughOccludersKeepTheEnergyOfHiddenLight) {
  const core::Interval through = unshadowedRatio<ThroughOccluders>();
  EXPECT_LT(through.low, 1);
  EXPECT_GT(through.high, 1);
  EXPECT_LT(through.halfWidth(), 0.01);
}

TEST(Candidates, RaysThatStopAtTheFirstHitLoseIt) { EXPECT_LT(unshadowedRatio<FirstHit>().high, 0.99); }

/// Loses three quarters of what BSDF samples find, chosen by the ray's direction.
struct Forgetful {
  template <class Body>
  void operator()(const core::Tracer& tracer, const core::Lights& lights, const vec3& origin, const vec3& direction,
                  Body&& body) const {
    if (core::mixBits(std::bit_cast<std::uint32_t>(direction.x)) % 4 == 0)
      ThroughOccluders()(tracer, lights, origin, direction, body);
  }
};

TEST(Candidates, FractionsOfBsdfSamplesKeepTheEnergy) {
  for (const double bsdf : {0.25, 1.5, 5.75}) {
    const core::Interval ratio = unshadowedRatio<ThroughOccluders>({4, bsdf});
    EXPECT_LT(ratio.low, 1) << bsdf;
    EXPECT_GT(ratio.high, 1) << bsdf;
    EXPECT_LT(ratio.halfWidth(), 0.01) << bsdf;
  }
}

TEST(Candidates, FractionsThatAreCountedAsWholeLoseEnergy) { EXPECT_LT(unshadowedRatio<Forgetful>({4, 1}).high, 0.99); }

/// Sum over pixels of the unshadowed light that two batches find, tree samples among them.
double sumWithTree(const core::Moment& now, const core::LightChoice& tree, const CandidateParameters& parameters,
                   std::uint32_t image, bool joined) {
  return tests::unshadowedSum(now, image, [&](const auto& target, const auto& surface, auto& rng, auto& builder) {
    const restir::Candidates<core::LightFeatures{false, false}> candidates(target, surface, *now.tracer, parameters, 2,
                                                                           {}, &tree);
    if (joined) {
      builder = candidates.draw(
          [&](int i) { return core::Rng(2, core::Pass::lab, rng.bits(), image, static_cast<std::uint32_t>(i)); });
      return;
    }
    for (int i = 0; i < 2; ++i) candidates.addBatch(rng, builder), candidates.addTreeSamples(rng, builder);
  });
}

core::Interval ratioWithTree(const CandidateParameters& parameters, bool joined = true) {
  const World world(tests::makeWorld(), 1);
  const core::Moment now = world.moment(0);
  const core::LightChoice tree(*now.lights, core::LightSampler::tree);
  std::vector<double> ratios(1500);
  tbb::parallel_for(std::size_t{0}, ratios.size(), [&](std::size_t i) {
    const auto image = static_cast<std::uint32_t>(i);
    ratios[i] = sumWithTree(now, tree, parameters, image, joined) /
                unshadowedSum<ThroughOccluders>(now, {128, 0}, 1'000'000 + image);
  });
  return core::meanInterval(ratios, 1 - 1e-6);
}

CandidateParameters withTree(int light, double bsdf, int tree) {
  CandidateParameters p;
  p.lightSamples = light, p.bsdfSamples = bsdf, p.treeSamples = tree;
  return p;
}

TEST(Candidates, TreeSamplesKeepTheEnergy) {
  for (const CandidateParameters& p : {withTree(4, 1, 1), withTree(1, 0, 4), withTree(8, 0.25, 2)}) {
    const core::Interval ratio = ratioWithTree(p);
    EXPECT_LT(ratio.low, 1) << p.treeSamples;
    EXPECT_GT(ratio.high, 1) << p.treeSamples;
    EXPECT_LT(ratio.halfWidth(), 0.01) << p.treeSamples;
  }
}

TEST(Candidates, WhatTheTreeFindsTooIsNotCountedTwice) { EXPECT_GT(ratioWithTree(withTree(1, 0, 4), false).low, 1.1); }

/// A floor under many lamps far above it, all alike, and one of the same power close to the floor.
core::Scene lampsFarAndNear() {
  core::Scene scene = tests::makeWorld();
  scene.meshes.resize(2), scene.instances.resize(2);
  tests::addQuad(scene, tests::emitter(vec3(1)), {-1.5f, 0.2f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f});
  for (int i = 0; i < 200; ++i)
    tests::addQuad(scene, tests::emitter(vec3(1)), {-2 + 0.02f * static_cast<float>(i), 30, -0.1f}, {0.2f, 0, 0},
                   {0, 0, 0.2f});
  return scene;
}

TEST(Candidates, TreeSamplesFindTheLampNearby) {
  const World world(lampsFarAndNear(), 1);
  const core::Moment now = world.moment(0);
  const core::LightChoice tree(*now.lights, core::LightSampler::tree);
  const auto varianceWith = [&](const CandidateParameters& p) {
    core::RunningMoments sums;
    for (std::uint32_t image = 0; image < 400; ++image)
      sums.add(p.treeSamples > 0 ? sumWithTree(now, tree, p, image, true)
                                 : unshadowedSum<ThroughOccluders>(now, p, image));
    return sums.variance();
  };
  EXPECT_LT(varianceWith(withTree(8, 0, 1)), 0.2 * varianceWith(withTree(18, 0, 0)));
}

TEST(Candidates, RaysAreFewerWhereLightsOutgrowTheCache) {
  const CandidateParameters parameters{8, 2, 0.25};
  core::Scene scene = tests::makeWorld();
  const auto samplesFor = [&] { return bsdfSamplesFor(parameters, core::Lights(scene, core::poseAt(scene, 0))); };
  EXPECT_EQ(samplesFor(), 2);
  core::Mesh& lamp = scene.meshes[2];  // emits; its triangles again and again
  while (lamp.triangles.size() < restir::LightTiles::kManyLights) lamp.triangles.push_back(lamp.triangles[0]);
  EXPECT_EQ(samplesFor(), 0.5);
}

}  // namespace
