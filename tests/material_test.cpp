// The reflection model samples what its density says, is reciprocal, and returns no more light than it gets.
#include "core/material.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "core/random.h"
#include "tests/chi_square.h"

namespace {

using core::vec3;
constexpr double kSignificance = 1e-6;

core::Surface makeSurface(float roughness, float metallic, vec3 base = vec3(0.8f, 0.5f, 0.3f),
                          vec3 normal = vec3(0, 0, 1)) {
  core::Surface s;
  s.id = 0;
  s.normal = s.geometricNormal = normalize(normal);
  s.roughness = roughness, s.metallic = metallic, s.baseColor = base;
  return s;
}

vec3 direction(float cosine, float angle) {
  const float sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(angle), sine * std::sin(angle), cosine};
}

/// Midpoint rule over the upper hemisphere in (cos theta, phi).
double integrate(int thetas, int phis, const std::function<double(const vec3&)>& f) {
  double sum = 0;
  for (int i = 0; i < thetas; ++i)
    for (int j = 0; j < phis; ++j) sum += f(direction((i + 0.5f) / thetas, 2 * core::kPi * (j + 0.5f) / phis));
  return sum * 2 * 3.14159265358979 / (double(thetas) * phis);
}

/// p value of sample() against pdf() over cells of equal solid angle; null samples are a cell of their own.
double chiSquareOf(const core::Bsdf& sampled, const core::Bsdf& claimed, int draws) {
  constexpr int kThetas = 20, kPhis = 40, kSub = 12;
  std::vector<double> counts(kThetas * kPhis + 1), expected(kThetas * kPhis + 1);
  core::Rng rng(3, core::Pass::lab, 0, 0);
  for (int i = 0; i < draws; ++i) {
    const core::BsdfSample s = sampled.sample(rng.uniform3());
    const float phi = std::atan2(s.direction.y, s.direction.x);
    const int theta = std::clamp(int(s.direction.z * kThetas), 0, kThetas - 1);
    const int column = std::clamp(int((phi / (2 * core::kPi) + (phi < 0 ? 1 : 0)) * kPhis), 0, kPhis - 1);
    ++counts[s.pdf > 0 ? theta * kPhis + column : kThetas * kPhis];
  }
  double inside = 0;
  for (int t = 0; t < kThetas; ++t)
    for (int p = 0; p < kPhis; ++p) {
      double sum = 0;
      for (int a = 0; a < kSub; ++a)
        for (int b = 0; b < kSub; ++b)
          sum += claimed.pdf(
              direction((t + (a + 0.5f) / kSub) / kThetas, 2 * core::kPi * (p + (b + 0.5f) / kSub) / kPhis));
      inside += expected[t * kPhis + p] = draws * sum * 2 * 3.14159265 / (kThetas * kPhis * kSub * kSub);
    }
  expected.back() = std::max(0.0, draws - inside);
  return tests::chiSquareP(counts, expected);
}

