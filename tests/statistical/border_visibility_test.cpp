// No step of the mean shows where the fovea is or was, for histories of which none weighs samples: under a fast pulse
// of the light, the step of the mean image stays below the 1 % of Weber contrast from which it counts as visible
// (experiments/border.h). The controls are blends that step, and must be seen to.
#include <gtest/gtest.h>

#include "core/statistics.h"
#include "experiments/lab/lab.h"

namespace {

using experiments::Json;
namespace lab = experiments::lab;

constexpr double kConfidence = 0.99;

const experiments::Results& results() {
  static const experiments::Results r = [] {
    const Json camera = {{"x", 0.37}, {"y", 0.21}}, pulse = {{"kind", "pulse"}, {"period", 32}};
    const Json config = {
        {"seeds", {21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32}},
        {"variants", {"unweighted", "weighted", "lag-debiased", "lag-even"}},
        {"cases",
         {{{"name", "moving"}, {"signal", pulse}, {"motion", camera}},
          {{"name", "still"}, {"signal", pulse}, {"motion", camera}, {"pattern", {{"gaze", {{"kind", "fixed"}}}}}}}}};
    return lab::runLab(lab::labConfigFrom(config, {}, ""));
  }();
  return r;
}

/// Squared contrast of the step in the mean image.
core::Interval contrast2(const std::string& scene, const std::string& variant, const std::string& region) {
  core::RunningMoments seeds;
  for (const experiments::Row& r : results().rows)
    if (r.scene == scene && r.variant == variant && r.region == region && r.metric == "border_contrast2")
      seeds.add(r.value);
  return core::meanInterval(seeds, kConfidence);
}

constexpr double kVisible = 0.01 * 0.01;

TEST(Border, DoesNotShowWhereNoHistoryWeighsSamples) {
  for (const char* region : {"fovea", "recently_foveal"}) {
    EXPECT_LT(contrast2("moving", "lag-even", region).high, kVisible) << region;
    EXPECT_GT(contrast2("moving", "lag-debiased", region).low, kVisible) << region;   // control
    EXPECT_GT(contrast2("moving", "weighted", region).low, 25 * kVisible) << region;  // control
  }
  EXPECT_LT(contrast2("still", "lag-even", "fovea").high, kVisible);
  EXPECT_GT(contrast2("still", "lag-debiased", "fovea").low, kVisible);  // control
}

}  // namespace
