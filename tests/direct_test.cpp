// Light sampling without reuse, the reference of everything, against closed forms and quadrature.
#include "restir/direct.h"

#include <gtest/gtest.h>

#include "core/material.h"
#include "tests/restir_worlds.h"

namespace {

using core::vec3;
const double kLargestZ = core::sidakBound(1, 1e-6);

/// A floor under whatever add() puts above it, seen from above; one frame.
tests::World floorUnder(const core::Material& floor, const std::function<void(core::Scene&)>& add) {
  core::Scene scene;
  tests::addQuad(scene, floor, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
  add(scene);
  core::Node eye;
  eye.rotation = glm::angleAxis(-0.5f * core::kPi, vec3(1, 0, 0));
  eye.translation = {0, 3, 0};
  scene.nodes.push_back(eye);
  scene.cameras.push_back({"eye", 0.9f, static_cast<int>(scene.nodes.size()) - 1});
  return tests::World(std::move(scene), 1);
}

void addPoint(core::Scene& scene, const vec3& position, float intensity) {
  scene.nodes.emplace_back();
  scene.nodes.back().translation = position;
  core::PunctualLight light;
  light.intensity = vec3(intensity), light.node = static_cast<int>(scene.nodes.size()) - 1;
  scene.punctual.push_back(light);
}

TEST(Direct, PointLightIsExactInOneSample) {
  const vec3 lamp(0.5f, 2, 0.3f);
  const auto world = floorUnder(tests::matte(), [&](core::Scene& s) { addPoint(s, lamp, 7); });
  const core::Moment now = world.moment(0);
  for (std::uint32_t i = 0; i < tests::kPixels; ++i) {
    const core::Surface& s = now.surfaces.at(i);
    if (!s.hit()) continue;
    const vec3 offset = lamp - s.position;
    const core::Bsdf bsdf(s, normalize(now.cameraPosition - s.position));
    const vec3 expected = bsdf.evaluate(normalize(offset)) * 7.0f / dot(offset, offset);
    EXPECT_NEAR(core::luminance(restir::meanDirect(now, s, 1, 5, i)), core::luminance(expected), 1e-5);
  }
}

TEST(Direct, WhatIsHiddenIsBlack) {
  const auto world = floorUnder(tests::matte(), [](core::Scene& s) {
    addPoint(s, {0, -1, 0}, 7);  // below the floor
    tests::addQuad(s, tests::emitter(vec3(5)), {1, -1, 1}, {0, 0, -1}, {-1, 0, 0});
  });
  const core::Moment now = world.moment(0);
  for (std::uint32_t i = 0; i < tests::kPixels; ++i)
    EXPECT_EQ(restir::meanDirect(now, now.surfaces.at(i), 16, 5, i), vec3(0));
}

/// Light from a quad, faces along cross(u, v), by the midpoint rule.
double quadrature(const core::Surface& s, const vec3& viewer, const vec3& corner, const vec3& u, const vec3& v,
                  double radiance) {
  constexpr int kSteps = 200;
  const core::Bsdf bsdf(s, normalize(viewer - s.position));
  const vec3 normalArea = cross(u, v);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const vec3 offset = corner + (i + 0.5f) / kSteps * u + (j + 0.5f) / kSteps * v - s.position;
      const double d2 = dot(offset, offset), facing = -dot(normalArea, offset) / std::sqrt(d2);
      if (facing > 0) sum += core::luminance(bsdf.evaluate(normalize(offset))) * facing / d2;
    }
  return radiance * sum / (kSteps * kSteps);
}

TEST(Direct, AreaLightIsItsQuadrature) {
  const vec3 corner(-1.9f, 0.4f, -0.5f), u(0.9f, 0.2f, 0), v(0, 0, 1);  // faces down and right
  for (float roughness : {0.3f, 1.0f}) {
    const auto world = floorUnder(tests::matte(roughness, 0.5f),
                                  [&](core::Scene& s) { tests::addQuad(s, tests::emitter(vec3(4)), corner, u, v); });
    const core::Moment now = world.moment(0);
    int tested = 0;
    for (std::uint32_t i = 0; i < tests::kPixels; i += 5) {
      const core::Surface& s = now.surfaces.at(i);
      if (!s.hit() || s.position.y > 1e-3f) continue;
      core::RunningMoments moments;
      for (std::uint64_t stream = 0; stream < 64; ++stream)
        moments.add(core::luminance(restir::meanDirect(now, s, 512, stream, i)));
      const double expected = quadrature(s, now.cameraPosition, corner, u, v, 4),
                   error = std::sqrt(moments.meanVariance());
      EXPECT_LT(std::abs(moments.mean() - expected), 5.5 * error + 1e-4 * expected) << i << " roughness " << roughness;
      EXPECT_LT(error, 0.01 * expected);  // it would notice 5 %:
      EXPECT_GT(std::abs(moments.mean() - 1.05 * expected), kLargestZ * error);
      ++tested;
    }
    EXPECT_GT(tested, 20);
  }
}

}  // namespace
