// Lights are drawn by power, shine from their front, and keep their index and density when they move.
#include "core/lights.h"

#include <gtest/gtest.h>

#include "core/check.h"
#include "tests/chi_square.h"

namespace {

using core::vec2;
using core::vec3;
constexpr core::LightFeatures kAll{};
constexpr double kSignificance = 1e-6;

core::Mesh triangle(int material, float size = 1) {
  core::Mesh mesh;
  mesh.positions = {vec3(0), vec3(size, 0, 0), vec3(0, size, 0)};  // faces +z
  mesh.uvs = {vec2(0, 0), vec2(1, 0), vec2(0, 1)};
  mesh.triangles = {{0, 1, 2}};
  mesh.material = material;
  return mesh;
}

/// One emissive triangle of the given size for every entry, each with an instance and node of its own.
core::Scene triangles(const std::vector<float>& sizes) {
  core::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emission = vec3(2, 2, 2);
  for (float size : sizes) {
    scene.meshes.push_back(triangle(0, size));
    scene.nodes.emplace_back();
    scene.instances.push_back({int(scene.meshes.size()) - 1, int(scene.nodes.size()) - 1});
  }
  return scene;
}

void addPunctual(core::Scene& scene, core::PunctualLight::Type type, vec3 intensity) {
  scene.nodes.emplace_back();
  core::PunctualLight light;
  light.type = type, light.intensity = intensity, light.node = int(scene.nodes.size()) - 1;
  scene.punctual.push_back(light);
}

core::Pose stillPose(const core::Scene& scene) {
  core::Pose pose;
  pose.nodeToWorld.assign(scene.nodes.size(), core::mat4(1));
  pose.materialEmission.assign(scene.materials.size(), 1.0f);
  return pose;
}

TEST(Lights, ProbabilityIsShareOfPower) {
  core::Scene scene = triangles({1, 2, 3});
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].doubleSided = true;
  scene.meshes[0].material = 1;
  addPunctual(scene, core::PunctualLight::Type::point, vec3(3));
  addPunctual(scene, core::PunctualLight::Type::spot, vec3(3));
  const core::Lights lights(scene, stillPose(scene));
  // Area x radiance x sides; 4 I for a point; (2 - cos inner - cos outer) I for a spot: all over pi.
  const double spot = 3 * (2 - 1 - std::cos(core::kPi / 4));
  const std::vector<double> power{0.5 * 2 * 2, 2 * 2, 4.5 * 2, 12, spot};
  const double sum = 2 + 4 + 9 + 12 + spot;
  ASSERT_EQ(lights.size(), 5u);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_NEAR(lights.probability(i), power[i] / sum, 1e-6);
  EXPECT_TRUE(lights.isArea(2) && !lights.isArea(3));
}

TEST(Lights, SamplesFollowProbabilityAndAreUniformOnTriangles) {
  const core::Scene scene = triangles({1, 2, 0.01f});
  const core::Lights lights(scene, stillPose(scene));
  constexpr int kDraws = 500'000, kCells = 8;
  std::vector<double> light(3), cells(kCells * kCells);
  core::Rng rng(1, core::Pass::lab, 0, 0);
  double ofSecond = 0;
  for (int i = 0; i < kDraws; ++i) {
    const core::LightSample s = lights.sample(rng);
    ++light[s.light];
    ASSERT_TRUE(s.uv.x >= 0 && s.uv.y >= 0 && s.uv.x + s.uv.y <= 1);
    if (s.light != 1) continue;
    ++ofSecond;
    ++cells[std::min(int(s.uv.x * kCells), kCells - 1) * kCells + std::min(int(s.uv.y * kCells), kCells - 1)];
  }
  std::vector<double> expected(3), expectedCells(cells.size());
  for (std::uint32_t i = 0; i < 3; ++i) expected[i] = kDraws * double(lights.probability(i));
  EXPECT_GT(tests::chiSquareP(light, expected), kSignificance);
  for (int x = 0; x < kCells; ++x)
    for (int y = 0; y < kCells; ++y)  // area of the cell inside x + y < 1, over 1/2
      expectedCells[x * kCells + y] = ofSecond *
                                      (x + y < kCells - 1    ? 2.0
                                       : x + y == kCells - 1 ? 1.0
                                                             : 0.0) /
                                      (kCells * kCells);
  EXPECT_GT(tests::chiSquareP(cells, expectedCells), kSignificance);
  // Negative control: uniform numbers taken as barycentric weights, folded by reflection only half of the time.
  for (double& c : cells) c = 0;
  for (int i = 0; i < int(ofSecond); ++i) {
    vec2 b = rng.uniform2();
    if (b.x + b.y > 1) b *= 0.5f;
    ++cells[std::min(int(b.x * kCells), kCells - 1) * kCells + std::min(int(b.y * kCells), kCells - 1)];
  }
  EXPECT_LT(tests::chiSquareP(cells, expectedCells), kSignificance);
}

