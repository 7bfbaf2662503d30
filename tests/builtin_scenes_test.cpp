// The built-in scenes: what each promises is there, the same bytes come out on every call, and a GLB of each loads back
// to the same scene without a warning.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/check.h"
#include "core/glb.h"
#include "core/gltf.h"
#include "experiments/scenes/builtin.h"

namespace {

using core::Scene;
using core::vec3;

bool emits(const Scene& scene, const core::Instance& instance) {
  return scene.materials[scene.meshes[instance.mesh].material].emits();
}

std::size_t emissiveTriangles(const Scene& scene) {
  std::size_t count = 0;
  for (const core::Instance& instance : scene.instances)
    if (emits(scene, instance)) count += scene.meshes[instance.mesh].triangles.size();
  return count;
}

float area(const core::Mesh& mesh, const core::uvec3& t, const core::mat4& toWorld) {
  const auto at = [&](std::uint32_t v) { return vec3(toWorld * core::vec4(mesh.positions[v], 1)); };
  return 0.5f * length(cross(at(t.y) - at(t.x), at(t.z) - at(t.x)));
}

/// Area times luminance of every emissive triangle.
std::vector<float> powers(const Scene& scene) {
  const core::Pose pose = core::poseAt(scene, 0);
  std::vector<float> all;
  for (const core::Instance& instance : scene.instances) {
    if (!emits(scene, instance)) continue;
    const core::Mesh& mesh = scene.meshes[instance.mesh];
    for (const core::uvec3& t : mesh.triangles)
      all.push_back(area(mesh, t, pose.nodeToWorld[instance.node]) *
                    core::luminance(scene.materials[mesh.material].emission));
  }
  std::sort(all.begin(), all.end());
  return all;
}

int movingInstances(const Scene& scene, bool emissive) {
  const core::SceneMotion motion = core::motionOf(scene);
  int count = 0;
  for (const core::Instance& instance : scene.instances)
    count += motion.nodeMoves[instance.node] && emits(scene, instance) == emissive;
  return count;
}

}  // namespace

class BuiltinScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, BuiltinScene, testing::ValuesIn(experiments::builtinSceneNames()), [](const auto& test) {
  std::string name = test.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(BuiltinScene, RefersOnlyToWhatIsThere) {
  const Scene scene = experiments::builtinScene(GetParam());
  EXPECT_EQ(scene.name, GetParam());
  ASSERT_EQ(scene.cameras.size(), 1u);
  for (const core::Instance& instance : scene.instances) {
    ASSERT_LT(static_cast<std::size_t>(instance.mesh), scene.meshes.size());
    ASSERT_LT(static_cast<std::size_t>(instance.node), scene.nodes.size());
  }
  for (const core::Mesh& mesh : scene.meshes) {
    ASSERT_LT(static_cast<std::size_t>(mesh.material), scene.materials.size());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  }
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) ASSERT_LT(scene.nodes[i].parent, static_cast<int>(i));
  EXPECT_GT(emissiveTriangles(scene), 0u);
}

TEST_P(BuiltinScene, WindingAgreesWithNormals) {
  for (const core::Mesh& mesh : experiments::builtinScene(GetParam()).meshes)
    for (const core::uvec3& t : mesh.triangles) {
      const vec3& a = mesh.positions[t.x];
      const vec3 face = cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
      ASSERT_GT(dot(face, mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]), 0) << mesh.name;
    }
}

TEST_P(BuiltinScene, LoadsBackFromItsGlbWithoutWarnings) {
  const Scene scene = experiments::builtinScene(GetParam());
  const std::string bytes = core::glbBytes(scene);
  EXPECT_EQ(bytes, core::glbBytes(experiments::builtinScene(GetParam())));
  EXPECT_LT(bytes.size(), 2u << 20);
  const auto path = std::filesystem::temp_directory_path() / ("builtin_" + std::to_string(getpid()) + ".glb");
  core::saveGlb(scene, path);
  const Scene back = core::loadGltf(path);
  std::filesystem::remove(path);
  EXPECT_TRUE(back.warnings.empty());
  EXPECT_EQ(back.instances.size(), scene.instances.size());
  EXPECT_EQ(core::glbBytes(back), bytes);
}

