// Animation at an instant: interpolation modes, hierarchy, what moves, flicker, and the camera.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "core/check.h"
#include "core/scene.h"

namespace core {
namespace {

void expectNear(const vec4& a, const vec4& b, float tolerance = 1e-5f) {
  EXPECT_LT(glm::distance(a, b), tolerance) << "(" << a.x << ", " << a.y << ", " << a.z << ", " << a.w << ") and ("
                                            << b.x << ", " << b.y << ", " << b.z << ", " << b.w << ")";
}

vec4 x(float value) { return {value, 0, 0, 0}; }

vec4 turnAboutZ(float angle) { return {0, 0, std::sin(angle / 2), std::cos(angle / 2)}; }

TEST(Track, LinearInterpolatesAndClampsToItsEnds) {
  const Track track{{1, 2, 4}, {x(10), x(20), x(0)}, Interpolation::linear};
  expectNear(evaluate(track, -5, false), x(10));
  expectNear(evaluate(track, 1, false), x(10));
  expectNear(evaluate(track, 1.25f, false), x(12.5f));
  expectNear(evaluate(track, 2, false), x(20));
  expectNear(evaluate(track, 3.5f, false), x(5));
  expectNear(evaluate(track, 99, false), x(0));
  expectNear(evaluate(track, std::numeric_limits<float>::quiet_NaN(), false), x(10));
}

TEST(Track, StepHoldsUntilTheNextKey) {
  const Track track{{0, 1, 2}, {x(1), x(2), x(3)}, Interpolation::step};
  expectNear(evaluate(track, 0.999f, false), x(1));
  expectNear(evaluate(track, 1, false), x(2));
  expectNear(evaluate(track, 2, false), x(3));
}

TEST(Track, OneKeyIsAConstant) {
  for (const Interpolation mode : {Interpolation::linear, Interpolation::step})
    expectNear(evaluate({{3}, {x(7)}, mode}, 5, false), x(7));
  expectNear(evaluate({{3}, {x(1), x(7), x(1)}, Interpolation::cubic}, 5, false), x(7));
}

/// A Hermite spline with the tangents of a cubic polynomial is that polynomial; tangents are per second.
TEST(Track, CubicSplineReproducesACubic) {
  const auto value = [](float t) { return t * t * t - 2 * t * t + 3; };
  const auto slope = [](float t) { return 3 * t * t - 4 * t; };
  Track track{{0, 0.5f, 3}, {}, Interpolation::cubic};
  for (const float t : track.times) track.values.insert(track.values.end(), {x(slope(t)), x(value(t)), x(slope(t))});
  for (const float t : {0.0f, 0.1f, 0.5f, 0.7f, 2.0f, 2.9f, 3.0f}) expectNear(evaluate(track, t, false), x(value(t)));
}

TEST(Track, QuaternionsTurnEvenlyAndTheShortWay) {
  const Track quarter{{0, 1}, {turnAboutZ(0), turnAboutZ(kPi / 2)}, Interpolation::linear};
  expectNear(evaluate(quarter, 1.0f / 3, true), turnAboutZ(kPi / 6));
  const Track negated{{0, 1}, {turnAboutZ(0), -turnAboutZ(kPi / 2)}, Interpolation::linear};
  const vec4 q = evaluate(negated, 1.0f / 3, true);
  expectNear(q * (q.w < 0 ? -1.0f : 1.0f), turnAboutZ(kPi / 6));
}

TEST(Track, QuaternionsAreUnitInEveryMode) {
  const Track cubic{{0, 1}, {vec4(0), turnAboutZ(0), vec4(0), vec4(0), turnAboutZ(2), vec4(0)}, Interpolation::cubic};
  EXPECT_NEAR(glm::length(evaluate(cubic, 0.5f, true)), 1, 1e-6f);
  EXPECT_LT(glm::length(evaluate(cubic, 0.5f, false)), 0.95f);  // the spline itself is not
  expectNear(evaluate({{0}, {vec4(0)}, Interpolation::linear}, 0, true), {0, 0, 0, 1});
}

/// A parent that moves along x, a child turned and scaled below it, a sibling that rests.
Scene family() {
  Scene scene;
  scene.name = "family";
  scene.nodes.resize(3);
  scene.nodes[0].translationTrack = {{0, 2}, {x(0), x(4)}, Interpolation::linear};
  scene.nodes[1].parent = 0;
  scene.nodes[1].rotation = glm::angleAxis(kPi / 2, vec3(0, 0, 1));
  scene.nodes[1].scale = vec3(2);
  scene.nodes[2].hasMatrix = true;
  scene.nodes[2].matrix = glm::translate(mat4(1), vec3(7, 8, 9));
  return scene;
}

TEST(Pose, ComposesTheHierarchy) {
  const Pose pose = poseAt(family(), 1);
  EXPECT_EQ(pose.time, 1);
  expectNear(pose.nodeToWorld[1] * vec4(1, 0, 0, 1), {2, 2, 0, 1});  // scaled, turned, then carried along
  expectNear(pose.nodeToWorld[2] * vec4(0, 0, 0, 1), {7, 8, 9, 1});
}

TEST(Pose, FlickerScalesEmission) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].flicker = 0;
  scene.flickers.push_back({{0, 1}, {x(2), x(-2)}, Interpolation::linear});
  EXPECT_EQ(poseAt(scene, 0.25).materialEmission, (std::vector<float>{1, 1}));
  EXPECT_EQ(poseAt(scene, 1).materialEmission, (std::vector<float>{1, 0})) << "light is never negative";
}

