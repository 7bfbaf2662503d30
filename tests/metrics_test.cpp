// Metrics against a reference implementation's figures, closed forms, and by region.
#include "experiments/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/exr.h"
#include "core/files.h"
#include "core/random.h"
#include "experiments/regions.h"
#include "experiments/ssim.h"

namespace experiments {
namespace {

std::filesystem::path vectorFolder() {
  const char* shared = std::getenv("TWOFOLD_SHARED");
  return std::filesystem::path(shared ? shared : TWOFOLD_SOURCE_DIR "/../shared") / "metric_vectors";
}

core::Planes noise(int width, int height, std::uint32_t frame, float scale = 1, float offset = 0.1f) {
  core::Planes image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      core::Rng rng(7, core::Pass::lab, static_cast<std::uint32_t>(y * width + x), frame);
      image.view().store(x, y, offset + scale * rng.uniform3());
    }
  return image;
}

Metrics compare(const core::Planes& test, const Reference& reference, const Mask& mask = {}) {
  return Comparison(test.view(), reference).in(mask);
}

TEST(Metrics, AgreeWithTheReferenceImplementation) {
  const auto folder = vectorFolder();
  if (!std::filesystem::exists(folder / "expected.json")) GTEST_SKIP() << "skipped: no shared metric vectors";
  const auto expected = nlohmann::json::parse(core::readFile(folder / "expected.json"));
  for (const auto& [name, figures] : expected.items()) {
    const core::Planes reference = core::readExrRgb(folder / (name + "_reference.exr"));
    const core::Planes test = core::readExrRgb(folder / (name + "_test.exr"));
    const Metrics m = compare(test, Reference(reference.view()));
    EXPECT_NEAR(m.relMse / figures["relMSE"].get<double>(), 1, 1e-5) << name;
    EXPECT_NEAR(m.relMseTrimmed / figures["relMSE_trimmed_0.1pct"].get<double>(), 1, 1e-5) << name;
    EXPECT_NEAR(m.ssim / figures["SSIM"].get<double>(), 1, 1e-5) << name;
  }
}

TEST(Metrics, OfEqualImagesArePerfect) {
  const core::Planes image = noise(40, 30, 0);
  const Metrics m = compare(image, Reference(image.view()));
  EXPECT_EQ(m.relMse, 0);
  EXPECT_EQ(m.relMseTrimmed, 0);
  EXPECT_EQ(m.mse, 0);
  EXPECT_EQ(m.bias, 0);
  EXPECT_EQ(m.maxError, 0);
  EXPECT_NEAR(m.ssim, 1, 1e-12);
  EXPECT_NEAR(m.energyRatio, 1, 1e-12);
}

TEST(Metrics, OfAConstantOffsetFollowTheirFormulas) {
  const core::Planes reference(20, 20, 0.5f), test(20, 20, 0.75f);
  const Metrics m = compare(test, Reference(reference.view()));
  EXPECT_NEAR(m.relMse, 0.0625 / 0.26, 1e-12);
  EXPECT_DOUBLE_EQ(m.mse, 0.0625);
  EXPECT_DOUBLE_EQ(m.bias, 0.25);
  EXPECT_DOUBLE_EQ(m.maxError, 0.25);
  EXPECT_NEAR(m.energyRatio, 1.5, 1e-12);
}

// The truth is 1 everywhere, both halves are noisy: their product's mean does not see the noise, the square does.
TEST(Metrics, TwoHalvesDoNotCountTheReferencesNoise) {
  const core::Planes truth(200, 200, 1.0f);
  const core::Planes first = noise(200, 200, 1, 0.5f, 0.75f), second = noise(200, 200, 2, 0.5f, 0.75f);
  const double noiseVariance = 0.25 / 12;
  // Product of two independent errors: standard error 0.0208 / sqrt(120000) = 6e-5; bound 5 of them.
  EXPECT_NEAR(compare(truth, Reference(first.view(), second.view())).mse, 0, 3e-4);
  EXPECT_NEAR(compare(truth, Reference(first.view())).mse, noiseVariance, 3e-4);  // negative control
}

TEST(Metrics, TrimmingDropsOutliersOnly) {
  const core::Planes reference(100, 100, 1.0f);
  core::Planes test(100, 100, 1.1f);
  for (int i = 0; i < 10; ++i) test.view().store(10 * i, 50, core::vec3(1000));  // 0.1 % of 10,000 pixels
  const Metrics m = compare(test, Reference(reference.view()));
  EXPECT_GT(m.relMse, 900);
  EXPECT_NEAR(m.relMseTrimmed, 0.01 / 1.01, 1e-8);
  test.view().store(5, 5, core::vec3(1000));  // an eleventh one is not dropped
  EXPECT_GT(compare(test, Reference(reference.view())).relMseTrimmed, 90);
}

TEST(Metrics, TrimmedMeanRoundsUpButKeepsOneValue) {
  EXPECT_EQ(trimmedMean({1, 2, 3}, 0), 2);
  EXPECT_EQ(trimmedMean({1, 2, 300}, 0.001), 1.5);
  EXPECT_EQ(trimmedMean({5}, 0.001), 5);
  EXPECT_TRUE(std::isnan(trimmedMean({}, 0.001)));
  std::vector<double> thousand(1000, 1.0);
  thousand[3] = thousand[4] = 999001;
  EXPECT_DOUBLE_EQ(trimmedMean(thousand, 0.001), (998 + 999001) / 999.0);  // exactly one of 1000
}

TEST(Metrics, MasksSeeTheirPixelsOnly) {
  const core::Planes reference(40, 20, 1.0f);
  core::Planes test(40, 20, 1.0f);
  core::Image<std::uint8_t> left(40, 20), right(40, 20), none(40, 20);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 40; ++x) {
      (x < 20 ? left : right)(x, y) = 1;
      if (x < 20) test.view().store(x, y, core::vec3(2));
    }
  const Comparison comparison(test.view(), Reference(reference.view()));
  EXPECT_DOUBLE_EQ(comparison.in(left.view()).mse, 1);
  EXPECT_DOUBLE_EQ(comparison.in(left.view()).energyRatio, 2);
  EXPECT_EQ(comparison.in(right.view()).mse, 0);
  EXPECT_EQ(comparison.in(right.view()).maxError, 0);
  EXPECT_DOUBLE_EQ(comparison.in().mse, 0.5);
  EXPECT_LT(comparison.in(left.view()).ssim, comparison.in(right.view()).ssim);
  EXPECT_TRUE(std::isnan(comparison.in(none.view()).relMse));
  EXPECT_TRUE(std::isnan(comparison.in(none.view()).maxError));
}

