// Window sums in two passes equal their definition, tap by tap, wherever a block begins; and large areas' trends.
#include "twohistory/drift.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "twohistory/trend.h"

namespace {

using core::ivec2;
using twohistory::DriftBlock;
using twohistory::DriftRow;
using twohistory::DriftSource;
using twohistory::Trend;

constexpr int kWidth = DriftBlock::kWidth + 13, kHeight = DriftBlock::kHeight + 9;
constexpr core::EdgeParameters kEdges;

/// Two instances, holes, and steps of depth and normal, at random.
struct World {
  core::GuideImages guide{kWidth, kHeight};
  std::array<core::Image<float>, 2> value, noise;
  core::Image<float> sampleVariance{kWidth, kHeight}, brightness{kWidth, kHeight};

  World() {
    for (int k = 0; k < 2; ++k)
      value[k] = core::Image<float>(kWidth, kHeight), noise[k] = core::Image<float>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) fill(x, y, core::Rng(5, core::Pass::other, std::uint32_t(y * kWidth + x), 0));
  }

  void fill(int x, int y, core::Rng rng) {
    for (int k = 0; k < 2; ++k) value[k](x, y) = rng.uniform() - 0.4f, noise[k](x, y) = rng.uniform();
    sampleVariance(x, y) = rng.uniform(), brightness(x, y) = rng.uniform();
    if (rng.uniform() < 0.1f) return;  // nothing was hit
    guide.id(x, y) = x + y > 60 ? 1 : 0;
    guide.depth(x, y) = 4 + 0.05f * rng.uniform();
    guide.depthSlope(x, y) = 0.02f * rng.uniform();
    guide.normal.view().store(x, y, normalize(core::vec3(0.1f * rng.uniform(), 0.1f * rng.uniform(), 1)));
  }

  /// What a tap from p to q weighs: along the column first, then along the row.
  float weight(ivec2 p, ivec2 q) const {
    const core::Guide g = guide.view();
    const ivec2 corner{p.x, q.y};
    return core::edgeWeight(g, kEdges, p, corner) * core::edgeWeight(g, kEdges, corner, q);
  }
};

/// The sums of one pixel that a test looks at, in double precision.
struct Sums {
  double weight = 0, weightSquared = 0, sampleVariance = 0, brightness = 0, difference[2]{}, squared[2]{}, noise[2]{};
  double quadrantWeight[4]{}, quadrant[2][4]{};
};

/// Quadrants turn into each other by a quarter turn; the centre is in none.
int quadrantOf(int dx, int dy) {
  for (int q = 0; q < 4; ++q) {
    if (dx > 0 && dy >= 0) return q;
    const int turned = dx;
    dx = dy, dy = -turned;
  }
  return -1;
}

template <class Weight>
Sums sumsOf(const World& world, ivec2 p, int radius, const Weight& weight) {
  Sums s;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const int x = p.x + dx, y = p.y + dy;
      if (x < 0 || x >= kWidth || y < 0 || y >= kHeight) continue;
      const double o = static_cast<double>(weight(p, ivec2{x, y}));
      const int q = quadrantOf(dx, dy);
      s.weight += o, s.weightSquared += o * o;
      s.sampleVariance += o * double(world.sampleVariance(x, y)), s.brightness += o * double(world.brightness(x, y));
      if (q >= 0) s.quadrantWeight[q] += o;
      for (int k = 0; k < 2; ++k) {
        const double d = double(world.value[k](x, y));
        s.difference[k] += o * d, s.squared[k] += o * d * d, s.noise[k] += o * o * double(world.noise[k](x, y));
        if (q >= 0) s.quadrant[k][q] += o * d;
      }
    }
  return s;
}

/// Largest difference of any sum of pixel i of the row from what it should be.
double worstDifference(const DriftRow& row, int i, const Sums& truth) {
  double worst = 0;
  const auto compare = [&](float got, double want) { worst = std::max(worst, std::abs(double(got) - want)); };
  compare(row.weight[i], truth.weight), compare(row.weightSquared[i], truth.weightSquared);
  compare(row.sampleVariance[i], truth.sampleVariance), compare(row.brightness[i], truth.brightness);
  for (int q = 0; q < 4; ++q) compare(row.quadrantWeight[q][i], truth.quadrantWeight[q]);
  for (int k = 0; k < 2; ++k) {
    const auto& of = row.of[k];
    compare(of.difference[i], truth.difference[k]), compare(of.squared[i], truth.squared[k]);
    compare(of.noise[i], truth.noise[k]);
    for (int q = 0; q < 4; ++q) compare(of.quadrant[q][i], truth.quadrant[k][q]);
  }
  return worst;
}