TEST(Lights, IncidentOfATriangleIsAreaCosineOverSquaredDistance) {
  const core::Scene scene = triangles({2});
  const core::Lights lights(scene, stillPose(scene));
  const vec3 position(1, 2, 3), point(0.5f, 1, 0);
  const core::Incident in = lights.incident<kAll>({0, {0.25f, 0.5f}}, position);
  const vec3 offset = point - position;
  EXPECT_NEAR(in.distance, length(offset), 1e-6);
  EXPECT_NEAR(in.geometry, 2 * (3 / length(offset)) / dot(offset, offset), 1e-6);
  EXPECT_EQ(in.radiance, vec3(2));
  EXPECT_NEAR(length(in.direction - normalize(offset)), 0, 1e-6);
}

TEST(Lights, FrontFaceShinesAloneUnlessDoubleSided) {
  core::Scene scene = triangles({1});
  const vec3 front(0.2f, 0.2f, 1), back(0.2f, 0.2f, -1);
  const core::LightSample s{0, {0.3f, 0.3f}};
  const core::Lights single(scene, stillPose(scene));
  EXPECT_GT(single.incident<kAll>(s, front).flux().r, 0);
  EXPECT_EQ(single.incident<kAll>(s, back).flux().r, 0);
  scene.materials[0].doubleSided = true;
  const core::Lights both(scene, stillPose(scene));
  EXPECT_EQ(both.incident<kAll>(s, front).flux(), both.incident<kAll>(s, back).flux());
}

TEST(Lights, MirroredInstanceKeepsItsFront) {
  const core::Scene scene = triangles({1});
  core::Pose pose = stillPose(scene);
  pose.nodeToWorld[0] = core::mat4(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);  // x -> -x, front stays +z
  const core::Lights lights(scene, pose);
  EXPECT_GT(lights.incident<kAll>({0, {0.3f, 0.3f}}, vec3(-0.2f, 0.2f, 1)).flux().r, 0);
  EXPECT_EQ(lights.incident<kAll>({0, {0.3f, 0.3f}}, vec3(-0.2f, 0.2f, -1)).flux().r, 0);
}

TEST(Lights, LightThatGrowsKeepsItsMeasure) {
  // The mean of flux over a triangle is the irradiance integral whatever its size: far away, area / d^2.
  const core::Scene scene = triangles({1});
  for (float scale : {1.0f, 3.0f}) {
    core::Pose pose = stillPose(scene);
    pose.nodeToWorld[0] = core::mat4(scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
    const core::Lights lights(scene, pose);
    const core::Incident in = lights.incident<kAll>({0, vec2(1 / 3.0f)}, vec3(scale / 3, scale / 3, 100));
    EXPECT_NEAR(in.flux().r, 2 * 0.5 * scale * scale / 1e4, 1e-8);
    EXPECT_EQ(lights.probability(0), 1);
  }
}

TEST(Lights, LightsWithoutPowerKeepTheirIndexAndAreNeverDrawn) {
  core::Scene scene = triangles({1, 0, 1});  // the second triangle is degenerate
  scene.materials.push_back(scene.materials[0]);
  scene.meshes[2].material = 1;
  core::Pose pose = stillPose(scene);
  pose.materialEmission[1] = 0;  // flickers to black
  const core::Lights lights(scene, pose);
  EXPECT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights.lightOf(2, 0), 2u);
  core::Rng rng(1, core::Pass::lab, 0, 0);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(lights.sample(rng).light, 0u);
  EXPECT_EQ(lights.probability(1), 0);
  EXPECT_EQ(lights.probability(2), 0);
  EXPECT_EQ(lights.incident<kAll>({1, {0.1f, 0.1f}}, vec3(0, 0, 1)).flux().r, 0);
  pose.materialEmission[0] = 0;
  const core::Lights dark(scene, pose);
  EXPECT_TRUE(dark.empty());
  EXPECT_FALSE(dark.sample(rng).valid());
}