TEST(Cornell, StandsStillAndIsMatte) {
  const Scene scene = experiments::builtinScene("cornell");
  const core::SceneMotion motion = core::motionOf(scene);
  EXPECT_FALSE(motion.instances);
  EXPECT_FALSE(motion.lights);
  EXPECT_TRUE(scene.textures.empty());
  for (const core::Material& material : scene.materials) {
    EXPECT_EQ(material.metallic, 0);
    EXPECT_EQ(material.roughness, 1);
  }
}

TEST(Ajar, OnlyTheDoorMoves) {
  const Scene scene = experiments::builtinScene("ajar");
  EXPECT_GT(movingInstances(scene, false), 0);
  EXPECT_EQ(movingInstances(scene, true), 0);
  EXPECT_FALSE(core::motionOf(scene).nodeMoves[scene.cameras[0].node]);
  const core::Pose early = core::poseAt(scene, 0), late = core::poseAt(scene, 1.5);
  EXPECT_NE(early.nodeToWorld, late.nodeToWorld);
}

TEST(Market, HasManyLightsOverTwoDecadesOfPower) {
  const Scene scene = experiments::builtinScene("market");
  EXPECT_GE(emissiveTriangles(scene), 500u);
  EXPECT_LE(emissiveTriangles(scene), 2000u);
  const std::vector<float> all = powers(scene);
  EXPECT_GT(all[all.size() * 99 / 100] / all[all.size() / 100], 100);
  std::set<int> strongest;
  for (const core::Material& m : scene.materials)
    for (int c = 0; c < 3 && m.emits(); ++c)
      if (m.emission[c] == core::maxComponent(m.emission)) strongest.insert(c);
  EXPECT_EQ(strongest.size(), 3u);
  EXPECT_FALSE(scene.punctual.empty());
}

TEST(Market, FlickersInSeveralWaysForAtLeastFourSeconds) {
  const Scene scene = experiments::builtinScene("market");
  EXPECT_GE(scene.flickers.size(), 4u);
  std::set<core::Interpolation> kinds;
  for (const core::Track& track : scene.flickers) {
    kinds.insert(track.interpolation);
    EXPECT_GE(track.times.back(), 4);
    const auto [low, high] = std::minmax_element(track.values.begin(), track.values.end(),
                                                 [](const auto& x, const auto& y) { return x.x < y.x; });
    EXPECT_GT(high->x, 1.5f * low->x);
  }
  EXPECT_EQ(kinds.size(), 2u);
}

TEST(Market, LightsThingsAndCameraMove) {
  const Scene scene = experiments::builtinScene("market");
  EXPECT_GE(movingInstances(scene, true), 4);
  EXPECT_GE(movingInstances(scene, false), 4);
  const vec3 start = core::poseAt(scene, 0).camera.position, later = core::poseAt(scene, 4).camera.position;
  EXPECT_GE(length(later - start) / 4, 0.5f);
  EXPECT_LE(length(later - start) / 4, 1.0f);
}

TEST(Lamps, AreOneMeshOfAsManyTrianglesAndNearlyTheSamePowerWhateverTheirNumber) {
  std::vector<float> total;
  for (const std::size_t count : {1000u, 10'000u, 100'000u}) {
    const Scene scene = experiments::builtinScene("lamps-" + std::to_string(count));
    EXPECT_EQ(emissiveTriangles(scene), count);
    EXPECT_LT(scene.nodes.size(), 100u);
    float area = 0;
    for (const core::Mesh& mesh : scene.meshes)
      for (const core::uvec3& t : mesh.triangles)
        if (scene.materials[mesh.material].emits())
          area += 0.5f *
                  length(cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
    total.push_back(area);
  }
  EXPECT_NEAR(total[0] / total[2], 1, 0.15);
  EXPECT_NEAR(total[1] / total[2], 1, 0.05);
}

TEST(Lamps, RefuseNumbersThatAreNone) {
  for (const char* name :
       {"lamps-", "lamps-0", "lamps--3", "lamps-1e3", "lamps-4000001", "lamps-99999999999", "lamps-7x"})
    EXPECT_THROW(experiments::builtinScene(name), core::UsageError) << name;
  EXPECT_FALSE(experiments::isBuiltin("lamps-7.glb"));
}

TEST(Builtin, UnknownNamesAreUsageErrorsThatListTheKnown) {
  try {
    experiments::builtinScene("bistro");
    FAIL();
  } catch (const core::UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("cornell"), std::string::npos);
  }
}
