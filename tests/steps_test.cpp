// What is remembered of past steps, and what predicted variances gain by it, against exact covariances in a row.
#include "twohistory/steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "twohistory/history.h"
#include "twohistory/mean.h"

namespace {

using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::StepTiles;
using twohistory::Taps;
using twohistory::Weighting;

constexpr int kWidth = 96, kHeight = 48;

/// Taps of a pixel whose content came from `left` and `up` pixels away; pixels from beyond the edge have none.
Taps from(int x, int y, float left, float up) {
  const float u = static_cast<float>(x) - left, v = static_cast<float>(y) - up;
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  const float a = u - static_cast<float>(i), b = v - static_cast<float>(j);
  if (i < 0 || j < 0 || i + (a > 0) >= kWidth || j + (b > 0) >= kHeight) return {};
  const std::int32_t corner = j * kWidth + i, right = a > 0 ? 1 : 0, below = b > 0 ? kWidth : 0;
  return {{corner, corner + right, corner + below, corner + right + below},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
}

/// moved(x, y): how far a pixel's content came, pixels.
core::Image<Taps> tapsOf(const std::function<core::vec2(int, int)>& moved) {
  core::Image<Taps> taps(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) taps(x, y) = from(x, y, moved(x, y).x, moved(x, y).y);
  return taps;
}

float stepOf(float fraction) { return 2 * fraction * (1 - fraction); }

twohistory::WalkSteps<float> at(const StepTiles& steps, int x, int y) { return steps.at(y * kWidth + x); }

TEST(StepTiles, KnowWhatKeepsMovingAndWhatNeverDid) {
  StepTiles steps(kWidth, kHeight);
  EXPECT_EQ(at(steps, 50, 20).x, 0);
  steps.update(tapsOf([](int, int) { return core::vec2(0); }));
  EXPECT_EQ(at(steps, 50, 20).x, 0);
  StepTiles moving(kWidth, kHeight);
  for (int f = 0; f < 3; ++f) moving.update(tapsOf([](int, int) { return core::vec2(2.5f, 0.25f); }));
  EXPECT_NEAR(at(moving, 50, 20).x, stepOf(0.5f), 1e-6f);  // from the first frame on, not only in the end
  EXPECT_NEAR(at(moving, 50, 20).y, stepOf(0.25f), 1e-6f);
  EXPECT_LT(static_cast<double>(steps.bytes()) / (kWidth * kHeight), 0.1);
}

TEST(StepTiles, ForgetWhatIsLongAgo) {
  StepTiles steps(kWidth, kHeight);
  for (int f = 0; f < 40; ++f) steps.update(tapsOf([](int, int) { return core::vec2(0); }));
  float before = 0;
  for (int f = 1; f <= 12; ++f) {
    steps.update(tapsOf([](int, int) { return core::vec2(0.5f, 0); }));
    EXPECT_NEAR(at(steps, 60, 20).x, 0.5f * (1 - std::pow(0.75f, static_cast<float>(f))), 1e-4f);  // [ledger step]
    EXPECT_GT(at(steps, 60, 20).x, before);
    before = at(steps, 60, 20).x;
  }
}

TEST(StepTiles, AreNotSlowedByWhatStandsBesideWhatMoves) {
  StepTiles steps(kWidth, kHeight);
  for (int f = 0; f < 4; ++f) steps.update(tapsOf([](int x, int) { return core::vec2(x % 8 < 4 ? 0.5f : 0.0f, 0); }));
  EXPECT_NEAR(at(steps, 60, 20).x, 0.5f, 1e-5f);
}

/// A band of three columns of tiles moves 16.5 pixels a frame over what stands; steps at its middle column.
float stepsOfABand(int frames, bool atItself) {
  StepTiles steps(kWidth, kHeight);
  for (int f = 1; f <= frames; ++f) {
    const float left = 16.5f * static_cast<float>(f) - 48;
    steps.update(tapsOf([&](int x, int) {
      const float here = static_cast<float>(x);
      return core::vec2(here >= left && here < left + 48 ? 16.5f : 0.0f, 0);
    }));
  }
  const int middle = static_cast<int>(16.5f * static_cast<float>(frames)) - 24;
  return at(steps, atItself ? middle : middle - 48, 20).x;
}

TEST(StepTiles, MoveWithTheImage) {
  EXPECT_NEAR(stepsOfABand(5, true), 0.5f, 0.02f);
  EXPECT_LT(stepsOfABand(5, false), 0.25f);  // control: where the band has been
}

TEST(StepTiles, AreNotSlowedByATileThatIsNewBesideThem) {
  StepTiles steps(kWidth, kHeight);
  core::Image<Taps> taps = tapsOf([](int, int) { return core::vec2(0.5f, 0); });
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < StepTiles::kSide; ++x) taps(x, y) = {};
  steps.update(taps);
  EXPECT_NEAR(at(steps, StepTiles::kSide, 20).x, 0.5f, 1e-5f);  // between both tiles' middles
}

TEST(StepTiles, HaveNothingWhereTheImageIsNew) {
  StepTiles steps(kWidth, kHeight);
  for (int f = 0; f < 3; ++f) steps.update(tapsOf([](int, int) { return core::vec2(0.5f); }));
  steps.update(core::Image<Taps>(kWidth, kHeight));  // a cut: no taps
  EXPECT_EQ(at(steps, 60, 20).x, 0);
  StepTiles tiny(1, 1);
  core::Image<Taps> one(1, 1);
  one(0, 0) = twohistory::stillTap(0);
  tiny.update(one);
  EXPECT_EQ(tiny.at(0).x, 0);
}

/// Exact variance of a history with the given decay, in a row that moves by moved[f] and gets one sample of variance 1
/// a pixel and frame: the recursion of covariances of pixels n apart (docs/history.md, "How alike neighbours are").
double exactVariance(const std::vector<float>& moved, double decay) {
  constexpr int kReach = 80;
  std::vector<double> now(2 * kReach + 1, 0.0), next = now;
  double weight = 0;
  for (const float m : moved) {
    const double fraction = double(m) - std::floor(double(m)), s = 2 * fraction * (1 - fraction);
    for (int n = 1; n < 2 * kReach; ++n)
      next[n] = decay * decay * ((1 - s) * now[n] + s / 2 * (now[n - 1] + now[n + 1]));
    next[kReach] += 1;
    std::swap(now, next);
    weight = decay * weight + 1;
  }
  return now[kReach] / (weight * weight);
}

/// The library's prediction in the middle of an image, by remembered or guessed steps.
double predictedVariance(const std::vector<float>& moved, double decay, bool remembers) {
  const twohistory::Policies<1> policies{Policy{Weighting::frames, Forgetting::decay, decay}};
  core::Image<Ledger<1>> before(kWidth, kHeight), now = before;
  StepTiles steps(kWidth, kHeight);
  for (const float m : moved) {
    const core::Image<Taps> taps = tapsOf([&](int, int) { return core::vec2(m, 0); });
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const auto old = remembers ? gather<1, float>(taps(x, y), before, policies, 1.0f, steps)
                                   : gather<1, float>(taps(x, y), before, policies, 1.0f);
        now(x, y) = advance(old, policies, 1.0f);
      }
    steps.update(taps);
    std::swap(before, now);
  }
  return static_cast<double>(before(kWidth - 8, kHeight / 2).covariance(0, 0));
}

