// Environment maps: directions and points of the map, sampling and density, the light among others, what the camera
// sees of it. Files are in environment_file_test.cpp, light on surfaces in environment_restir_test.cpp.
#include "core/environment.h"

#include <gtest/gtest.h>

#include "core/check.h"
#include "core/gbuffer.h"
#include "core/lights.h"
#include "core/statistics.h"
#include "tests/chi_square.h"
#include "tests/environment_maps.h"
#include "tests/restir_worlds.h"

namespace {

using core::Environment;
using core::vec2;
using core::vec3;
constexpr double kSignificance = 1e-6;

core::Rng rngOf(std::uint32_t stream) { return {1, core::Pass::lab, stream, 0}; }

vec2 draw(const Environment& map, core::Rng& rng) {
  const std::uint32_t a = rng.bits(), b = rng.bits(), c = rng.bits();
  return map.sample({a, b}, {c, rng.bits()});
}

TEST(EnvironmentMap, HasTheConventionThatItStates) {
  const auto expectAt = [](vec2 uv, vec3 direction) {
    EXPECT_LT(length(Environment::directionOf(uv) - direction), 1e-6) << uv.x << " " << uv.y;
    const vec2 back = Environment::uvOf(3.0f * direction);
    EXPECT_NEAR(back.x, uv.x, 1e-6);
    EXPECT_NEAR(back.y, uv.y, 1e-6);
  };
  expectAt({0.5f, 0.5f}, {1, 0, 0});
  expectAt({0.25f, 0.5f}, {0, 0, -1});
  expectAt({0.75f, 0.5f}, {0, 0, 1});
  expectAt({0.5f, 0.25f}, normalize(vec3(1, 1, 0)));
  EXPECT_LT(length(Environment::directionOf({0, 0.5f}) - vec3(-1, 0, 0)), 1e-6);
  EXPECT_LT(length(Environment::directionOf({0.3f, 1e-6f}) - vec3(0, 1, 0)), 1e-5);
  EXPECT_LT(length(Environment::directionOf({0.3f, 1 - 1e-6f}) - vec3(0, -1, 0)), 1e-5);
}

TEST(EnvironmentMap, DirectionsComeBackAlsoNearThePoles) {
  core::Rng rng = rngOf(1);
  const auto expectBack = [](const vec3& direction) {
    const vec2 uv = Environment::uvOf(direction);
    ASSERT_TRUE(uv.x >= 0 && uv.x < 1 && uv.y > 0 && uv.y < 1) << uv.x << " " << uv.y;
    EXPECT_LT(length(Environment::directionOf(uv) - normalize(direction)), 1e-6);
    EXPECT_GT(Environment::solidAngle(uv), 0);
  };
  for (int i = 0; i < 20000; ++i) {
    const vec3 d = 2.0f * rng.uniform3() - 1.0f;
    if (dot(d, d) > 1e-4f) expectBack(d);
    for (const float tilt : {1e-2f, 1e-4f, 1e-6f, 1e-9f, 0.0f}) {
      expectBack({tilt * d.x, 1, tilt * d.z});
      expectBack({tilt * d.x, -1, tilt * d.z});
      expectBack({-1, tilt * d.y, tilt * d.z});  // the seam
    }
  }
  for (int i = 0; i < 20000; ++i) {
    const vec2 uv(rng.uniform(), 0.001f + 0.998f * rng.uniform());
    const vec2 back = Environment::uvOf(Environment::directionOf(uv));
    const float across = std::abs(back.x - uv.x);
    EXPECT_LT(std::min(across, 1 - across) * std::sin(core::kPi * uv.y), 1e-6);
    EXPECT_NEAR(back.y, uv.y, 1e-6);
  }
}

TEST(EnvironmentMap, SolidAngleIsTheJacobian) {
  constexpr float kStep = 1e-3f;
  for (const float v : {0.01f, 0.1f, 0.37f, 0.5f, 0.8f, 0.99f})
    for (const float u : {0.1f, 0.45f, 0.9f}) {
      const auto at = [&](float du, float dv) { return Environment::directionOf({u + du * kStep, v + dv * kStep}); };
      const float area = length(cross(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1))) / (4 * kStep * kStep);
      EXPECT_NEAR(Environment::solidAngle({u, v}) / area, 1, 2e-3) << u << " " << v;
    }
}