TEST(Lights, InstancesWithoutEmissionHaveNoLight) {
  core::Scene scene = triangles({1, 1});
  scene.materials.emplace_back();
  scene.meshes[0].material = 1;
  const core::Lights lights(scene, stillPose(scene));
  EXPECT_EQ(lights.lightOf(0, 0), core::kNoLight);
  EXPECT_EQ(lights.lightOf(1, 0), 0u);
}

TEST(Lights, TextureMeanIsZeroOnlyWhereTheTriangleIsBlack) {
  core::Scene scene = triangles({1, 1, 1});
  core::Texture texture;
  texture.width = texture.height = 64;
  texture.texels.assign(4 * 64 * 64, 0);
  for (int c = 0; c < 3; ++c) texture.texels[4 * (20 * 64 + 40) + c] = 255;  // one white texel
  scene.textures = {texture};
  scene.materials[0].emissionTexture = 0;
  scene.meshes[1].uvs = {vec2(0.6f, 0.3f), vec2(0.7f, 0.3f), vec2(0.6f, 0.4f)};  // around the white texel
  scene.meshes[2].uvs = {vec2(0.1f, 0.7f), vec2(0.3f, 0.7f), vec2(0.1f, 0.9f)};  // far from it
  const core::Lights lights(scene, stillPose(scene));
  EXPECT_GT(lights.probability(0), 0);
  EXPECT_GT(lights.probability(1), lights.probability(0));
  EXPECT_EQ(lights.probability(2), 0);
  EXPECT_TRUE(lights.features().textured);
  const vec2 b((40.5f / 64 - 0.6f) / 0.1f, (20.5f / 64 - 0.3f) / 0.1f);
  EXPECT_NEAR(lights.incident<kAll>({1, b}, vec3(0, 0, 1)).radiance.g, 2, 1e-3);
}

TEST(Lights, MeanOfAUniformTextureIsItsColour) {
  core::Scene scene = triangles({1});
  core::Texture texture;
  texture.width = 33, texture.height = 70;  // not powers of two
  texture.texels.assign(4 * 33 * 70, 188);  // sRGB 188 = 0.5029 linear
  scene.textures = {texture};
  scene.materials[0].emissionTexture = 0;
  addPunctual(scene, core::PunctualLight::Type::point, vec3(0.25f));
  const core::Lights lights(scene, stillPose(scene));
  EXPECT_NEAR(lights.probability(0), 0.5029 / (0.5029 + 1), 1e-4);
}

TEST(Lights, SpotFallsOffBetweenItsCones) {
  core::Scene scene;
  scene.materials.resize(1);
  addPunctual(scene, core::PunctualLight::Type::spot, vec3(8));
  scene.punctual[0].innerAngle = 0.3f, scene.punctual[0].outerAngle = 0.6f;
  const core::Lights lights(scene, stillPose(scene));
  const auto at = [&](float angle) {
    return lights.incident<kAll>({0}, 2.0f * vec3(std::sin(angle), 0, -std::cos(angle))).flux().r;
  };
  EXPECT_NEAR(at(0.29f), 2, 1e-5);
  EXPECT_EQ(at(0.61f), 0);
  const double t = (std::cos(0.45) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6));
  EXPECT_NEAR(at(0.45f), 2 * t * t, 1e-4);
}

TEST(Lights, DirectionalLightsShareStaysBounded) {
  for (float intensity : {1e-6f, 1e6f}) {
    core::Scene scene = triangles({1, 2});
    addPunctual(scene, core::PunctualLight::Type::directional, vec3(intensity));
    const core::Lights lights(scene, stillPose(scene));
    EXPECT_NEAR(lights.probability(2), intensity < 1 ? 1.0 / 9 : 0.5, 1e-5);
    EXPECT_EQ(lights.incident<kAll>({2}, vec3(5)).direction, vec3(0, 0, 1));
    EXPECT_EQ(lights.incident<kAll>({2}, vec3(5)).flux(), vec3(intensity));
    EXPECT_EQ(lights.incident<kAll>({2}, vec3(5)).distance, core::kInfinity);
  }
}

TEST(Lights, PowerThatIsNotFiniteIsAnError) {
  core::Scene scene = triangles({1});
  core::Pose pose = stillPose(scene);
  pose.materialEmission[0] = core::kInfinity;
  EXPECT_THROW(core::Lights(scene, pose), core::Error);
}

}  // namespace
