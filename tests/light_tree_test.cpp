// Lights drawn from a tree, uniformly or by power: probabilities sum to 1, samples follow them, and nothing that shines
// at a surface is ever missed.
#include "core/light_tree.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <functional>

#include "core/light_bounds.h"
#include "core/light_choice.h"
#include "tests/chi_square.h"

namespace {

using core::LightChoice;
using core::LightSampler;
using core::LightTree;
using core::vec2;
using core::vec3;
constexpr double kSignificance = 1e-6;
constexpr core::LightFeatures kAll{};

core::Rng rngOf(std::uint32_t stream) { return {11, core::Pass::lab, stream, 0}; }
vec3 inCube(core::Rng& rng) { return 2.0f * rng.uniform3() - 1.0f; }
vec3 onSphere(core::Rng& rng) {
  const vec3 v = inCube(rng);
  const float length2 = dot(v, v);
  return length2 > 1e-3f && length2 < 1 ? v / std::sqrt(length2) : onSphere(rng);
}

/// What a random scene is made of.
struct Recipe {
  int triangles = 0, points = 0, spots = 0, directional = 0;
  float extent = 1, sizes = 2;  ///< half the side of the cube around all; decades of size
};

void addPunctual(core::Scene& scene, core::PunctualLight::Type type, core::Rng& rng, float extent) {
  core::Node node;
  node.translation = extent * inCube(rng);
  node.rotation = glm::angleAxis(7 * rng.uniform(), onSphere(rng));
  scene.nodes.push_back(node);
  core::PunctualLight light;
  light.type = type;
  light.intensity = vec3(extent * extent * std::pow(10.0f, -2 * rng.uniform()));
  light.outerAngle = 0.05f + 1.5f * rng.uniform();
  light.innerAngle = rng.uniform() * light.outerAngle;
  light.node = static_cast<int>(scene.nodes.size()) - 1;
  scene.punctual.push_back(light);
}

/// Triangles in four meshes: one- and two-sided, each once as it is and once mirrored.
core::Scene randomScene(const Recipe& r, std::uint32_t stream) {
  core::Rng rng = rngOf(stream);
  core::Scene scene;
  for (int m = 0; m < 4 && r.triangles > 0; ++m) {
    core::Material material;
    material.emission = vec3(1, 2, 3);
    material.doubleSided = m % 2 == 1;
    scene.materials.push_back(material);
    core::Mesh mesh;
    mesh.material = m;
    for (int i = m; i < r.triangles; i += 4) {
      const vec3 centre = r.extent * inCube(rng);
      const float size = r.extent * std::pow(10.0f, -r.sizes * rng.uniform());
      for (int c = 0; c < 3; ++c) mesh.positions.push_back(centre + size * inCube(rng));
      const auto first = static_cast<std::uint32_t>(mesh.positions.size()) - 3;
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    core::Node node;
    if (m >= 2) node.scale = vec3(-1, 1, 1);
    scene.nodes.push_back(node);
    scene.meshes.push_back(mesh);
    scene.instances.push_back({m, static_cast<int>(scene.nodes.size()) - 1});
  }
  for (int i = 0; i < r.points; ++i) addPunctual(scene, core::PunctualLight::Type::point, rng, r.extent);
  for (int i = 0; i < r.spots; ++i) addPunctual(scene, core::PunctualLight::Type::spot, rng, r.extent);
  for (int i = 0; i < r.directional; ++i) addPunctual(scene, core::PunctualLight::Type::directional, rng, r.extent);
  return scene;
}

const std::vector<Recipe> kRecipes{{1},
                                   {2},
                                   {5, 0, 0, 1},
                                   {300},
                                   {200, 20, 40, 2},
                                   {0, 30},
                                   {0, 0, 50},
                                   {0, 0, 0, 3},
                                   {400, 10, 10, 0, 1e-3f, 3},
                                   {400, 10, 10, 1, 1e4f, 4}};
constexpr std::array kSamplers{LightSampler::uniform, LightSampler::power, LightSampler::tree};

/// Scene and its lights.
struct Lit {
  core::Scene scene;
  core::Lights lights;
  explicit Lit(core::Scene s) : scene(std::move(s)), lights(scene, core::poseAt(scene, 0)) {}
  Lit(const Lit&) = delete;
};

/// Surfaces inside the cube, far outside it, and on a light.
struct Place {
  vec3 position, normal;
};
Place randomPlace(const Lit& lit, float extent, core::Rng& rng) {
  const std::uint32_t kind = rng.below(4);
  vec3 position = extent * (kind == 0 ? 30.0f : 1.0f) * inCube(rng);
  if (kind == 1 && lit.lights.triangleCount() > 0)
    position = lit.lights.triangle(rng.below(lit.lights.triangleCount())).point(0.4f * rng.uniform2());
  return {position, onSphere(rng)};
}

double sumOfPdf(const Lit& lit, const LightChoice& choice, const Place& at) {
  double sum = 0;
  for (std::uint32_t i = 0; i < lit.lights.size(); ++i)
    sum += double{choice.pdf({i, vec2(0.3f)}, at.position, at.normal)};
  return sum;
}

TEST(LightChoice, ProbabilitiesSumToOneEverywhere) {
  for (std::uint32_t r = 0; r < kRecipes.size(); ++r) {
    const Lit lit(randomScene(kRecipes[r], r));
    for (const LightSampler sampler : kSamplers) {
      const LightChoice choice(lit.lights, sampler);
      core::Rng rng = rngOf(100 + r);
      for (int i = 0; i < 200; ++i) {
        const Place at = randomPlace(lit, kRecipes[r].extent, rng);
        ASSERT_NEAR(sumOfPdf(lit, choice, at), 1, 1e-4) << "recipe " << r << " place " << i;
      }
    }
  }
}

/// p value of samples at one place against densities that `claimed` gives.
double followsPdf(const Lit& lit, const LightChoice& choice, const Place& at, const Place& claimed,
                  std::uint32_t seed) {
  constexpr int kDraws = 40'000;
  core::Rng rng = rngOf(seed);
  std::vector<double> counts(lit.lights.size()), expected(lit.lights.size());
  for (int i = 0; i < kDraws; ++i) {
    const std::uint32_t high = rng.bits(), low = rng.bits();
    const core::LightDraw drawn = choice.sample(at.position, at.normal, {high, low, {rng.bits(), rng.bits()}}, rng);
    EXPECT_NEAR(drawn.pdf, choice.pdf(drawn.sample, at.position, at.normal), 1e-5f * drawn.pdf);
    ++counts[drawn.sample.light];
  }
  for (std::uint32_t i = 0; i < lit.lights.size(); ++i)
    expected[i] = kDraws * double{choice.pdf({i, vec2(0.3f)}, claimed.position, claimed.normal)};
  return tests::chiSquareP(counts, expected);
}

TEST(LightChoice, SamplesFollowTheirProbabilities) {
  int caught = 0, trees = 0;
  for (std::uint32_t r = 0; r < kRecipes.size(); ++r) {
    const Lit lit(randomScene(kRecipes[r], r));
    core::Rng rng = rngOf(200 + r);
    for (const LightSampler sampler : kSamplers) {
      const LightChoice choice(lit.lights, sampler);
      for (std::uint32_t i = 0; i < 4; ++i) {
        const Place at = randomPlace(lit, kRecipes[r].extent, rng);
        EXPECT_GT(followsPdf(lit, choice, at, at, 300 + i), kSignificance) << "recipe " << r << " place " << i;
        if (sampler != LightSampler::tree || lit.lights.size() < 30) continue;
        // Negative control: probabilities of a surface that faces elsewhere.
        caught += followsPdf(lit, choice, at, {at.position, -at.normal}, 300 + i) < kSignificance;
        ++trees;
      }
    }
  }
  EXPECT_GE(trees, 20);
  EXPECT_GT(caught, 0.8 * trees);
}

/// Of random light points that shine above a surface's horizon, how many had no density. density: as choice.pdf.
using Density = std::function<float(const core::LightSample&, const vec3&, const vec3&)>;
int missed(const Lit& lit, float extent, const Density& density, std::uint32_t seed, int& shining) {
  core::Rng rng = rngOf(seed);
  int count = 0;
  for (int i = 0; i < 300; ++i) {
    const Place at = randomPlace(lit, extent, rng);
    for (std::uint32_t light = 0; light < lit.lights.size(); ++light) {
      const core::LightSample y = lit.lights.pointOn(light, {rng.bits(), rng.bits()}, rng);
      const core::Incident in = lit.lights.incident<kAll>(y, at.position);
      if (!(core::maxComponent(in.flux()) > 0 && dot(in.direction, at.normal) > 0)) continue;
      ++shining;
      count += !(density(y, at.position, at.normal) > 0);
    }
  }
  return count;
}

TEST(LightChoice, NothingThatShinesIsMissed) {
  for (std::uint32_t r = 0; r < kRecipes.size(); ++r) {
    const Lit lit(randomScene(kRecipes[r], r));
    for (const LightSampler sampler : kSamplers) {
      const LightChoice choice(lit.lights, sampler);
      int shining = 0;
      const auto pdf = [&](const auto& y, const vec3& p, const vec3& n) { return choice.pdf(y, p, n); };
      EXPECT_EQ(missed(lit, kRecipes[r].extent, pdf, 400 + r, shining), 0) << "recipe " << r;
      EXPECT_GT(shining, 0);
    }
  }
}

TEST(LightChoice, BoundsThatAreTooNarrowAreCaught) {  // control of the test above
  const Lit lit(randomScene(kRecipes[4], 4));
  const LightChoice choice(lit.lights, LightSampler::tree);
  int shining = 0;
  const auto tilted = [&](const auto& y, const vec3& p, const vec3& n) {
    return choice.pdf(y, p, normalize(n + vec3(0.05f, 0, 0)));  // a horizon 3 degrees off
  };
  EXPECT_GT(missed(lit, 1, tilted, 404, shining), 0);
  const auto beside = [&](const auto& y, const vec3& p, const vec3& n) { return choice.pdf(y, p + 0.05f, n); };
  EXPECT_GT(missed(lit, 1, beside, 404, shining), 0);
}

/// Entries of one triangle that faces up, all at one place unless step says otherwise.
core::Scene row(int count, const vec3& step) {
  core::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emission = vec3(1);
  core::Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const vec3 at = static_cast<float>(i) * step;
    mesh.positions.insert(mesh.positions.end(), {at, at + vec3(0, 0, 1), at + vec3(1, 0, 0)});
    const auto first = static_cast<std::uint32_t>(3 * i);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  scene.meshes = {mesh};
  scene.nodes.resize(1);
  scene.instances = {{0, 0}};
  return scene;
}

TEST(LightTree, DegenerateScenesAreLegal) {
  for (const vec3& step : {vec3(0), vec3(1e-30f, 0, 0), vec3(1, 0, 0), vec3(1e6f, 0, 0)})
    for (const int count : {1, 2, 3, 4, 5, 17, 5000}) {
      const Lit lit(row(count, step));
      const LightChoice choice(lit.lights, LightSampler::tree);
      for (const vec3& position : {vec3(0), vec3(0.2f, 3, 0.2f), vec3(0, 1e9f, 0), vec3(0.2f, -3, 0)})
        EXPECT_NEAR(sumOfPdf(lit, choice, {position, vec3(0, -1, 0)}), 1, 1e-3) << count;
    }
}

TEST(LightTree, PointsAtOnePlaceAreLegalEvenThere) {
  core::Scene scene;
  core::Rng rng = rngOf(1);
  for (int i = 0; i < 9; ++i) addPunctual(scene, core::PunctualLight::Type::point, rng, 0);
  for (core::PunctualLight& light : scene.punctual) light.intensity = vec3(2);
  const Lit lit(std::move(scene));
  const LightChoice choice(lit.lights, LightSampler::tree);
  for (const vec3& position : {vec3(0), vec3(1e-20f, 0, 0), vec3(1, 0, 0), vec3(1e12f, 0, 0)})
    EXPECT_NEAR(sumOfPdf(lit, choice, {position, vec3(-1, 0, 0)}), 1, 1e-5);
}

TEST(LightTree, LightsWithoutPowerAreInNoTree) {
  core::Scene scene = row(3, vec3(1, 0, 0));
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emission = vec3(0);
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes[1].material = 1;
  scene.instances.push_back({1, 0});
  scene.meshes[0].triangles[1] = {0, 0, 0};  // degenerate
  const Lit lit(scene);
  for (const LightSampler sampler : kSamplers) {
    const LightChoice choice(lit.lights, sampler);
    EXPECT_EQ(choice.pdf({1, vec2(0)}, vec3(0, -1, 0), vec3(0, 1, 0)), 0);
    EXPECT_NEAR(sumOfPdf(lit, choice, {vec3(0, -1, 0), vec3(0, 1, 0)}), 1, 1e-5);
  }
  scene.materials[0].emission = vec3(0);
  const Lit dark(scene);
  for (const LightSampler sampler : kSamplers) {
    const LightChoice choice(dark.lights, sampler);
    core::Rng rng = rngOf(6);
    EXPECT_FALSE(choice.sample(vec3(0), vec3(0, 1, 0), {}, rng).sample.valid());
  }
  EXPECT_TRUE(LightTree(dark.lights).empty());
  EXPECT_TRUE(LightTree(core::Lights()).empty());
}

TEST(LightTree, FirstAndLastNumbersDrawLightsThatHaveProbability) {
  const Lit lit(randomScene(kRecipes[4], 4));
  const LightChoice choice(lit.lights, LightSampler::tree);
  core::Rng rng = rngOf(5);
  for (int i = 0; i < 2000; ++i) {
    const Place at = randomPlace(lit, 1, rng);
    for (const std::uint32_t bits : {0u, 0xffffffffu})
      EXPECT_GT(choice.sample(at.position, at.normal, {bits, bits, {1u << 31, 1u << 31}}, rng).pdf, 0);
  }
}

TEST(LightTree, HasTheSameBitsForAnyThreads) {
  const Lit lit(randomScene({20'000, 50, 50}, 3));
  const auto densities = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const LightChoice choice(lit.lights, LightSampler::tree);
    std::vector<float> all;
    for (std::uint32_t i = 0; i < lit.lights.size(); ++i)
      all.push_back(choice.pdf({i, vec2(0.3f)}, vec3(0.1f, 0.2f, 0.3f), vec3(0, 1, 0)));
    return all;
  };
  EXPECT_EQ(densities(1), densities(4));
}

TEST(LightTree, PrefersWhatIsNearAndFacesTheSurface) {
  const Lit lit(row(100, vec3(1, 0, 0)));  // they face up
  const LightTree tree(lit.lights);
  const vec3 below(0, -1, 0), above(50.3f, 0.5f, 0.3f);
  EXPECT_GT(tree.pdf(above, below, 50), 0.2);
  EXPECT_LT(tree.pdf(above, below, 90), 1e-3);
  EXPECT_GT(tree.pdf(above, below, 90), 0);
}

TEST(DirectionCone, UnionHoldsBoth) {
  core::Rng rng = rngOf(9);
  for (int i = 0; i < 2000; ++i) {
    const core::DirectionCone a{onSphere(rng), std::cos(core::kPi * rng.uniform())},
        b{onSphere(rng), i % 3 ? std::cos(core::kPi * rng.uniform()) : 1};
    const core::DirectionCone c = core::unite(a, b);
    EXPECT_NEAR(length(c.axis), 1, 1e-5);
    for (const core::DirectionCone& part : {a, b}) {
      const double between = std::acos(std::clamp<double>(dot(part.axis, c.axis), -1, 1));
      EXPECT_LE(std::min(between + std::acos(double{part.cosine}), double{core::kPi}),
                std::acos(double{std::max(c.cosine, -1.0f)}) + 2e-3);
    }
  }
  const core::DirectionCone opposite = core::unite({vec3(0, 0, 1), 1}, {vec3(0, 0, -1), 1});
  EXPECT_EQ(opposite.cosine, -1);
}

}  // namespace