/// Sizes that are no powers of two, black texels and rows, and a contrast of 1e5.
core::Planes hardMap(int width = 37, int height = 19) {
  core::Planes map = tests::noiseMap(width, height, 1e-5f);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (y == 3 || (x + y) % 3 == 0) map.view().store(x, y, vec3(0));
  return map;
}

vec2 middleOf(int x, int y, const Environment& map) {
  return {(static_cast<float>(x) + 0.5f) / static_cast<float>(map.width()),
          (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height())};
}

TEST(EnvironmentMap, DensityIntegratesToOneAndIsPositiveWhereLightIs) {
  const auto map = tests::environmentFrom(hardMap());
  double sum = 0;
  for (int y = 0; y < map->height(); ++y)
    for (int x = 0; x < map->width(); ++x) {
      const vec2 uv = middleOf(x, y, *map);
      EXPECT_EQ(map->pdf(uv) > 0, core::luminance(map->radiance(uv)) > 0) << x << " " << y;
      sum += double{map->pdf(uv)} / map->width() / map->height();
    }
  EXPECT_NEAR(sum, 1, 1e-6);
}

/// Draws, counted by texel.
std::vector<double> countTexels(const Environment& map, int draws) {
  std::vector<double> counts(map.texels().size());
  core::Rng rng = rngOf(2);
  for (int i = 0; i < draws; ++i) {
    const vec2 uv = draw(map, rng);
    const auto x = static_cast<std::size_t>(uv.x * static_cast<float>(map.width()));
    ++counts[static_cast<std::size_t>(uv.y * static_cast<float>(map.height())) * map.width() + x];
  }
  return counts;
}

TEST(EnvironmentMap, SamplesFollowTheirDensity) {
  constexpr int kDraws = 1'000'000;
  const auto map = tests::environmentFrom(hardMap());
  std::vector<double> expected, flat;  // flat: without sin(theta)
  double sumOfFlat = 0;
  for (int y = 0; y < map->height(); ++y)
    for (int x = 0; x < map->width(); ++x) {
      const vec2 uv = middleOf(x, y, *map);
      expected.push_back(kDraws * double{map->pdf(uv)} / static_cast<double>(map->texels().size()));
      flat.push_back(core::luminance(map->radiance(uv)));
      sumOfFlat += flat.back();
    }
  for (double& f : flat) f *= kDraws / sumOfFlat;
  const std::vector<double> counts = countTexels(*map, kDraws);
  EXPECT_GT(tests::chiSquareP(counts, expected), kSignificance);
  EXPECT_LT(tests::chiSquareP(counts, flat), kSignificance);  // control
}

TEST(EnvironmentMap, SamplesAreUniformInsideATexel) {
  constexpr int kDraws = 500'000, kCells = 8;
  const auto map = tests::environmentFrom(tests::noiseMap(5, 3, 0.1f));
  std::vector<double> counts(kCells * kCells), bent(counts.size());
  std::vector<double> expected(counts.size(), double{kDraws} / (kCells * kCells));
  core::Rng rng = rngOf(3);
  for (int i = 0; i < kDraws; ++i) {
    const vec2 uv = draw(*map, rng);
    const auto cell = [&](float u, int size) {
      return static_cast<int>(u * static_cast<float>(size * kCells)) % kCells;
    };
    const int x = cell(uv.x, 5), y = cell(uv.y, 3);
    ++counts[static_cast<std::size_t>(y * kCells + x)];
    ++bent[static_cast<std::size_t>(y * kCells + (i % 50 == 0 ? 0 : x))];
  }
  EXPECT_GT(tests::chiSquareP(counts, expected), kSignificance);
  EXPECT_LT(tests::chiSquareP(bent, expected), kSignificance);  // control: 2 % of the points moved
}

TEST(EnvironmentMap, SamplesNeverLeaveTheirTexelHoweverLargeTheMap) {
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(999, 501), std::pair(131071, 5), std::pair(6, 131072)}) {
    core::Planes image(width, height);
    for (int y = 0; y < height; ++y)
      for (int x = (y % 2); x < width; x += 2) image.view().store(x, y, vec3(1));
    const Environment map(image.view(), "test map");
    core::Rng rng = rngOf(4);
    for (int i = 0; i < 20000; ++i) {
      std::array<std::uint32_t, 2> bits{rng.bits(), rng.bits()};
      if (i % 4 == 0) bits[0] = i % 8 ? 0xffffffffu : 0;
      if (i % 4 == 1) bits[1] = i % 8 == 1 ? 0xffffffffu : 0;
      const std::uint32_t keep = rng.bits();
      const vec2 uv = map.sample(bits, {keep, rng.bits()});
      ASSERT_TRUE(uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y < 1);
      ASSERT_GT(map.radiance(uv).r, 0) << uv.x << " " << uv.y << " of " << width << "x" << height;
      ASSERT_GT(map.pdf(uv), 0);
    }
  }
}