TEST(Material, SamplesFollowTheDensity) {
  for (float metallic : {0.0f, 1.0f})
    for (float roughness : {0.5f, 1.0f})
      for (float cosine : {0.95f, 0.5f, 0.2f}) {
        const core::Bsdf bsdf(makeSurface(roughness, metallic), direction(cosine, 0.7f));
        EXPECT_GT(chiSquareOf(bsdf, bsdf, 100'000), kSignificance)
            << "roughness " << roughness << " metallic " << metallic << " cosine " << cosine;
      }
}

TEST(Material, ChiSquareCatchesARoughnessOffByFivePercent) {
  const core::Bsdf right(makeSurface(0.5f, 1), direction(0.5f, 0.7f)),
      wrong(makeSurface(0.525f, 1), direction(0.5f, 0.7f));
  EXPECT_LT(chiSquareOf(wrong, right, 100'000), kSignificance);
}

TEST(Material, IsReciprocal) {
  core::Rng rng(1, core::Pass::lab, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    const core::Surface s = makeSurface(0.05f + 0.95f * rng.uniform(), rng.uniform());
    const vec3 a = direction(0.02f + 0.98f * rng.uniform(), 6 * rng.uniform());
    const vec3 b = direction(0.02f + 0.98f * rng.uniform(), 6 * rng.uniform());
    const vec3 ab = core::Bsdf(s, a).evaluate(b) / b.z, ba = core::Bsdf(s, b).evaluate(a) / a.z;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ab[c], ba[c], 2e-4f * ab[c] + 1e-7f);
  }
}

TEST(Material, WhiteFurnaceReturnsNoMoreThanItGets) {
  for (float metallic : {0.0f, 0.5f, 1.0f})
    for (float roughness : {0.1f, 0.3f, 0.6f, 1.0f})
      for (float cosine : {0.05f, 0.2f, 0.5f, 0.8f, 1.0f}) {
        const core::Bsdf bsdf(makeSurface(roughness, metallic, vec3(1)), direction(cosine, 0));
        core::Rng rng(5, core::Pass::lab, 0, 0);
        double sum = 0;
        constexpr int kSamples = 10000;
        for (int i = 0; i < kSamples; ++i) {
          const core::BsdfSample s = bsdf.sample(rng.uniform3());
          if (s.pdf > 0) sum += bsdf.evaluate(s.direction).r / s.pdf;
        }
        EXPECT_LE(sum / kSamples, 1.005) << roughness << " " << metallic << " " << cosine;
        if (metallic == 1 && roughness == 0.1f) {
          EXPECT_GE(sum / kSamples, 0.97) << cosine;  // little is lost between facets
        }
      }
}

TEST(Material, DiffusePartIsLamberts) {
  // The narrowest highlight leaves (1 - F(min(n.l, n.v))) base / pi cos everywhere else, F from Schlick with F0 = 0.04.
  const core::Bsdf bsdf(makeSurface(0, 0, vec3(0.6f)), vec3(0, 0, 1));
  for (float cosine : {0.2f, 0.5f, 0.7f}) {
    const double fresnel = 0.04 + 0.96 * std::pow(1 - double(cosine), 5);
    const double expected = (1 - fresnel) * 0.6 / 3.14159265358979 * cosine;
    EXPECT_NEAR(bsdf.evaluate(direction(cosine, 1)).g, expected, 1e-4 * expected);
  }
}

TEST(Material, SampledAlbedoIsTheQuadratures) {
  for (float metallic : {0.0f, 1.0f}) {
    const core::Bsdf bsdf(makeSurface(0.6f, metallic), direction(0.6f, 1));
    const double quadrature = integrate(400, 400, [&](const vec3& d) { return core::luminance(bsdf.evaluate(d)); });
    core::Rng rng(2, core::Pass::lab, 0, 0);
    double sum = 0, squares = 0;
    constexpr int kSamples = 200'000;
    for (int i = 0; i < kSamples; ++i) {
      const core::BsdfSample s = bsdf.sample(rng.uniform3());
      const double x = s.pdf > 0 ? core::luminance(bsdf.evaluate(s.direction)) / s.pdf : 0;
      sum += x, squares += x * x;
    }
    const double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
    EXPECT_NEAR(mean, quadrature, 5 * error + 1e-4 * quadrature);
    EXPECT_LT(error, 0.002 * quadrature);
  }
}

TEST(Material, GrazingAnglesAndDegenerateFramesStayFinite) {
  core::Rng rng(4, core::Pass::lab, 0, 0);
  for (const vec3 normal : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(1, 0, 0), vec3(1e-8f, -1e-8f, -1)})
    for (float roughness : {0.0f, 0.03f, 1.0f})
      for (float cosine : {1e-7f, 1e-4f, 1.0f}) {
        const core::Surface s = makeSurface(roughness, 1, vec3(1), normal);
        const core::Frame frame(s.normal);
        const core::Bsdf bsdf(s, frame.toWorld(direction(cosine, 2)));
        for (int i = 0; i < 200; ++i) {
          const core::BsdfSample sample = bsdf.sample(rng.uniform3());
          EXPECT_TRUE(core::isFinite(sample.direction) && core::isFinite(sample.pdf) && sample.pdf >= 0);
          const core::BsdfValue v = bsdf.value(frame.toWorld(direction(1e-7f, 6 * rng.uniform())));
          EXPECT_TRUE(core::isFinite(v.f) && core::isFinite(v.pdf));
        }
      }
}

TEST(Material, ReflectsNothingBelowEitherHorizon) {
  core::Surface s = makeSurface(0.5f, 0);
  s.geometricNormal = normalize(vec3(1, 0, 1));
  const core::Bsdf bsdf(s, direction(0.9f, 0));
  EXPECT_EQ(bsdf.evaluate(direction(0.3f, core::kPi)), vec3(0));  // above the shading, below the geometric horizon
  EXPECT_EQ(bsdf.pdf(direction(0.3f, core::kPi)), 0);
  EXPECT_EQ(bsdf.evaluate(vec3(0.5f, 0, -0.5f)), vec3(0));
  EXPECT_GT(bsdf.evaluate(direction(0.3f, 0)).r, 0);
  const core::Bsdf behind(makeSurface(0.5f, 0), vec3(0, 0, -1));
  EXPECT_EQ(behind.evaluate(vec3(0, 0, 1)), vec3(0));
  EXPECT_EQ(behind.sample(vec3(0.5f)).pdf, 0);
}

TEST(Material, SmoothestHighlightIsAccurateInFloat) {
  // [bsdf 2] against double precision, a few alpha around the mirror direction at the least roughness.
  const core::Surface s = makeSurface(0, 1, vec3(1));
  const double alpha = double(core::kLeastRoughness) * core::kLeastRoughness;
  const vec3 viewer = normalize(vec3(0.3f, 0.4f, 0.6f));
  const core::Bsdf bsdf(s, viewer);
  for (double offset : {0.0, 0.5, 1.0, 3.0}) {
    const vec3 light = normalize(vec3(-viewer.x + float(offset * alpha), -viewer.y, viewer.z));
    const glm::dvec3 l = light, v = viewer, h = normalize(l + v);
    const double t = (h.x * h.x + h.y * h.y) / (alpha * alpha) + h.z * h.z;
    const double d = 1 / (3.14159265358979 * alpha * alpha * t * t);
    const auto root = [&](double c) { return std::sqrt(alpha * alpha + (1 - alpha * alpha) * c * c); };
    const double expected = d * 0.5 * l.z / (l.z * root(v.z) + v.z * root(l.z));
    EXPECT_NEAR(bsdf.evaluate(light).r, expected, 2e-3 * expected);
  }
}

}  // namespace
