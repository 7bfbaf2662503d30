// Every tap is validated by itself: bounds, instance, depth, normal.
#include "twohistory/reprojection.h"

#include <gtest/gtest.h>

namespace {

using core::GuideImages;
using core::Image;
using core::vec2;
using core::vec3;
using twohistory::Taps;

/// A frontal plane that fills the image.
GuideImages plane(int width, int height, float depth = 5) {
  GuideImages g(width, height);
  g.depth.fill(depth);
  g.id.fill(3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) g.normal.view().store(x, y, vec3(0, 0, 1));
  return g;
}

Image<Taps> tapsOf(const GuideImages& now, const GuideImages& before) {
  Image<Taps> taps(now.depth.width(), now.depth.height());
  twohistory::reproject(now.view(), before.view(), {}, taps);
  return taps;
}

float sum(const Taps& t) { return t.b[0] + t.b[1] + t.b[2] + t.b[3]; }

TEST(Reprojection, WholePixelMotionIsOneTapExactly) {
  GuideImages now = plane(8, 6);
  now.motion.fill(vec2(2, -1));
  const Image<Taps> taps = tapsOf(now, plane(8, 6));
  EXPECT_EQ(taps(3, 4).pixel[0], 3 * 8 + 5);
  EXPECT_EQ(taps(3, 4).b, (std::array<float, 4>{1, 0, 0, 0}));
}

TEST(Reprojection, FractionalMotionIsBilinear) {
  GuideImages now = plane(8, 6);
  now.motion.fill(vec2(0.25f, 0.5f));
  const Taps t = tapsOf(now, plane(8, 6))(3, 2);
  EXPECT_FLOAT_EQ(t.b[0], 0.75f * 0.5f);
  EXPECT_FLOAT_EQ(t.b[1], 0.25f * 0.5f);
  EXPECT_EQ(t.pixel[3], 3 * 8 + 4);
}

TEST(Reprojection, EveryTapHasItsOwnBoundsTest) {
  // Public implementations test the same pixel four times and so read across the border.
  GuideImages now = plane(8, 6);
  now.motion.fill(vec2(0.5f, 0.5f));
  const Taps t = tapsOf(now, plane(8, 6))(7, 5);
  EXPECT_EQ(t.b, (std::array<float, 4>{1, 0, 0, 0}));
}

TEST(Reprojection, TapsOnOtherSurfacesAreLeftOutAndTheRestRenormalised) {
  GuideImages now = plane(8, 6), before = plane(8, 6);
  now.motion.fill(vec2(0.5f, 0.5f));
  before.id(4, 3) = 9;                              // another instance
  before.depth(5, 3) = 9;                           // far behind
  before.normal.view().store(4, 4, vec3(1, 0, 0));  // turned away
  const Taps t = tapsOf(now, before)(4, 3);
  EXPECT_EQ(t.b, (std::array<float, 4>{0, 0, 0, 1}));
  before.id(5, 4) = 9;
  EXPECT_FALSE(tapsOf(now, before)(4, 3).valid());
}

TEST(Reprojection, DepthIsComparedWithWhatTheSurfaceHadThen) {
  GuideImages now = plane(8, 6, 5), before = plane(8, 6, 6);  // the camera moved one unit closer
  EXPECT_FALSE(tapsOf(now, before)(3, 3).valid());
  now.depthChange.fill(1);
  EXPECT_TRUE(tapsOf(now, before)(3, 3).valid());
}

TEST(Reprojection, MotionOutsideOrNotFiniteMeansNoHistory) {
  for (const float m : {100.0f, -100.0f, 3e9f, std::numeric_limits<float>::infinity(),
                        -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    GuideImages now = plane(8, 6);
    now.motion.fill(vec2(m, 0));
    EXPECT_FALSE(tapsOf(now, plane(8, 6))(3, 3).valid()) << m;
  }
}

TEST(Reprojection, PixelsWithoutSurfaceHaveNoHistory) {
  GuideImages now = plane(8, 6);
  now.id(2, 2) = core::kNoId;
  now.depth(2, 2) = core::kInfinity;
  const Image<Taps> taps = tapsOf(now, plane(8, 6));
  EXPECT_FALSE(taps(2, 2).valid());
  EXPECT_NEAR(sum(taps(3, 3)), 1, 1e-6);
}

TEST(ChooseTap, StochasticFollowsTheWeightsAndNeverTakesAnInvalidTap) {
  const Taps t{{0, 1, 2, 3}, {0.5f, 0, 0.25f, 0.25f}};
  std::array<int, 4> counts{};
  for (int i = 0; i < 1000; ++i)
    ++counts[twohistory::chooseTap(t, twohistory::Choice::stochastic, (i + 0.5f) / 1000).pixel[0]];
  EXPECT_EQ(counts, (std::array<int, 4>{500, 0, 250, 250}));
  EXPECT_EQ(twohistory::chooseTap(t, twohistory::Choice::best, 0).pixel[0], 0);
  EXPECT_EQ(twohistory::chooseTap({{0, 1, 2, 3}, {0.5f, 0.5f, 0, 0}}, twohistory::Choice::stochastic, 1.0f).pixel[0],
            1);
}

}  // namespace