TEST(EnvironmentMap, SamplesGiveTheLightOfAllDirections) {
  // L / density x d omega / d(u, v), over the map: the integral of L. The sun is one texel of 1e5 times the sky.
  const auto map = tests::environmentFrom(tests::skyMap(64, 32, 20, 9, 1e5f));
  core::RunningMoments moments, uniform;
  core::Rng rng = rngOf(5);
  for (int i = 0; i < 200'000; ++i) {
    const vec2 uv = draw(*map, rng), anywhere = rng.uniform2();
    moments.add(double{core::luminance(map->radiance(uv))} * Environment::solidAngle(uv) / map->pdf(uv));
    uniform.add(double{core::luminance(map->radiance(anywhere))} * Environment::solidAngle(anywhere));
  }
  double expected = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      expected += core::luminance(map->texels()[static_cast<std::size_t>(y * 64 + x)]) * 2 * core::kPi / 64 *
                  (std::cos(core::kPi * y / 32) - std::cos(core::kPi * (y + 1) / 32));
  EXPECT_NEAR(4 * core::kPi * map->meanLuminance() / expected, 1, 1e-5);
  const double error = std::sqrt(moments.meanVariance());
  EXPECT_LT(std::abs(moments.mean() - expected), core::sidakBound(1, kSignificance) * error + 1e-5 * expected);
  EXPECT_LT(error, 1e-3 * expected);
  EXPECT_GT(std::sqrt(uniform.meanVariance()), 0.05 * expected);  // control: without the tables there is noise
}

