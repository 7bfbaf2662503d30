// Light of an environment map on surfaces: against quadrature, against the same map as a sphere of emissive triangles,
// and by ReSTIR against light sampling without reuse. Every z-test has significance 1e-6 and a control that it catches;
// biases of 2 % are detected half of the time, in environment_restir_test_thorough of 1 %.
#include <gtest/gtest.h>

#include "core/material.h"
#include "tests/environment_maps.h"
#include "tests/restir_worlds.h"

namespace {

using core::Environment;
using core::vec2;
using core::vec3;
using restir::Mis;
using restir::RestirParameters;
using restir::Reuse;
using tests::World;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kFrames = 6;

/// A floor alone, seen from above, under a map; one frame.
World floorUnder(const core::Material& floor, const core::Planes& map) {
  core::Scene scene;
  tests::addQuad(scene, floor, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
  core::Node eye;
  eye.rotation = glm::angleAxis(-0.5f * core::kPi, vec3(1, 0, 0));
  eye.translation = {0.3f, 3, 0.2f};
  scene.nodes.push_back(eye);
  scene.cameras.push_back({"eye", 0.9f, static_cast<int>(scene.nodes.size()) - 1});
  scene.environment = tests::environmentFrom(map);
  return World(std::move(scene), 1);
}

/// Reflected light by the midpoint rule over the map, `steps` points a texel each way.
double quadrature(const core::Surface& s, const vec3& viewer, const core::Planes& image, int steps) {
  const core::Bsdf bsdf(s, normalize(viewer - s.position));
  const auto map = tests::environmentFrom(image);
  const int width = steps * image.width(), height = steps * image.height();
  double sum = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const vec2 uv((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                    (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
      sum += core::luminance(bsdf.evaluate(Environment::directionOf(uv)) * map->radiance(uv)) *
             Environment::solidAngle(uv);
    }
  return sum / width / height;
}

/// Every fifth pixel of a floor under a map against quadrature, by a test that would notice 5 %.
void expectQuadrature(const core::Material& floor, const core::Planes& map, int steps) {
  const World world = floorUnder(floor, map);
  const core::Moment now = world.moment(0);
  int tested = 0;
  for (std::uint32_t i = 0; i < tests::kPixels; i += 5) {
    const core::Surface& s = now.surfaces.at(i);
    if (!s.hit()) continue;
    core::RunningMoments moments;
    for (std::uint64_t stream = 0; stream < 64; ++stream)
      moments.add(core::luminance(restir::meanDirect(now, s, 512, stream, i)));
    const double expected = quadrature(s, now.cameraPosition, map, steps), error = std::sqrt(moments.meanVariance());
    EXPECT_LT(std::abs(moments.mean() - expected), kLargestZ * error + 1e-3 * expected) << i;
    EXPECT_GT(std::abs(moments.mean() - 1.05 * expected), kLargestZ * error + 1e-3 * expected) << i;
    ++tested;
  }
  EXPECT_GT(tested, 20);
}

TEST(EnvironmentDirect, IsItsQuadrature) {
  for (const float roughness : {0.3f, 1.0f})
    expectQuadrature(tests::matte(roughness, 0.5f), tests::noiseMap(24, 12, 0.01f), 12);
}

TEST(EnvironmentDirect, ASunOfOneTexelIsItsQuadrature) {
  expectQuadrature(tests::matte(), tests::skyMap(64, 32, 20, 6, 1e5f), 6);
}

TEST(EnvironmentDirect, WhiteSurfacesInAWhiteFurnaceReturnTheirAlbedo) {
  core::Material white = tests::matte();
  white.baseColor = vec3(1);
  expectQuadrature(white, core::Planes(16, 8, 1.0f), 20);
  // The material itself is nearly white: rough GGX without multiple scattering keeps 93 %.
  const World world = floorUnder(white, core::Planes(16, 8, 1.0f));
  const core::Surface& s = world.moment(0).surfaces.at(tests::kPixels / 2);
  EXPECT_NEAR(quadrature(s, world.moment(0).cameraPosition, core::Planes(16, 8, 1.0f), 40), 0.928, 0.002);
}

/// What is not compared: pixels that see no surface of the scene.
std::function<bool(int, int)> hitsOf(const World& world) {
  return [&world](int x, int y) {
    const core::Surface& s = world.moment(world.frames() - 1).surfaces(x, y);
    return s.hit() && length(s.position) < 100;
  };
}

/// The world of the other tests under a map. lamps: beside its own lights, else these are mere walls.
core::Scene worldUnder(const core::Planes& map, bool lamps, const tests::Motion& motion = {}) {
  core::Scene scene = tests::makeWorld(motion, lamps);
  if (!lamps)
    for (core::Material& m : scene.materials) m.emission = vec3(0);
  scene.environment = tests::environmentFrom(map);
  return scene;
}

/// The same map as a sphere of triangles that face inward: every texel is kParts x kParts quads of its own material.
/// Parallax and chords move texel borders by less than 5e-4 rad (a texel is 0.5 rad).
core::Scene tessellated(core::Scene scene) {
  constexpr int kParts = 12;
  constexpr float kRadius = 1e4f;  // the scene's is 3
  const Environment& map = *scene.environment;
  const int width = map.width() * kParts, height = map.height() * kParts;
  for (int row = 0; row < map.height(); ++row)
    for (int column = 0; column < map.width(); ++column) {
      core::Mesh mesh;
      for (int y = 0; y <= kParts; ++y)
        for (int x = 0; x <= kParts; ++x)
          mesh.positions.push_back(
              kRadius * Environment::directionOf({static_cast<float>(column * kParts + x) / static_cast<float>(width),
                                                  static_cast<float>(row * kParts + y) / static_cast<float>(height)}));
      for (std::uint32_t y = 0; y < kParts; ++y)
        for (std::uint32_t x = 0; x < kParts; ++x) {
          const std::uint32_t a = y * (kParts + 1) + x, d = a + kParts + 1;
          mesh.triangles.push_back({a, d, d + 1});
          mesh.triangles.push_back({a, d + 1, a + 1});
        }
      mesh.material = static_cast<int>(scene.materials.size());
      scene.materials.push_back(tests::emitter(map.texels()[static_cast<std::size_t>(row * map.width() + column)]));
      scene.meshes.push_back(std::move(mesh));
      scene.nodes.emplace_back();
      scene.instances.push_back({static_cast<int>(scene.meshes.size()) - 1, static_cast<int>(scene.nodes.size()) - 1});
    }
  scene.environment = nullptr;
  return scene;
}

RestirParameters wide(Mis mis = Mis::balance, bool visibility = false) {
  RestirParameters p;
  p.mis = mis, p.targetVisibility = visibility;
  p.spatial = tests::farAndAroundCorners();
  return p;
}

/// Light of two worlds of one geometry together. Triangles of that size leave lamps no share of the samples, so each is
/// rendered alone.
tests::Estimate referenceOfSum(const World& a, const World& b, int images, int samples,
                               const std::function<bool(int, int)>& compared) {
  const core::Moment ofA = a.moment(0), ofB = b.moment(0);
  tests::Estimate result;
  core::Planes image(tests::kWidth, tests::kHeight);
  images *= tests::thoroughness();
  for (int i = 0; i < images; ++i) {
    core::forEachPixel(tests::kWidth, tests::kHeight, [&](int x, int y) {
      const auto pixel = static_cast<std::uint32_t>(y * tests::kWidth + x);
      image.view().store(x, y,
                         restir::meanDirect(ofA, ofA.surfaces(x, y), samples, 1000 + i, pixel) +
                             restir::meanDirect(ofB, ofB.surfaces(x, y), samples, 2000 + i, pixel));
    });
    tests::blank(compared, image);
    result.add(image);
  }
  return result;
}

const core::Planes& blocks() {
  static const core::Planes map = tests::noiseMap(12, 6, 0.02f, 3);
  return map;
}

/// An image's light is the tessellated map's and nothing else's: all of it, and of every pixel. detects: the relative
/// bias of all of it that is noticed half of the time, in the thorough run less.
void expectTessellated(const char* name, const tests::Estimate& image, const tests::Estimate& turned,
                       const tests::Estimate& triangles, double detects) {
  const auto same = tests::compare(image, triangles), other = tests::compare(turned, triangles);
  const double worst = core::sidakBound(tests::kPixels, 1e-6);
  std::printf("%-16s ratio %.5f, z %.2f, worst pixel %.2f of %.2f, detects %.4f; turned: worst pixel %.1f\n", name,
              same.ratio, same.z, same.worst, worst, same.detectable, other.worst);
  EXPECT_LT(std::abs(same.z), kLargestZ);
  EXPECT_LT(same.worst, worst);
  EXPECT_LT(same.detectable, tests::detectableBias(detects));
  EXPECT_GT(other.worst, worst);  // control: one texel to the side
}

TEST(EnvironmentDirect, IsTheSameMapTessellated) {
  const World triangles(tessellated(worldUnder(blocks(), false)), 1), image(worldUnder(blocks(), false), 1),
      turned(worldUnder(tests::turnedMap(blocks(), 1), false), 1);
  const auto compared = hitsOf(image);
  expectTessellated("direct", tests::reference(image, 32, 256, compared), tests::reference(turned, 32, 256, compared),
                    tests::reference(triangles, 32, 256, compared), 0.005);
}

TEST(EnvironmentRestir, IsTheSameMapTessellatedBesideLamps) {
  core::Scene lampsAlone = worldUnder(blocks(), true);
  lampsAlone.environment = nullptr;
  const World triangles(tessellated(worldUnder(blocks(), false)), 1), lamps(std::move(lampsAlone), 1),
      image(worldUnder(blocks(), true), kFrames), turned(worldUnder(tests::turnedMap(blocks(), 1), true), kFrames);
  tests::Hooks hooks;
  hooks.compared = hitsOf(image);
  expectTessellated("ReSTIR", tests::estimate(image, wide(), 768, hooks), tests::estimate(turned, wide(), 768, hooks),
                    referenceOfSum(triangles, lamps, 32, 256, hooks.compared), 0.02);
}

/// The frame's light by many sequences over that of light sampling.
tests::Comparison measured(const char* name, const World& world, const RestirParameters& p, int sequences) {
  const auto c = tests::compare(tests::estimate(world, p, sequences), tests::reference(world, 16, 512));
  std::printf("%-24s ratio %.4f, z %5.2f, detects %.4f\n", name, c.ratio, c.z, c.detectable);
  return c;
}
void expectUnbiased(const char* name, const World& world, const RestirParameters& p, int sequences = 768) {
  const auto c = measured(name, world, p, sequences);
  EXPECT_LT(std::abs(c.z), kLargestZ) << name << " ratio " << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02)) << name;
}

/// A roof with two steep sides: what one side sees of the sky, the other does not.
core::Scene roofUnder(const core::Planes& map) {
  core::Scene scene = worldUnder(map, false);
  tests::addQuad(scene, tests::matte(), {0.6f, 0, 1.5f}, {0.6f, 1.2f, 0}, {0, 0, -3});
  tests::addQuad(scene, tests::matte(), {1.8f, 0, -1.5f}, {-0.6f, 1.2f, 0}, {0, 0, 3});
  return scene;
}

core::Planes sky() { return tests::skyMap(64, 32, 40, 8, 500); }

TEST(EnvironmentRestir, EveryBalancedReuseIsUnbiased) {
  const World world(worldUnder(sky(), true), kFrames);
  for (const Reuse reuse : {Reuse::none, Reuse::temporal, Reuse::spatial, Reuse::both}) {
    RestirParameters p = wide();
    p.reuse = reuse;
    expectUnbiased("balance", world, p);
  }
}

TEST(EnvironmentRestir, OtherUnbiasedWeightsAreUnbiasedAndConstantOnesAreCaught) {
  const World world(roofUnder(sky()), kFrames);
  expectUnbiased("balance, no lamps", world, wide());
  expectUnbiased("balance, visibility", world, wide(Mis::balance, true));
  expectUnbiased("pairwise", world, wide(Mis::pairwise));
  expectUnbiased("contribution", world, wide(Mis::contribution), 1024);
  const auto c = measured("constant", world, wide(Mis::constant), 768);
  EXPECT_TRUE(tests::isBiased(c)) << c.ratio;  // control
}

TEST(EnvironmentRestir, MovingCamerasAndOccludersLeaveItUnbiased) {
  tests::Motion camera, all;
  camera.camera = vec3(0.05f, 0.02f, 0.03f);
  all.camera = camera.camera, all.light = vec3(0.2f, 0, 0.05f), all.occluder = vec3(0.05f, 0, 0.03f);
  expectUnbiased("moving camera", World(worldUnder(sky(), true, camera), kFrames), wide());
  expectUnbiased("everything moves", World(worldUnder(sky(), true, all), kFrames), wide());
}

TEST(EnvironmentRestir, CandidatesOfOneKindAloneAreUnbiasedToo) {
  const World world(worldUnder(blocks(), false), kFrames);
  for (const auto& [light, bsdf] : {std::pair(4, 0), std::pair(0, 4)}) {
    RestirParameters p = wide();
    p.candidates.lightSamples = light, p.candidates.bsdfSamples = bsdf;
    expectUnbiased(light > 0 ? "light samples alone" : "BSDF samples alone", world, p, 1024);
  }
}

}  // namespace
