// The baselines without reuse: lights drawn uniformly, by power or from a tree, each with BSDF samples, all give the
// light that is there. The smallest bias of a frame's light that the tests detect half of the time is 2 %, in
// direct_samplers_test_thorough 1 %.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <optional>
#include <set>

#include "core/check.h"
#include "core/material.h"
#include "experiments/config.h"
#include "restir/visibility.h"
#include "tests/restir_worlds.h"

namespace {

using core::LightChoice;
using core::LightSampler;
using core::vec2;
using core::vec3;
using restir::RestirParameters;
using restir::WithoutReuse;
using tests::World;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr std::array kBaselines{WithoutReuse::uniform, WithoutReuse::power, WithoutReuse::tree};

RestirParameters baseline(WithoutReuse without) {
  RestirParameters p;
  p.reuse = restir::Reuse::none;
  p.withoutReuse = without;
  return p;
}

/// Three lamps that face down, a point light, a spot and the sun, over a floor half of which is glossy; the lamps and
/// the walls that hide them move.
core::Scene manyKinds() {
  core::Scene scene = tests::makeWorld({{0.03f, 0, 0.02f}, {0.02f, 0, 0}, {0, 0, 0}}, true);
  core::Material panel = tests::emitter({3, 3, 1});
  panel.doubleSided = true;
  tests::addQuad(scene, panel, {-1.2f, 0.3f, 0.9f}, {0.5f, 0, 0}, {0, 0.5f, 0});
  for (const auto type : {core::PunctualLight::Type::spot, core::PunctualLight::Type::directional}) {
    core::Node node;
    node.translation = {-0.8f, 1.8f, 0.4f};
    node.rotation = glm::angleAxis(-1.3f, vec3(1, 0, 0));
    scene.nodes.push_back(node);
    core::PunctualLight light;
    light.type = type;
    light.intensity = vec3(type == core::PunctualLight::Type::spot ? 4.0f : 0.3f);
    light.innerAngle = 0.2f, light.outerAngle = 0.6f;
    light.node = static_cast<int>(scene.nodes.size()) - 1;
    scene.punctual.push_back(light);
  }
  return scene;
}

TEST(Baselines, GiveTheLightThatIsThere) {
  const World world(manyKinds(), 1);
  const tests::Estimate truth = tests::reference(world, 32, 512);
  for (const WithoutReuse without : kBaselines) {
    const auto c = tests::compare(tests::estimate(world, baseline(without), 8192), truth);
    EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
    EXPECT_LT(c.worst, core::sidakBound(tests::kPixels, 1e-6));
    EXPECT_LT(c.detectable, tests::detectableBias(0.02));
  }
}

/// One light and one BSDF sample of a pixel, combined with whatever density `lightPdf` claims for light sampling.
template <class LightPdf>
double combined(const core::Moment& now, const core::Surface& s, const LightChoice& choice, core::Rng& rng,
                LightPdf&& lightPdf) {
  constexpr core::LightFeatures kAll{};
  const core::Bsdf bsdf(s, normalize(now.cameraPosition - s.position));
  const auto value = [&](const core::LightSample& y, const core::Incident& in) {
    const core::BsdfValue f = bsdf.value(in.direction);
    const float bsdfPdf = now.lights->isHittable(y.light) ? f.pdf * in.geometry : 0.0f, density = lightPdf(y) + bsdfPdf;
    return density > 0 ? double{core::luminance(f.f * in.flux()) / density} : 0.0;
  };
  double sum = 0;
  const auto drawn = choice.sample(s.position, s.normal, {rng.bits(), rng.bits(), {rng.bits(), rng.bits()}}, rng);
  const auto in = now.lights->incident<kAll>(drawn.sample, s.position);
  if (core::maxComponent(in.flux()) > 0 && restir::visible(*now.tracer, s, in)) sum += value(drawn.sample, in);
  const core::BsdfSample direction = bsdf.sample(rng.uniform3());
  if (!(direction.pdf > 0)) return sum;
  const auto hit = now.tracer->intersect(core::offsetOrigin(s.position, s.geometricNormal), direction.direction);
  const auto light = hit.hit() ? now.lights->lightOf(hit.instance, hit.primitive) : core::kNoLight;
  if (light == core::kNoLight) return sum;
  const core::LightSample y{light, hit.barycentric};
  return sum + value(y, now.lights->incident<kAll>(y, s.position));
}

/// Means of frames by combined(); claim(surface, y): its density.
template <class Claim>
tests::Estimate estimateBy(const World& world, const LightChoice& choice, int images, Claim&& claim) {
  const core::Moment now = world.moment(world.frames() - 1);
  tests::Estimate result;
  images *= tests::thoroughness();
  std::vector<core::Planes> planes(images);
  tbb::parallel_for(0, images, [&](int i) {
    planes[i] = core::Planes(world.width(), world.height());
    for (std::uint32_t p = 0; p < tests::kPixels; ++p) {
      const core::Surface& s = now.surfaces.at(p);
      if (!s.hit()) continue;
      core::Rng rng(7, core::Pass::lab, p, static_cast<std::uint32_t>(i));
      const double l = combined(now, s, choice, rng, [&](const core::LightSample& y) { return claim(s, y); });
      planes[i].view().store(static_cast<int>(p) % world.width(), static_cast<int>(p) / world.width(),
                             vec3(static_cast<float>(l)));
    }
  });
  for (const core::Planes& image : planes) result.add(image);
  return result;
}

TEST(Baselines, WrongDensitiesOfTheTreeAreCaught) {
  const World world(manyKinds(), 2);
  const core::Moment now = world.moment(1);
  const LightChoice choice(*now.lights, LightSampler::tree);
  const tests::Estimate truth = tests::reference(world, 32, 512);
  const auto right = [&](const core::Surface& s, const auto& y) { return choice.pdf(y, s.position, s.normal); };
  const auto turned = [&](const core::Surface& s, const auto& y) {
    return choice.pdf(y, s.position, normalize(s.normal + vec3(0.8f, 0, 0)));  // another orientation of the surface
  };
  const auto beside = [&](const core::Surface& s, const auto& y) {
    return choice.pdf(y, s.position + vec3(0.3f, 0, 0), s.normal);
  };
  const auto byPower = [&](const core::Surface&, const auto& y) { return now.lights->pdf(y); };
  const auto by = [&](auto&& claim) { return tests::compare(estimateBy(world, choice, 4096, claim), truth); };
  const auto c = by(right);
  EXPECT_LT(std::abs(c.z), kLargestZ) << c.ratio;
  EXPECT_LT(c.worst, core::sidakBound(tests::kPixels, 1e-6));
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
  EXPECT_GT(by(turned).worst, core::sidakBound(tests::kPixels, 1e-6));
  EXPECT_GT(by(beside).worst, core::sidakBound(tests::kPixels, 1e-6));
  EXPECT_TRUE(tests::isBiased(by(byPower)));
}

/// Bytes of a frame's radiance; samples 0 to 3 in a pattern.
std::vector<char> frameBytes(const World& world, WithoutReuse without, int threads, int tile, std::uint64_t seed = 5) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  core::Planes image(world.width(), world.height());
  tests::Hooks hooks;
  hooks.samples = [](int f, int x, int y, const vec3&) { return static_cast<float>((x + 2 * y + f) % 4); };
  tests::renderSequence(world, baseline(without), hooks, seed, image, tile);
  std::vector<char> bytes(sizeof(vec3) * tests::kPixels);
  for (int i = 0; i < tests::kPixels; ++i) {
    const vec3 colour = image.view().at(i);
    std::memcpy(&bytes[sizeof(vec3) * static_cast<std::size_t>(i)], &colour, sizeof(vec3));
  }
  return bytes;
}

