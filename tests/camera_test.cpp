// A projection and its directions are inverse to each other, with x right, y down and pixel centres at +0.5.
#include "core/camera.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace core {
namespace {

void expectNear(const vec3& a, const vec3& b, float tolerance = 1e-5f) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << "(" << a.x << ", " << a.y << ", " << a.z << ") and (" << b.x << ", " << b.y << ", " << b.z << ")";
}

Camera tilted() {
  const mat4 turn = glm::rotate(glm::translate(mat4(1), vec3(1, 2, 3)), 0.7f, glm::normalize(vec3(1, 2, -1)));
  return cameraFromMatrix(glm::scale(turn, vec3(2, 3, 4)), 0.9f);
}

TEST(Camera, IdentityLooksAlongMinusZ) {
  const Camera camera = cameraFromMatrix(mat4(1), kPi / 2);
  expectNear(camera.forward, {0, 0, -1});
  expectNear(camera.right, {1, 0, 0});
  expectNear(camera.up, {0, 1, 0});
  EXPECT_NEAR(camera.tanHalfFovY, 1, 1e-6f);
}

TEST(Camera, AxesAreOrthonormalWhateverTheNodesScale) {
  const Camera camera = tilted();
  for (const vec3& axis : {camera.right, camera.up, camera.forward}) EXPECT_NEAR(glm::length(axis), 1, 1e-6f);
  EXPECT_NEAR(dot(camera.right, camera.up), 0, 1e-6f);
  EXPECT_NEAR(dot(camera.right, camera.forward), 0, 1e-6f);
  expectNear(cross(camera.right, camera.up), -camera.forward);
  expectNear(camera.position, {1, 2, 3});
}

TEST(Projection, CentreOfTheImageLooksForward) {
  const Camera camera = tilted();
  expectNear(Projection(camera, 64, 48).direction({32, 24}), camera.forward);
}

TEST(Projection, YPointsDownAndYfovSpansTheHeight) {
  const Projection projection(cameraFromMatrix(mat4(1), kPi / 2), 200, 100);
  expectNear(projection.direction({100, 0}), {0, 1, -1});     // upper border
  expectNear(projection.direction({100, 100}), {0, -1, -1});  // lower border
  expectNear(projection.direction({200, 50}), {2, 0, -1});    // square pixels
  const vec2 upper = projection.project({0, 0.5f, -1}), right = projection.project({0.5f, 0, -1});
  EXPECT_NEAR(upper.y, 25, 1e-4f);
  EXPECT_NEAR(right.x, 125, 1e-4f);
}

TEST(Projection, ProjectInvertsDirection) {
  const Camera camera = tilted();
  const Projection projection(camera, 63, 41);
  for (const float depth : {0.01f, 1.0f, 300.0f})
    for (int y = -3; y < 45; y += 4)
      for (int x = -3; x < 66; x += 3) {
        const vec2 p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const vec3 world = camera.position + depth * projection.direction(p);
        EXPECT_LT(glm::distance(projection.project(world), p), depth < 0.1f ? 5e-3f : 2e-4f) << x << ", " << y;
        EXPECT_NEAR(projection.depth(world) / depth, 1, depth < 0.1f ? 1e-4f : 1e-5f);
      }
}

TEST(Projection, StepsAreOnePixel) {
  const Projection projection(tilted(), 63, 41);
  expectNear(projection.direction({8, 5}) - projection.direction({7, 5}), projection.stepX());
  expectNear(projection.direction({7, 6}) - projection.direction({7, 5}), projection.stepY());
  EXPECT_LT(projection.depth(tilted().position - tilted().forward), 0);
}

}  // namespace
}  // namespace core