TEST(EnvironmentMap, ABlackMapGivesNoLight) {
  const auto map = tests::environmentFrom(core::Planes(4, 2));
  EXPECT_TRUE(map->black());
  EXPECT_EQ(map->pdf({0.3f, 0.3f}), 0);
  EXPECT_EQ(map->radiance({0.3f, 0.3f}), vec3(0));
  core::Scene scene;
  tests::addQuad(scene, tests::matte(), {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
  scene.environment = map;
  const core::Lights lights(scene, core::poseAt(scene, 0));
  EXPECT_EQ(lights.size(), 1u);
  EXPECT_TRUE(lights.empty());
  EXPECT_EQ(lights.pdf(lights.environmentAt({0, 1, 0})), 0);
}

TEST(EnvironmentMap, ValuesThatAreNoRadianceAreErrors) {
  for (const float bad : {-core::kInfinity, core::kInfinity, std::nanf("1")}) {
    core::Planes image(4, 2, 1.0f);
    image.view().plane[1](2, 1) = bad;
    try {
      const Environment map(image.view(), "bad.exr");
      ADD_FAILURE() << bad;
    } catch (const core::Error& e) {
      EXPECT_EQ(std::string(e.what()).find("bad.exr: pixel (2, 1) is not finite"), 0u) << e.what();
    }
  }
  EXPECT_THROW(Environment(core::Planes(4, 2, 1e38f).view(), "bright", 1e9f), core::Error);
  EXPECT_THROW(Environment(core::Planes().view(), "empty"), core::Error);
  EXPECT_NO_THROW(Environment(core::Planes(4, 2, 3e38f).view(), "brightest"));
  EXPECT_FALSE(Environment(core::Planes(4, 2, 1e-45f).view(), "faintest").black());
}

TEST(EnvironmentMap, NegativeValuesCountAsBlackAndAreReported) {
  core::Planes image(4, 2, 1.0f);
  image.view().store(2, 1, vec3(3, -0.5f, 2));
  image.view().store(0, 0, vec3(-1));
  const auto map = tests::environmentFrom(image);
  EXPECT_EQ(map->negatives(), 2);
  EXPECT_EQ(map->texels()[6], vec3(3, 0, 2));
  EXPECT_EQ(map->pdf({0.1f, 0.1f}), 0);
  EXPECT_EQ(tests::environmentFrom(core::Planes(4, 2, -0.0f))->negatives(), 0);
}

/// The floor and lamps of the tests, with a directional light if asked for.
core::Scene litScene(float mapRadiance, bool lamps, float sun = 0) {
  core::Scene scene = lamps ? tests::makeWorld({}, true) : core::Scene{};
  if (!lamps) tests::addQuad(scene, tests::matte(), {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
  if (sun > 0) {
    scene.nodes.emplace_back();
    core::PunctualLight light;
    light.type = core::PunctualLight::Type::directional;
    light.intensity = vec3(sun), light.node = static_cast<int>(scene.nodes.size()) - 1;
    scene.punctual.push_back(light);
  }
  scene.environment = tests::environmentFrom(core::Planes(8, 4, mapRadiance));
  return scene;
}

TEST(EnvironmentLight, IsTheLastLightWithABoundedShare) {
  for (const auto& [radiance, lamps, share] :
       {std::tuple(1.0f, false, 1.0), std::tuple(1e-6f, true, 1.0 / 9), std::tuple(1e6f, true, 0.5)}) {
    const core::Scene scene = litScene(radiance, lamps);
    const core::Lights lights(scene, core::poseAt(scene, 0));
    const std::uint32_t last = lights.size() - 1;
    EXPECT_TRUE(lights.isEnvironment(last) && lights.isHittable(last) && !lights.isArea(last));
    EXPECT_EQ(lights.isEnvironment(0), last == 0);
    EXPECT_NEAR(lights.probability(last), share, 1e-5);
    EXPECT_TRUE(lights.features().punctual);
    EXPECT_NEAR(lights.pdf({last, {0.3f, 0.5f}}), share * scene.environment->pdf({0.3f, 0.5f}), 1e-5);
  }
}

TEST(EnvironmentLight, SharesWithDirectionalLightsByIrradiance) {
  const core::Scene scene = litScene(1, false, 8 * core::kPi);  // over all directions the map gives 4 pi
  const core::Lights lights(scene, core::poseAt(scene, 0));
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_NEAR(lights.probability(0), 2.0 / 3, 1e-5);
  EXPECT_NEAR(lights.probability(1), 1.0 / 3, 1e-5);
}

TEST(EnvironmentLight, DrawnPointsShineFromTheirDirection) {
  core::Scene scene = litScene(1, true);
  scene.environment = tests::environmentFrom(hardMap());
  const core::Lights lights(scene, core::poseAt(scene, 0));
  core::Rng rng = rngOf(6);
  int drawn = 0;
  for (int i = 0; i < 2000; ++i) {
    const core::LightSample y = lights.sample(rng);
    if (!lights.isEnvironment(y.light)) continue;
    ++drawn;
    const core::Incident in = lights.incident<core::LightFeatures{}>(y, vec3(5, 6, 7));
    EXPECT_EQ(in.distance, core::kInfinity);
    EXPECT_EQ(in.direction, Environment::directionOf(y.uv));
    EXPECT_EQ(in.radiance, scene.environment->radiance(y.uv));
    EXPECT_EQ(in.geometry, Environment::solidAngle(y.uv));
    EXPECT_NEAR(lights.pdf(y), lights.probability(y.light) * scene.environment->pdf(y.uv), 1e-5 * lights.pdf(y));
  }
  EXPECT_GT(drawn, 200);
  const core::LightSample met = lights.environmentAt({0.3f, 2, -1});
  EXPECT_EQ(met.light, lights.size() - 1);
  EXPECT_EQ(met.uv, Environment::uvOf({0.3f, 2, -1}));
}

TEST(EnvironmentLight, IsWhatTheCameraSeesBehindEverything) {
  core::Scene scene = tests::makeWorld();
  scene.environment = tests::environmentFrom(tests::noiseMap(64, 32, 0.01f));
  const core::Pose pose = core::poseAt(scene, 0);
  const core::Tracer tracer(core::buildMeshTrees(scene), scene, pose);
  core::GBuffer gbuffer(tests::kWidth, tests::kHeight);
  core::traceGBuffer(scene, pose, pose, tracer, {}, gbuffer);
  const core::Projection projection(pose.camera, tests::kWidth, tests::kHeight);
  int background = 0;
  for (int y = 0; y < tests::kHeight; ++y)
    for (int x = 0; x < tests::kWidth; ++x) {
      if (gbuffer.surfaces(x, y).hit()) continue;
      ++background;
      const vec3 direction = projection.direction({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      EXPECT_EQ(gbuffer.emission.view().load(x, y), scene.environment->radiance(Environment::uvOf(direction)));
      EXPECT_EQ(gbuffer.guide.id(x, y), core::kNoId);
    }
  EXPECT_GT(background, 20);
}

}  // namespace
