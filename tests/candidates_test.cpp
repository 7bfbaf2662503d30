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