TEST(RememberedSteps, ReachLedgersThroughAccumulate) {
  const twohistory::Policies<1> policies{Policy{Weighting::frames, Forgetting::decay, 0.95}};
  core::Image<Ledger<1>> before(kWidth, kHeight), now = before;
  core::Image<float> value(kWidth, kHeight), next = value, count(kWidth, kHeight, 1);
  StepTiles steps(kWidth, kHeight);
  const std::vector<float> moved{0, 0, 0, 0.4f, 0.4f, 0.4f};
  for (const float m : moved) {
    const core::Image<Taps> taps = tapsOf([&](int, int) { return core::vec2(m, 0); });
    twohistory::accumulate<1>(taps.view(), count.view(), policies, before.view(), now.view(), twohistory::Mean<float>{},
                              std::array<core::In<float>, 1>{value}, count.view(),
                              std::array<core::ImageView<float>, 1>{next}, core::kDefaultTile, steps);
    steps.update(taps);
    std::swap(before, now), std::swap(value, next);
  }
  EXPECT_EQ(before(kWidth - 8, kHeight / 2).covariance(0, 0), predictedVariance(moved, 0.95, true));
  EXPECT_NE(before(kWidth - 8, kHeight / 2).covariance(0, 0), predictedVariance(moved, 0.95, false));  // control
}

/// Frames of rest, of motion by `fraction`, and of rest again; or moving by it in every other frame.
std::vector<float> course(int rest, int motion, int after, float fraction, bool byTurns = false) {
  std::vector<float> moved(static_cast<std::size_t>(rest), 0.0f);
  for (int f = 0; f < motion; ++f) moved.push_back(byTurns && f % 2 ? 0.0f : fraction);
  moved.resize(moved.size() + static_cast<std::size_t>(after), 0.0f);
  return moved;
}

TEST(RememberedSteps, PredictVariancesOfMotionThatBeginsKeepsOnAndEnds) {
  double low = 9, high = 0, guessLow = 9, guessHigh = 0;
  for (const float fraction : {0.05f, 0.2f, 0.5f})
    for (const double decay : {0.5, 0.8, 0.95, 0.98})
      for (const auto& moved : {course(40, 1, 0, fraction), course(40, 2, 0, fraction), course(40, 4, 0, fraction),
                                course(40, 10, 0, fraction), course(1, 40, 0, fraction), course(1, 30, 10, fraction),
                                course(1, 40, 0, fraction, true)}) {
        const double exact = exactVariance(moved, decay);
        const double ratio = exact / predictedVariance(moved, decay, true);
        const double guess = exact / predictedVariance(moved, decay, false);
        low = std::min(low, ratio), high = std::max(high, ratio);
        guessLow = std::min(guessLow, guess), guessHigh = std::max(guessHigh, guess);
      }
  std::printf("exact over predicted variance: %.3f .. %.3f; by a guess of past steps %.3f .. %.3f\n", low, high,
              guessLow, guessHigh);
  EXPECT_GT(low, 0.8);
  EXPECT_LT(high, 1.25);
  EXPECT_LT(guessLow, 0.7);  // control
}

}  // namespace