TEST(Metrics, RefuseImagesOfTwoSizes) {
  const core::Planes a(8, 8), b(8, 9);
  EXPECT_THROW(compare(a, Reference(b.view())), core::Error);
}

TEST(Metrics, NameTheFirstPixelThatIsNotFinite) {
  core::Planes image(8, 8, 1.0f);
  const core::Planes good(8, 8, 1.0f);
  image.view().store(5, 3, core::vec3(1, std::numeric_limits<float>::quiet_NaN(), 1));
  image.view().store(2, 4, core::vec3(core::kInfinity));
  try {
    Comparison(image.view(), Reference(good.view()), "test.exr");
    FAIL() << "a NaN passed";
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("test.exr: pixel (5, 3)"), std::string::npos) << e.what();
  }
  EXPECT_THROW(compare(good, Reference(image.view())), core::Error);
  EXPECT_THROW(compare(good, Reference(good.view(), image.view())), core::Error);
}

TEST(Metrics, OfTinyImagesHaveNoSsim) {
  const core::Planes a(10, 10, 1.0f);
  EXPECT_TRUE(std::isnan(compare(a, Reference(a.view())).ssim));
  EXPECT_EQ(compare(a, Reference(a.view())).relMse, 0);
}

TEST(Ssim, IsSymmetricAndFallsWithNoise) {
  const core::Planes a = noise(32, 32, 0), b = noise(32, 32, 1), slight = noise(32, 32, 0, 0.95f);
  const core::Image<double> ab = SsimReference(b.view()).map(a.view()), ba = SsimReference(a.view()).map(b.view());
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_DOUBLE_EQ(ab(x, y), ba(x, y));
  EXPECT_LT(compare(b, Reference(a.view())).ssim, compare(slight, Reference(a.view())).ssim);
}

TEST(Regions, RecentlyFovealFollowsTheMotion) {
  constexpr int kWidth = 16, kHeight = 4;
  core::GuideImages guide(kWidth, kHeight);
  guide.id.fill(1);
  core::Image<std::uint8_t> inside(kWidth, kHeight);
  inside(3, 1) = 1;
  FovealMemory memory(kWidth, kHeight);
  memory.advance(guide.view(), inside);
  EXPECT_EQ(memory.mask(Region::fovea)(3, 1), 1);
  EXPECT_EQ(memory.mask(Region::periphery)(3, 1), 0);
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(3, 1), 0);
  EXPECT_TRUE(memory.mask(Region::full).empty());

  inside.fill(0);
  guide.motion.fill({-2, 0});  // everything came from two pixels to the left
  memory.advance(guide.view(), inside);
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(5, 1), 1);
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(3, 1), 0);
  EXPECT_EQ(memory.mask(Region::periphery)(5, 1), 1);
  EXPECT_EQ(memory.framesSince()(5, 1), 1);
}

TEST(Regions, RecentlyFovealEndsAfterThirtyFramesOrWithItsSurface) {
  core::GuideImages guide(4, 4);
  guide.id.fill(1);
  core::Image<std::uint8_t> inside(4, 4, 1), outside(4, 4);
  FovealMemory memory(4, 4);
  memory.advance(guide.view(), inside);
  for (int frame = 1; frame <= 30; ++frame) {
    memory.advance(guide.view(), outside);
    EXPECT_EQ(memory.mask(Region::recentlyFoveal)(1, 1), 1) << frame;
  }
  memory.advance(guide.view(), outside);
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(1, 1), 0);
  for (int frame = 0; frame < 600; ++frame) memory.advance(guide.view(), outside);
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(1, 1), 0);  // the counter does not wrap

  memory.advance(guide.view(), inside);
  guide.id(1, 1) = 2;  // another surface appears
  memory.advance(guide.view(), outside);
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(1, 1), 0);
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(2, 1), 1);
}

TEST(Regions, MotionThatLeavesTheImageOrIsNotFiniteIsNoHistory) {
  core::GuideImages guide(4, 4);
  guide.id.fill(1);
  core::Image<std::uint8_t> inside(4, 4, 1), outside(4, 4);
  FovealMemory memory(4, 4);
  memory.advance(guide.view(), inside);
  guide.motion(0, 0) = {-1, 0};
  guide.motion(1, 0) = {std::numeric_limits<float>::quiet_NaN(), 0};
  guide.motion(2, 0) = {1e30f, 0};
  memory.advance(guide.view(), outside);
  for (int x = 0; x < 3; ++x) EXPECT_EQ(memory.mask(Region::recentlyFoveal)(x, 0), 0) << x;
  EXPECT_EQ(memory.mask(Region::recentlyFoveal)(3, 0), 1);
}

}  // namespace
}  // namespace experiments