TEST(Baselines, HaveTheSameBitsForAnyThreadsAndTile) {
  const World world(manyKinds(), 3);
  for (const WithoutReuse without : kBaselines) {
    const auto one = frameBytes(world, without, 1, core::kDefaultTile);
    EXPECT_EQ(one, frameBytes(world, without, 4, core::kDefaultTile));
    EXPECT_EQ(one, frameBytes(world, without, 3, 5));
    EXPECT_NE(one, frameBytes(world, without, 1, core::kDefaultTile, 6));  // control
  }
}

TEST(Baselines, PixelsWithoutSamplesStandForNone) {
  const World world(manyKinds(), 2);
  for (const WithoutReuse without : kBaselines) {
    tests::Hooks hooks;
    hooks.samples = [](int, int x, int, const vec3&) { return x < 8 ? 0.0f : 3.0f; };
    hooks.after = [&](int f, restir::RestirState& state) {
      const core::Moment now = world.moment(f);
      for (int y = 0; y < world.height(); ++y)
        for (int x = 0; x < world.width(); ++x)
          EXPECT_EQ(state.shaded(x, y), x >= 8 && now.surfaces(x, y).hit() ? 3.0f : 0.0f);
      EXPECT_EQ(state.badPixels(), 0);
    };
    core::Planes image(world.width(), world.height());
    tests::renderSequence(world, baseline(without), hooks, 1, image);
  }
}

