// When parts of an image came in over its edge, and what predicted variances gain by it, against exact covariances in a
// row that has an edge.
#include "twohistory/arrivals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "twohistory/ledger.h"
#include "twohistory/walk_memory.h"

namespace {

using core::vec2;
using twohistory::Arrival;
using twohistory::ArrivalGrid;
using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::Taps;
using twohistory::WalkMemory;
using twohistory::Weighting;

constexpr int kWidth = 98, kHeight = 51;  // not whole steps of the grid

/// Where a pixel's content came from, `moved` pixels back: what lies inside, weighing 1 together, as reprojection has
/// it.
Taps from(int x, int y, vec2 moved) {
  const vec2 p = vec2(x, y) - moved, corner = glm::floor(p), f = p - corner;
  Taps t;
  float sum = 0;
  for (int k = 0; k < 4; ++k) {
    const int u = static_cast<int>(corner.x) + k % 2, v = static_cast<int>(corner.y) + k / 2;
    if (u < 0 || v < 0 || u >= kWidth || v >= kHeight) continue;
    t.pixel[k] = v * kWidth + u;
    sum += t.b[k] = (k % 2 ? f.x : 1 - f.x) * (k / 2 ? f.y : 1 - f.y);
  }
  for (float& b : t.b) b = sum > 0 ? b / sum : 0.0f;
  return t;
}

core::Image<Taps> tapsOf(vec2 moved) {
  core::Image<Taps> taps(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) taps(x, y) = from(x, y, moved);
  return taps;
}

ArrivalGrid after(const std::vector<vec2>& moved) {
  ArrivalGrid grid(kWidth, kHeight);
  for (const vec2 m : moved) grid.update(tapsOf(m));
  return grid;
}

Arrival at(const ArrivalGrid& grid, int x, int y) {
  return grid.at(twohistory::stillTap(y * kWidth + x), core::ivec2(x, y));
}

TEST(Arrivals, AreDistancesOverSpeedWhereMotionIsSteady) {
  const ArrivalGrid right = after(std::vector<vec2>(400, vec2(0.5f, 0)));
  for (const int x : {0, 1, 6, 8, 23, 40}) {
    EXPECT_NEAR(at(right, x, 20).x, 2.0f * static_cast<float>(x), 0.25f) << x;  // [ledger arrival], rounded
    EXPECT_EQ(at(right, x, 20).y, Arrival::kLongAgo);
  }
  EXPECT_EQ(at(right, 90, 20).x, Arrival::kLongAgo);
  const ArrivalGrid upLeft = after(std::vector<vec2>(400, vec2(-0.25f, -0.8f)));
  EXPECT_NEAR(at(upLeft, kWidth - 1 - 5, 20).x, 20, 0.05f);
  EXPECT_NEAR(at(upLeft, 40, kHeight - 1 - 12).y, 15, 0.05f);
}

TEST(Arrivals, AreCarriedAlongAndAgeAtRest) {
  std::vector<vec2> moved(400, vec2(0.5f, 0));
  moved.resize(moved.size() + 10, vec2(0));
  EXPECT_NEAR(at(after(moved), 8, 20).x, 26, 0.05f);
  moved.resize(moved.size() + 10, vec2(0.5f, 0));
  EXPECT_NEAR(at(after(moved), 12, 20).x, 24 + 9.5f, 2.5f);  // 34 without the rounding of the grid
  moved.assign(400, vec2(0.5f, 0)), moved.resize(moved.size() + 2, vec2(3, 5));
  EXPECT_NEAR(at(after(moved), 16, 20).x, 22, 0.05f);
}

TEST(Arrivals, BeginAtTheEdgeWhenMotionDoes) {
  std::vector<vec2> moved(20, vec2(0));
  EXPECT_TRUE(at(after(moved), 0, 20).isLongAgo());
  moved.resize(24, vec2(0.5f, 0));
  const ArrivalGrid grid = after(moved);
  EXPECT_EQ(at(grid, 0, 20).x, 0);
  EXPECT_GT(at(grid, 8, 20).x, 100);
  moved.resize(124, vec2(0.5f, 0));
  EXPECT_NEAR(at(after(moved), 8, 20).x, 16, 0.5f);
}

TEST(Arrivals, AreNoneByWholePixelsWithoutHistoryOrInTheSmallestImages) {
  EXPECT_TRUE(at(after(std::vector<vec2>(50, vec2(1, 0))), 0, 20).isLongAgo());
  EXPECT_TRUE(at(after(std::vector<vec2>(50, vec2(2.5f, -1.5f))), 1, 20).isLongAgo());
  ArrivalGrid cut = after(std::vector<vec2>(50, vec2(0.5f, 0)));
  cut.update(core::Image<Taps>(kWidth, kHeight));
  EXPECT_TRUE(at(cut, 2, 20).isLongAgo());
  for (const core::ivec2 size : {core::ivec2(1, 1), core::ivec2(2, 1), core::ivec2(1, 5), core::ivec2(17, 3)}) {
    ArrivalGrid tiny(size.x, size.y);
    core::Image<Taps> taps(size.x, size.y);
    for (int i = 0; i < size.x * size.y; ++i) taps.data()[i] = twohistory::stillTap(i);
    tiny.update(taps);
    EXPECT_TRUE(tiny.at(twohistory::stillTap(size.x * size.y - 1), size - 1).isLongAgo());
  }
  EXPECT_LT(static_cast<double>(cut.bytes()) / (kWidth * kHeight), 0.6);
}

TEST(Arrivals, SurvivalIsTheDecaysPower) {
  for (const double decay : {0.5, 0.95, 0.98})
    for (const float frames : {0.0f, 1.0f, 7.0f, 100.0f})
      EXPECT_NEAR(twohistory::survival(1 / (decay * decay) - 1, frames), std::pow(decay, 2 * double(frames)), 1e-12);
  EXPECT_NEAR(twohistory::survival(1 / 0.96 - 1, 3.5f), 0.5 * (std::pow(0.96, 3) + std::pow(0.96, 4)), 1e-6);
  EXPECT_EQ(twohistory::survival(1e-12, Arrival::kLongAgo), 0);
  EXPECT_GT(twohistory::survival(1e6f, 1e-3f), 0);
}

constexpr int kMargin = 32;  ///< pixels beside the edge

/// Exact mean variance beside the edge of a row that moves to the right by moved[f], with one sample of variance 1 a
/// pixel and frame: the row's covariance matrix; its first pixel has nothing but itself.
double exactVariance(const std::vector<float>& moved, double decay) {
  using Row = std::vector<double>;
  std::vector<Row> now(kWidth, Row(kWidth, 0.0)), half = now;
  double weight = 0;
  for (const float m : moved) {
    const auto mixed = [&](double self, double left) { return decay * ((1 - double(m)) * self + double(m) * left); };
    for (int i = 0; i < kWidth; ++i)
      for (int j = 0; j < kWidth; ++j) half[i][j] = mixed(now[i][j], now[i][std::max(0, j - 1)]);
    for (int i = 0; i < kWidth; ++i)
      for (int j = 0; j < kWidth; ++j) now[i][j] = mixed(half[i][j], half[std::max(0, i - 1)][j]) + (i == j);
    weight = decay * weight + 1;
  }
  double sum = 0;
  for (int i = 0; i < kMargin; ++i) sum += now[i][i] / (weight * weight) / kMargin;
  return sum;
}

/// Control.
struct WithoutArrivals : WalkMemory {
  using WalkMemory::WalkMemory;
  twohistory::RememberedWalk operator()(const Taps& taps, const twohistory::TapPairs& pairs) const {
    twohistory::RememberedWalk walk = WalkMemory::operator()(taps, pairs);
    walk.arrival = {};
    return walk;
  }
};

/// The library's prediction. Memory: WalkMemory, or the control.
template <class Memory>
double predictedVariance(const std::vector<float>& moved, double decay) {
  const twohistory::Policies<1> policies{Policy{Weighting::frames, Forgetting::decay, decay}};
  core::Image<Ledger<1>> before(kWidth, kHeight), now = before;
  Memory memory(kWidth, kHeight);
  for (const float m : moved) {
    const core::Image<Taps> taps = tapsOf(vec2(m, 0));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        now(x, y) = advance(gather<1, float>(taps(x, y), before, policies, 1.0f, memory), policies, 1.0f);
    memory.update(taps, core::Image<float>(kWidth, kHeight, 1));
    std::swap(before, now);
  }
  double sum = 0;
  for (int x = 0; x < kMargin; ++x) sum += double(before(x, kHeight / 2).covariance(0, 0)) / kMargin;
  return sum;
}

TEST(Arrivals, PredictVariancesBesideTheEdge) {
  double low = 9, high = 0, controlHigh = 0;
  for (const float speed : {0.1f, 0.3f, 0.5f, 0.7f, 0.9f})
    for (const double decay : {0.8, 0.95, 0.98})
      for (const int rest : {1, 60}) {
        std::vector<float> moved(static_cast<std::size_t>(rest), 0.0f);
        moved.resize(90, speed);
        const double exact = exactVariance(moved, decay), ratio = exact / predictedVariance<WalkMemory>(moved, decay);
        low = std::min(low, ratio), high = std::max(high, ratio);
        controlHigh = std::max(controlHigh, exact / predictedVariance<WithoutArrivals>(moved, decay));
      }
  std::printf("exact over predicted variance: %.3f .. %.3f; without arrivals up to %.3f\n", low, high, controlHigh);
  EXPECT_GT(low, 0.93);
  EXPECT_LT(high, 1.1);
  EXPECT_GT(controlHigh, 1.35);  // control
}

}  // namespace
