// Edge weights: the row kernel and the single pair are one formula; exp is exact enough.
#include "core/edge_weight.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace {

TEST(ExpNegative, HasSevenDigitsOverItsRange) {
  for (double x = 0; x > -86.9; x -= 1e-3) {
    const auto argument = static_cast<float>(x);
    const double truth = std::exp(static_cast<double>(argument));
    ASSERT_NEAR(core::expNegative(argument) / truth, 1, 3e-7) << x;
  }
  EXPECT_EQ(core::expNegative(0), 1);
  EXPECT_GE(core::expNegative(-1e30f), 0);
  EXPECT_LT(core::expNegative(-core::kInfinity), 1e-37f);
}

core::GuideImages randomGuide(int width, int height) {
  core::GuideImages g(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      core::Rng rng(5, core::Pass::other, static_cast<std::uint32_t>(y * width + x), 0);
      if (rng.uniform() < 0.2f) continue;  // nothing was hit
      g.id(x, y) = rng.below(3);
      g.depth(x, y) = 4 + 0.05f * rng.uniform();
      g.depthSlope(x, y) = 0.02f * rng.uniform();
      g.normal.view().store(x, y, normalize(core::vec3(0.1f * rng.uniform(), 0.1f * rng.uniform(), 1)));
    }
  return g;
}

TEST(EdgeWeight, RowKernelAndSinglePairAgree) {
  const core::GuideImages images = randomGuide(61, 23);
  const core::Guide guide = images.view();
  float exponent[core::kBlock], factor[core::kBlock];
  int positive = 0;
  for (int y = 3; y < 20; ++y)
    for (int dy = -3; dy <= 3; ++dy)
      for (int dx = -3; dx <= 3; ++dx) {
        core::edgeTerms(guide, {}, y, dx, dy, 3, 58, exponent, factor);
        for (int x = 3; x < 58; ++x) {
          const float row = factor[x - 3] * core::expNegative(-exponent[x - 3]);
          const float single = core::edgeWeight(guide, {}, {x, y}, {x + dx, y + dy});
          ASSERT_NEAR(row, single, 2e-6f) << x << ", " << y;
          positive += single > 1e-3f;
        }
      }
  EXPECT_GT(positive, 1000);
}

TEST(EdgeWeight, IsZeroAcrossInstancesAndWhereNothingWasHit) {
  core::GuideImages g = randomGuide(4, 1);
  g.id(0, 0) = 1, g.id(1, 0) = 2, g.id(2, 0) = core::kNoId, g.id(3, 0) = core::kNoId;
  EXPECT_EQ(core::edgeWeight(g.view(), {}, {0, 0}, {1, 0}), 0);
  EXPECT_EQ(core::edgeWeight(g.view(), {}, {2, 0}, {3, 0}), 0);
  EXPECT_EQ(core::edgeWeight(g.view(), {}, {0, 0}, {0, 0}), 1);
}

}  // namespace
