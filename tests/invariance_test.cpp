// What must not change the light: a lamp cut in two, lights in another order, a turned scene; radiance times a power of
// two changes no other bit. And densities of two measures must not be mixed. The smallest bias of a frame's light that
// is detected half of the time is 2.5 %, in invariance_test_thorough 1 %, and a lamp brighter by 5 % is caught.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/restir_worlds.h"

namespace {

using core::vec3;
using restir::RestirParameters;
using tests::Motion;
using tests::World;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kFrames = 5, kSequences = 768;

RestirParameters wide() {
  RestirParameters p;
  p.spatial = tests::farAndAroundCorners();
  return p;
}

Motion ofLight() {
  Motion m;
  m.light = vec3(0.1f, 0, 0.05f);
  return m;
}
core::Scene worldScene() { return tests::makeWorld(ofLight(), true); }

/// The light of other, seeds of its own, is that of the world.
tests::Comparison comparisonWith(core::Scene other) {
  const World a(worldScene(), kFrames), b(std::move(other), kFrames);
  return tests::compare(tests::estimate(b, wide(), kSequences, {}, 100'000), tests::estimate(a, wide(), kSequences));
}
void expectSameLight(core::Scene other) {
  const auto c = comparisonWith(std::move(other));
  EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.worst, core::sidakBound(tests::kPixels, 1e-6));
  EXPECT_LT(c.detectable, tests::detectableBias(0.025));
}

/// Cuts the quad of a mesh in two along its second side.
void cutLamp(core::Scene& scene, int mesh) {
  auto p = scene.meshes[mesh].positions;
  const vec3 left = 0.5f * (p[0] + p[3]), right = 0.5f * (p[1] + p[2]);
  core::Mesh upper = scene.meshes[mesh];
  upper.positions = {left, right, p[2], p[3]};
  scene.meshes[mesh].positions = {p[0], p[1], right, left};
  scene.meshes.push_back(upper);
  const auto whole = std::find_if(scene.instances.begin(), scene.instances.end(),
                                  [&](const core::Instance& i) { return i.mesh == mesh; });
  const int node = whole->node;
  scene.instances.push_back({static_cast<int>(scene.meshes.size()) - 1, node});
}

TEST(Invariance, ALampCutInTwoGivesTheSameLight) {
  core::Scene scene = worldScene();
  cutLamp(scene, 2), cutLamp(scene, 4);
  ASSERT_EQ(World(scene, 1).moment(0).lights->size(), World(worldScene(), 1).moment(0).lights->size() + 4);
  expectSameLight(scene);
}

TEST(Invariance, LightsInAnotherOrderGiveTheSameLight) {
  core::Scene scene = worldScene();
  std::reverse(scene.instances.begin(), scene.instances.end());
  expectSameLight(scene);
}

TEST(Invariance, ATurnedSceneGivesTheSameLight) {
  core::Scene scene = worldScene();
  const core::quat turn = glm::angleAxis(0.7f, normalize(vec3(1, 2, -1)));
  for (core::Node& node : scene.nodes) {
    node.rotation = turn * node.rotation;
    node.translation = turn * node.translation;
    for (core::vec4& value : node.translationTrack.values) value = core::vec4(turn * vec3(value), 0);
  }
  expectSameLight(scene);
}

TEST(Invariance, ABrighterLampIsCaught) {
  core::Scene scene = worldScene();
  for (core::Material& m : scene.materials) m.emission *= 1.05f;
  for (core::PunctualLight& light : scene.punctual) light.intensity *= 1.05f;
  EXPECT_GT(comparisonWith(scene).z, kLargestZ);
}

TEST(Invariance, RadianceTimesAPowerOfTwoIsThatInEveryBit) {
  for (restir::Mis mis : {restir::Mis::contribution, restir::Mis::balance, restir::Mis::pairwise})
    for (bool visibility : {false, true})
      for (float factor : {0.25f, 8.0f}) {
        core::Scene scaled = worldScene();
        for (core::Material& m : scaled.materials) m.emission *= factor;
        for (core::PunctualLight& light : scaled.punctual) light.intensity *= factor;
        RestirParameters p = wide();
        p.mis = mis, p.targetVisibility = visibility;
        core::Planes plain(tests::kWidth, tests::kHeight), bright(tests::kWidth, tests::kHeight);
        tests::renderSequence(World(worldScene(), kFrames), p, {}, 1, plain);
        tests::renderSequence(World(scaled, kFrames), p, {}, 1, bright);
        for (int i = 0; i < tests::kPixels; ++i) ASSERT_EQ(factor * plain.view().at(i), bright.view().at(i));
      }
}

/// Sum over pixels of the unshadowed light by a light sample and a BSDF sample; converted: the BSDF's density per solid
/// angle becomes one in the light's measure before it joins the other's.
double unshadowed(const core::Moment& now, std::uint32_t image, bool converted) {
  return tests::unshadowedSum(now, image, [&](const auto& target, const auto& surface, auto& rng, auto& builder) {
    const auto add = [&](const core::LightSample& y) {
      const core::Incident in = target.incident(y);
      if (!(core::maxComponent(in.flux()) > 0)) return;
      const double bsdf = double{target.bsdf().value(in.direction).pdf} * (converted ? in.geometry : 1.0f);
      builder.add(y, target(y), target(y) / (now.lights->pdf(y) + bsdf), rng);
    };
    add(now.lights->sample(rng));
    const core::BsdfSample s = target.bsdf().sample(rng.uniform3());
    const vec3 origin = core::offsetOrigin(surface.position, surface.geometricNormal);
    if (s.pdf > 0) restir::ThroughOccluders()(*now.tracer, *now.lights, origin, s.direction, add);
  });
}

TEST(Invariance, DensitiesOfTwoMeasuresMustNotBeMixed) {
  const World world(tests::makeWorld(), 1);
  const core::Moment now = world.moment(0);
  core::RunningMoments right, mixed, truth;
  const auto images = static_cast<std::uint32_t>(1500 * tests::thoroughness());
  for (std::uint32_t i = 0; i < images; ++i) {
    right.add(unshadowed(now, i, true));
    mixed.add(unshadowed(now, 100'000 + i, false));
  }
  // Light samples alone, of the same unshadowed light.
  for (std::uint32_t i = 0; i < images; ++i) {
    double sum = 0;
    for (std::uint32_t q = 0; q < tests::kPixels; ++q) {
      const core::Surface& surface = now.surfaces.at(q);
      if (!surface.hit()) continue;
      const restir::Target<core::LightFeatures{false, false}> target(surface, now.cameraPosition, *now.lights);
      core::Rng rng(1, core::Pass::other, q, i);
      for (int k = 0; k < 8; ++k) {
        const core::LightSample y = now.lights->sample(rng);
        sum += target(y) / (8.0 * now.lights->pdf(y));
      }
    }
    truth.add(sum);
  }
  EXPECT_LT(std::abs(tests::zOf(right, truth)), kLargestZ) << right.mean() / truth.mean();
  const auto chance = [&](const auto& m) { return kLargestZ * std::sqrt(m.meanVariance() + truth.meanVariance()); };
  EXPECT_LT(chance(right), tests::detectableBias(0.02) * truth.mean());
  EXPECT_GT(std::abs(mixed.mean() - truth.mean()), 0.01 * truth.mean() + chance(mixed)) << mixed.mean() / truth.mean();
}

}  // namespace
