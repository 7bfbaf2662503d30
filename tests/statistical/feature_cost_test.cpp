// What a scene lacks costs nothing: kernels compiled for what it has against kernels compiled for everything. The bits
// are the same; the times are compared frame by frame within one run, as medians.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>

#include "core/statistics.h"
#include "experiments/pipeline.h"
#include "experiments/scene_source.h"

namespace {

using experiments::Features;
using experiments::ShadeParameters;
using experiments::ShadeState;

constexpr int kWidth = 320, kHeight = 180, kFrames = 31;

ShadeParameters parametersFor(Features features) {
  ShadeParameters p;
  p.features = features;
  p.restir.features = features == Features::all ? restir::Features::all : restir::Features::automatic;
  return p;
}

double milliseconds(const experiments::Stage& stage, const ShadeParameters& p, std::uint32_t frame, ShadeState& state,
                    core::PlanesView<const float>& radiance) {
  const auto start = std::chrono::steady_clock::now();
  radiance = shade(stage, p, frame, state).radiance;
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

bool sameBits(core::PlanesView<const float> a, core::PlanesView<const float> b) {
  for (int c = 0; c < 3; ++c)
    if (std::memcmp(a.plane[c].data, b.plane[c].data, sizeof(float) * kWidth * kHeight) != 0) return false;
  return true;
}

class FeatureCost : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, FeatureCost, testing::Values("cornell", "ajar", "market"));

TEST_P(FeatureCost, OfWhatTheSceneLacksIsNothing) {
  const core::Scene scene = experiments::loadScene(GetParam());
  const experiments::Stage stage(scene);
  const ShadeParameters lean = parametersFor(Features::automatic), full = parametersFor(Features::all);
  ShadeState leanState(stage, lean, 1, kWidth, kHeight), fullState(stage, full, 1, kWidth, kHeight);
  std::vector<double> ratios;
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    core::PlanesView<const float> a, b;
    double leanTime, fullTime;
    if (frame % 2 == 0) {
      leanTime = milliseconds(stage, lean, frame, leanState, a);
      fullTime = milliseconds(stage, full, frame, fullState, b);
    } else {
      fullTime = milliseconds(stage, full, frame, fullState, b);
      leanTime = milliseconds(stage, lean, frame, leanState, a);
    }
    ASSERT_TRUE(sameBits(a, b)) << "frame " << frame;
    if (frame > 0) ratios.push_back(leanTime / fullTime);
  }
  const double ratio = core::median(ratios);
  std::printf("%s: frame time, features the scene has over all features: %.3f\n", GetParam(), ratio);
  EXPECT_LT(ratio, 1.05);  // noise of a shared machine on top of 1
}

}  // namespace