TEST(Baselines, LightsAreListedAnewOnlyWhenTheyChange) {
  const World still(tests::makeWorld(), 1), moving(manyKinds(), 3);
  for (const World* world : {&still, &moving}) {
    restir::RestirState state(world->width(), world->height());
    const core::Image<float> samples(world->width(), world->height(), 1.0f);
    std::set<const core::Lights*> drawn;
    std::set<std::shared_ptr<const LightChoice>> built;
    for (int f = 0; f < 3; ++f) {
      restir::drawCandidates(baseline(WithoutReuse::tree), world->frame(f, samples, 1), state);
      EXPECT_EQ(state.drawnLights, world->moment(f).lights);
      drawn.insert(world->moment(f).lights.get());
      built.insert(state.lightChoice);
    }
    EXPECT_EQ(built.size(), drawn.size());
    EXPECT_EQ(built.size(), world == &still ? 1u : 3u);
  }
}

TEST(Baselines, DarkWorldsAreBlack) {
  core::Scene scene = tests::makeWorld();
  for (core::Material& m : scene.materials) m.emission = vec3(0);
  const World world(scene, 2);
  for (const WithoutReuse without : kBaselines) {
    core::Planes image(world.width(), world.height());
    tests::renderSequence(world, baseline(without), {}, 1, image);
    for (int i = 0; i < tests::kPixels; ++i) EXPECT_EQ(image.view().at(i), vec3(0));
  }
}

/// What withoutReuse becomes under settings; nothing where they are an error.
std::optional<WithoutReuse> configured(const std::vector<std::string>& assignments) {
  try {
    const experiments::Config defaults;
    return experiments::configFrom(experiments::Json::object(), assignments, defaults).shade.restir.withoutReuse;
  } catch (const core::UsageError&) {
    return {};
  }
}

TEST(Baselines, NeedReuseNone) {
  EXPECT_EQ(configured({}), WithoutReuse::ris);
  EXPECT_EQ(configured({"restir.withoutReuse=tree", "restir.reuse=none"}), WithoutReuse::tree);
  EXPECT_EQ(configured({"restir.withoutReuse=tree"}), std::nullopt);
  EXPECT_EQ(configured({"restir.withoutReuse=tree", "restir.reuse=temporal"}), std::nullopt);
  EXPECT_EQ(configured({"restir.withoutReuse=best", "restir.reuse=none"}), std::nullopt);
}

}  // namespace
