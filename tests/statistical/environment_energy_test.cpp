// Filtered over raw energy under an environment map with a sun: within 0.98 .. 1.02 over whole sequences, with its
// interval over seeds. A filter that clamps fireflies must fail.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/statistics.h"
#include "experiments/pipeline.h"
#include "experiments/scene_source.h"
#include "tests/environment_maps.h"

namespace {

using experiments::Stage;
using experiments::Variant;

constexpr int kWidth = 160, kHeight = 90, kFrames = 32, kSeeds = 6;

/// Luminance of what the filter works on: without emission and the background, which it never touches.
double luminanceSum(const experiments::Shaded& frame, core::PlanesView<const float> image) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) sum += core::luminance(image.load(x, y) - frame.emission.load(x, y));
  return sum;
}

/// Filtered over raw energy of one sequence, for each variant.
std::vector<double> ratiosOf(const Stage& stage, const std::vector<Variant>& variants, std::uint64_t seed) {
  const experiments::ShadeParameters p;
  experiments::ShadeState shading(stage, p, seed, kWidth, kHeight);
  std::vector<std::unique_ptr<experiments::FilterState>> states;
  for (const Variant& v : variants) states.push_back(std::make_unique<experiments::FilterState>(v, kWidth, kHeight));
  core::Planes image(kWidth, kHeight);
  double raw = 0;
  std::vector<double> sums(variants.size());
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    const experiments::Shaded shaded = shade(stage, p, frame, shading);
    remodulate(shaded.radiance, shaded, image);
    raw += luminanceSum(shaded, image);
    for (std::size_t v = 0; v < variants.size(); ++v) {
      filter(shaded, variants[v], {}, *states[v], image);
      sums[v] += luminanceSum(shaded, image);
    }
  }
  for (double& sum : sums) sum /= raw;
  return sums;
}

std::vector<Variant> variants() {
  std::vector<Variant> all{experiments::variantByName("unweighted"), experiments::variantByName("lag-uw"),
                           experiments::variantByName("unweighted")};
  all[2].name = "clamped";
  all[2].filter.fireflyClamp = 1;
  return all;
}

class EnvironmentEnergy : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EnvironmentEnergy, testing::Values("cornell", "market"));

TEST_P(EnvironmentEnergy, IsKeptByTheFilter) {
  const auto map = tests::environmentFrom(tests::skyMap(128, 64, 92, 20, 2000));  // the sun stands before the box
  const core::Scene scene = experiments::loadScene(GetParam(), {}, map);
  const Stage stage(scene);
  const std::vector<Variant> tested = variants();
  std::vector<std::vector<double>> ratios(tested.size());
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<double> one = ratiosOf(stage, tested, seed);
    for (std::size_t v = 0; v < one.size(); ++v) ratios[v].push_back(one[v]);
  }
  for (std::size_t v = 0; v < tested.size(); ++v) {
    const core::Interval ratio = core::meanInterval(ratios[v]);
    std::printf("%s, %s: %.4f [%.4f, %.4f]\n", GetParam(), tested[v].name.c_str(), ratio.mean, ratio.low, ratio.high);
    std::fflush(stdout);
    if (tested[v].name == "clamped") {
      EXPECT_LT(ratio.high, 0.98);  // control
    } else {
      EXPECT_GT(ratio.low, 0.98) << tested[v].name;
      EXPECT_LT(ratio.high, 1.02) << tested[v].name;
    }
  }
}

}  // namespace