/// One triangle in node `node`, emitting or not.
void addTriangle(Scene& scene, int node, float emission = 0) {
  Material material;
  material.emission = vec3(emission);
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.material = static_cast<int>(scene.materials.size()) - 1;
  scene.meshes.push_back(mesh);
  scene.instances.push_back({static_cast<int>(scene.meshes.size()) - 1, node});
}

TEST(Motion, ReachesTheChildrenOfWhatMoves) {
  EXPECT_EQ(motionOf(family()).nodeMoves, (std::vector<bool>{true, true, false}));
}

TEST(Motion, TracksThatAgreeWithThemselvesDoNotMove) {
  Scene scene = family();
  scene.nodes[0].translationTrack.values = {x(4), x(4)};
  EXPECT_EQ(motionOf(scene).nodeMoves, (std::vector<bool>{false, false, false}));
}

TEST(Motion, TellsInstancesAndLightsApart) {
  Scene scene = family();
  addTriangle(scene, 2, 1);
  EXPECT_FALSE(motionOf(scene).instances || motionOf(scene).lights);
  addTriangle(scene, 1);
  EXPECT_TRUE(motionOf(scene).instances);
  EXPECT_FALSE(motionOf(scene).lights);
  addTriangle(scene, 1, 1);
  EXPECT_TRUE(motionOf(scene).lights);
}

TEST(Motion, FlickeringAndPunctualLightsCount) {
  Scene scene = family();
  addTriangle(scene, 2, 1);
  scene.materials[0].flicker = 0;
  scene.flickers.push_back({{0, 1}, {x(1), x(2)}, Interpolation::linear});
  EXPECT_TRUE(motionOf(scene).lights);
  scene.flickers[0].values[1] = x(1);
  EXPECT_FALSE(motionOf(scene).lights);
  scene.punctual.resize(1);
  scene.punctual[0].node = 1;
  EXPECT_TRUE(motionOf(scene).lights);
}

TEST(PoseCamera, IsItsNodes) {
  Scene scene = family();
  scene.cameras = {{"still", 0.5f, 2}, {"carried", 0.8f, 0}};
  EXPECT_EQ(poseAt(scene, 1, 0).camera.position, vec3(7, 8, 9));
  EXPECT_EQ(poseAt(scene, 1, 1).camera.position, vec3(2, 0, 0));
  EXPECT_FLOAT_EQ(poseAt(scene, 1, 1).camera.tanHalfFovY, std::tan(0.4f));
  EXPECT_THROW(poseAt(scene, 1, 2), UsageError);
  EXPECT_THROW(poseAt(scene, 1, -1), UsageError);
}

TEST(PoseCamera, WithoutDirectionsIsRefused) {
  Scene scene = family();
  scene.cameras = {{"flat", 0.5f, 1}};
  scene.nodes[1].scale = vec3(0);
  EXPECT_THROW(poseAt(scene, 0), Error);
}

TEST(PoseCamera, IsMadeToFrameTheBoundsAtTimeZero) {
  Scene scene = family();
  addTriangle(scene, 1);
  addTriangle(scene, 2);
  const Pose start = poseAt(scene, 0), later = poseAt(scene, 2);
  EXPECT_EQ(start.camera.position, later.camera.position) << "the camera rests while the scene moves";
  const Projection projection(start.camera, 100, 100);
  for (const Instance& instance : scene.instances)
    for (const vec3& p : scene.meshes[instance.mesh].positions) {
      const vec3 world = vec3(start.nodeToWorld[instance.node] * vec4(p, 1));
      const vec2 seen = projection.project(world);
      EXPECT_GT(projection.depth(world), 0);
      EXPECT_TRUE(seen.x > 0 && seen.x < 100 && seen.y > 0 && seen.y < 100) << seen.x << ", " << seen.y;
    }
  EXPECT_LT(start.camera.forward.y, 0) << "slightly from above";
  EXPECT_LT(start.camera.forward.z, -0.9f);
}

TEST(PoseCamera, OfAnEmptySceneIsFinite) {
  const Camera camera = poseAt(Scene{}, 0).camera;
  EXPECT_TRUE(isFinite(camera.position) && isFinite(camera.forward));
  EXPECT_GT(camera.position.z, 0);
}

}  // namespace
}  // namespace core