/// Largest difference over the whole image, block by block.
template <class Weight>
double worstOfImage(const World& world, int radius, const Weight& weight) {
  const core::Guide guide = world.guide.view();
  const DriftSource source{guide,
                           kEdges,
                           radius,
                           world.sampleVariance,
                           world.brightness,
                           2,
                           {{{world.value[0], world.noise[0]}, {world.value[1], world.noise[1]}}}};
  double worst = 0;
  for (int y0 = 0; y0 < kHeight; y0 += DriftBlock::kHeight)
    for (int x0 = 0; x0 < kWidth; x0 += DriftBlock::kWidth) {
      const int x1 = std::min(x0 + DriftBlock::kWidth, kWidth), y1 = std::min(y0 + DriftBlock::kHeight, kHeight);
      DriftBlock block(source);
      block.sumRows(x0, x1, y0, y1);
      DriftRow row;
      for (int y = y0; y < y1; ++y) {
        block.sumWindows(y, x0, x1, row);
        for (int x = x0; x < x1; ++x)
          worst = std::max(worst, worstDifference(row, x - x0, sumsOf(world, {x, y}, radius, weight)));
      }
    }
  return worst;
}

TEST(DriftWindow, IsTheSumOverItsTaps) {
  const World world;
  const auto legs = [&](ivec2 p, ivec2 q) { return world.weight(p, q); };
  for (const int radius : {0, 1, 3, 5}) EXPECT_LT(worstOfImage(world, radius, legs), 2e-4) << "radius " << radius;
}

TEST(DriftWindow, ControlWeightsOfTheStraightWayDiffer) {
  const World world;
  const core::Guide guide = world.guide.view();
  const auto straight = [&](ivec2 p, ivec2 q) { return core::edgeWeight(guide, kEdges, p, q); };
  EXPECT_GT(worstOfImage(world, 3, straight), 0.1);
}

constexpr int kSide = 5 * Trend::kTile;

/// Tiles in which histories of ages `gap` apart differ by what `change` of the brightness a frame would make them.
template <class Change, class Gap>
Trend trendOf(const Change& change, const Gap& gap, float noise = 0) {
  Trend trend(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      core::Rng rng(7, core::Pass::other, std::uint32_t(y * kSide + x), 0);
      const float brightness = 0.1f + 5 * rng.uniform();
      trend.tile(x, y)[0].add(change(x, y) * gap(x, y) * brightness + noise * (rng.uniform() - 0.5f), gap(x, y),
                              brightness);
    }
  trend.solve();
  return trend;
}

TEST(Trend, OfAChangeThatAllShareIsFoundWhateverAgesAndBrightnessAre) {
  const auto shared = [](int, int) { return 0.03f; };
  const auto gap = [](int x, int y) { return (x + y) % 3 == 0 ? -4.0f : 20.0f; };
  const Trend exact = trendOf(shared, gap), noisy = trendOf(shared, gap, 10);
  for (const int at : {0, 9, 40, kSide - 1}) {
    EXPECT_NEAR(exact.at(at, 40)[0], 0.03f, 1e-5f);
    EXPECT_NEAR(noisy.at(at, 40)[0], 0.03f, 0.005f);
    EXPECT_EQ(exact.at(at, 40)[1], 0);
  }
}

// Tiles that disagree tell nothing: their mean is then what chance made it.
TEST(Trend, IsNoneWhereTilesDisagree) {
  const auto gap = [](int, int) { return 20.0f; };
  const auto alternating = [](int x, int y) { return (x / Trend::kTile + y / Trend::kTile) % 2 ? 0.03f : -0.03f; };
  const auto single = [](int x, int y) { return x / Trend::kTile == 2 && y / Trend::kTile == 2 ? 0.03f : 0.0f; };
  const auto shared = [](int, int) { return 0.03f; };
  EXPECT_LT(std::abs(trendOf(alternating, gap).at(40, 40)[0]), 0.003f);
  EXPECT_LT(std::abs(trendOf(single, gap).at(40, 40)[0]), 0.003f);
  EXPECT_GT(std::abs(trendOf(shared, gap).at(40, 40)[0]), 0.029f);  // control: the same size, all alike
}

}  // namespace
