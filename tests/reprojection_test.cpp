// Every tap is validated by itself: bounds, instance, depth, normal.
#include "twohistory/reprojection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "twohistory/history.h"
#include "twohistory/mean.h"

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

Image<Taps> tapsOf(const GuideImages& now, const GuideImages& before,
                   const twohistory::ReprojectionParameters& parameters = {}) {
  Image<Taps> taps(now.depth.width(), now.depth.height());
  twohistory::reproject(now.view(), before.view(), parameters, taps);
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

TEST(Reprojection, AnEdgeThatForgetsLeavesBehindWhatLiesBeyondIt) {
  GuideImages now = plane(8, 6), before = plane(8, 6);
  now.motion.fill(vec2(0.5f, 0.25f));
  before.id(4, 3) = 9;
  twohistory::ReprojectionParameters p;
  p.edgeReach = 4;
  const Image<Taps> taps = tapsOf(now, before, p);
  EXPECT_FLOAT_EQ(taps(7, 2).carried, 1 - 0.5f / 4);                  // right edge
  EXPECT_FLOAT_EQ(taps(2, 5).carried, 1 - 0.25f / 4);                 // lower edge
  EXPECT_FLOAT_EQ(taps(7, 5).carried, 1 - (1 - 0.5f * 0.75f) / 4);    // corner
  for (int x = 0; x < 7; ++x) EXPECT_EQ(taps(x, 2).carried, 1) << x;  // another surface is not an edge
  p.edgeReach = 1;
  EXPECT_FLOAT_EQ(tapsOf(now, before, p)(7, 5).carried, 0.5f * 0.75f);  // what was inside
  now.motion.fill(vec2(1, 0));
  EXPECT_EQ(tapsOf(now, before, p)(6, 2).carried, 1);  // all of it in the last column
  now.motion.fill(vec2(0.5f));
  EXPECT_EQ(tapsOf(now, before)(7, 5).carried, 1);  // unless told so, the edge forgets nothing
}

/// How far, in pixels and on average, what the first column remembers lies from what it shows after 400 frames in which
/// the image moves to the right by `moved` pixels each; every frame shows where on the image it is.
float memoryOfFirstColumn(float moved, const twohistory::ReprojectionParameters& p) {
  constexpr int kSide = 8;
  GuideImages now = plane(kSide, kSide);
  now.motion.fill(vec2(-moved, 0));
  const Image<Taps> taps = tapsOf(now, plane(kSide, kSide), p);
  const twohistory::Policies<1> policies{{{twohistory::Weighting::frames, twohistory::Forgetting::decay, 0.98}}};
  const Image<float> count(kSide, kSide, 1);
  Image<float> before(kSide, kSide), after(kSide, kSide), shown(kSide, kSide);
  Image<twohistory::Ledger<1>> ledger(kSide, kSide), next(kSide, kSide);
  constexpr int kFrames = 400;
  for (int f = 0; f < kFrames; ++f) {
    for (int i = 0; i < kSide * kSide; ++i)
      shown.data()[i] = static_cast<float>(i % kSide) - moved * static_cast<float>(f);
    twohistory::accumulate<1>(taps.view(), count.view(), policies, ledger.view(), next.view(),
                              twohistory::Mean<float>{}, std::array{before.view()}, shown.view(),
                              std::array{after.view()});
    std::swap(before, after), std::swap(ledger, next);
  }
  return before(0, 4) - shown(0, 4);
}

TEST(Reprojection, AnEdgeThatForgetsRemembersNoFurtherThanItsReach) {
  twohistory::ReprojectionParameters p;
  p.edgeReach = 8;
  for (const float moved : {0.1f, 0.5f, 0.9f}) {
    EXPECT_LT(memoryOfFirstColumn(moved, p), 8) << moved;
    EXPECT_GT(memoryOfFirstColumn(moved, p), 1) << moved;
  }
  EXPECT_NEAR(memoryOfFirstColumn(0.5f, {}), 0.5f * 0.98f / 0.02f, 0.1f);  // control: 49 frames of half a pixel
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
