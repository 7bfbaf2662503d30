// How alike taps are: the random walk's closed form against the recursion that it solves, and what mixing must keep.
#include "twohistory/mixing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"
#include "twohistory/ledger.h"

namespace {

using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::TapPairs;
using twohistory::Taps;
using twohistory::Weighting;

Taps tapsAt(float x, float y, int width) {
  return {{0, 1, width, width + 1}, {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}};
}

/// Stationary covariances on a torus of side n (n x 1 in a row) of an image that every frame moves by (x, y) pixels and
/// keeps the share D of its covariances, and to which every pixel adds noise of variance 1.
class Settled {
 public:
  Settled(float x, float y, double kept, bool inARow) : wide_(kSide), high_(inARow ? 1 : kSide) {
    const double sx = 2 * double(x) * (1 - double(x)), sy = 2 * double(y) * (1 - double(y));
    std::vector<double> now(static_cast<std::size_t>(wide_) * high_, 0.0);
    for (int frame = 0; std::pow(kept, frame) > 1e-9; ++frame) {
      values_ = now;
      for (int j = 0; j < high_; ++j)
        for (int i = 0; i < wide_; ++i) {
          const auto row = [&](int v) { return (1 - sx) * at(i, v) + sx / 2 * (at(i - 1, v) + at(i + 1, v)); };
          now[index(i, j)] = kept * ((1 - sy) * row(j) + sy / 2 * (row(j - 1) + row(j + 1)));
        }
      now[0] += 1;
    }
    values_ = now;
  }
  double at(int i, int j) const { return values_[index(i, j)]; }

 private:
  static constexpr int kSide = 65;
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>((j + high_) % high_ * wide_ + (i + wide_) % wide_);
  }
  int wide_, high_;
  std::vector<double> values_;
};

TEST(Walk, IsExactAlongARow) {
  for (const float x : {0.01f, 0.1f, 0.25f, 0.5f})
    for (const double kept : {0.36, 0.81, 0.9025}) {
      const Settled field(x, 0, kept, true);
      const double rho = twohistory::walkCorrelation(1 / kept - 1, 2 * double(x) * (1 - double(x)));
      EXPECT_NEAR(field.at(1, 0) / field.at(0, 0), rho, 1e-6) << x << ", " << kept;
      EXPECT_NEAR(field.at(3, 0) / field.at(0, 0), rho * rho * rho, 1e-6) << x << ", " << kept;
    }
}

/// Where every frame's steps are this one's.
template <class Real>
Real likenessOf(const TapPairs& p, Real death, Real freshShare) {
  const twohistory::WalkSteps<Real> steps{static_cast<Real>(p.alongRow()), static_cast<Real>(p.alongColumn())};
  return twohistory::tapLikeness<Real>(p, settledNoise(p, steps, death), freshShare, {});
}

/// Stationary variance of a pixel that the rule predicts, with the fresh share that a settled walk has.
double predictedBy(const TapPairs& p, double kept, double likeness) {
  return 1 / (1 - kept * (1 - double(p.all()) * (1 - likeness)));
}

TEST(Walk, InThePlaneIsWithinFivePercentOfWhatItSolves) {
  double worst = 0, worstPower = 0, worstSquare = 0;
  for (const auto& [x, y] :
       {std::pair{0.5f, 0.5f}, {0.37f, 0.21f}, {0.2f, 0.2f}, {0.05f, 0.05f}, {0.5f, 0.1f}, {0.5f, 0.0f}})
    for (const double kept : {0.36, 0.64, 0.81, 0.9025}) {
      const TapPairs p = twohistory::pairsOf(tapsAt(x, y, 64), 64);
      const double truth = Settled(x, y, kept, false).at(0, 0), share = 1 / truth;
      worst = std::max(worst, std::abs(truth / predictedBy(p, kept, likenessOf(p, 1 / kept - 1, share)) - 1));
      double power = 0;  // controls: b^1.5 and b^2
      for (const float b : tapsAt(x, y, 64).b) power += std::pow(double(b), 1.5);
      worstPower = std::max(worstPower, std::abs(truth * (1 - kept * power) - 1));
      worstSquare = std::max(worstSquare, std::abs(truth / predictedBy(p, kept, 0) - 1));
    }
  EXPECT_LT(worst, 0.05);
  EXPECT_GT(worstPower, 0.15);
  EXPECT_GT(worstSquare, 0.5);
}

TEST(Walk, StepsOfThePastAreLikelyNearerToTheirMean) {
  float before = 0;
  for (const float f : {0.001f, 0.02f, 0.1f, 0.25f, 0.5f}) {
    const TapPairs p = twohistory::pairsOf(tapsAt(f, 0, 9), 9);
    const auto steps = twohistory::LikelySteps<float>{}(tapsAt(f, 0, 9), p);
    EXPECT_EQ(steps.y, 0);
    EXPECT_GT(steps.x, before);
    EXPECT_LE(std::abs(steps.x - 1 / 3.0f), std::abs(p.alongRow() - 1 / 3.0f));
    before = steps.x;
  }
}

TEST(TapPairs, AreTheStepsOfTheWalkWhateverTheOrder) {
  for (const auto& [x, y] : {std::pair{0.5f, 0.5f}, {0.3f, 0.1f}, {0.25f, 0.0f}, {0.0f, 0.0f}}) {
    const Taps t = tapsAt(x, y, 7);
    const Taps turned{{t.pixel[2], t.pixel[0], t.pixel[3], t.pixel[1]}, {t.b[2], t.b[0], t.b[3], t.b[1]}};
    for (const TapPairs& p : {twohistory::pairsOf(t, 7), twohistory::pairsOf(turned, 7)}) {
      EXPECT_NEAR(p.alongRow(), 2 * x * (1 - x), 1e-6f);
      EXPECT_NEAR(p.alongColumn(), 2 * y * (1 - y), 1e-6f);
      float squares = 0;
      for (const float b : t.b) squares += b * b;
      EXPECT_NEAR(p.all() + squares, 1, 1e-6f);
    }
  }
  EXPECT_NEAR(twohistory::pairsOf({{0, 8, 0, 0}, {0.5f, 0.5f, 0, 0}}, 7).diagonal, 0.5f, 1e-6f);
}

float deathRateOf(float age, float factor) { return twohistory::deathRate<float>({1, age, factor}); }

TEST(Likeness, IsNothingAtFirstAndGrowsWithAgeUpToOne) {
  const TapPairs p = twohistory::pairsOf(tapsAt(0.3f, 0.4f, 9), 9);
  float before = 0;
  EXPECT_LT(likenessOf(p, deathRateOf(0, 0), 0.0f), 1e-5f);
  for (const float decay : {0.2f, 0.5f, 0.8f, 0.95f, 0.98f, 0.999f, 0.99999f}) {
    const float death = deathRateOf(decay / (1 - decay), decay), r = likenessOf(p, death, 0.0f);
    EXPECT_GT(r, before);
    EXPECT_LE(r, 1);
    EXPECT_GE(r, likenessOf(p, death, 0.5f));  // what is fresh is no neighbour's
    before = r;
  }
  EXPECT_GT(before, 0.9f);
  EXPECT_GT(before, 1.2f * likenessOf(p, deathRateOf(1e5f, 0.99999f), 0.5f));
  for (const float age : {0.0f, 1e-30f, 1e7f, 1e30f})
    for (const float factor : {0.0f, 1e-30f, 0.5f, 1.0f})
      for (const float share : {0.0f, 1.0f}) {
        const float r = likenessOf(p, deathRateOf(age, factor), share);
        EXPECT_TRUE(r >= 0 && r <= 1) << age << ", " << factor << ", " << share << ": " << r;
      }
}

/// Ledgers of three histories of unequal memory after random counts.
Ledger<3> randomLedger(core::Rng& rng, const twohistory::Policies<3>& policies) {
  Ledger<3> l;
  const auto frames = 1 + rng.below(40), most = 1 + rng.below(16);
  for (std::uint32_t f = 0; f < frames; ++f)
    l = twohistory::advance(l, policies, static_cast<float>(rng.below(most + 1)));
  return l;
}

/// Least variance of random combinations of the three over the largest of their variances.
double leastVariance(core::Rng& rng, const Ledger<3>& l) {
  double least = 1, largest = 0;
  for (int j = 0; j < 3; ++j) largest = std::max(largest, double(l.covariance(j, j)));
  for (int trial = 0; trial < 8; ++trial) {
    std::array<double, 3> w{};
    for (double& x : w) x = 2 * double(rng.uniform()) - 1;
    double sum = 0;
    for (int g = 0; g < 3; ++g)
      for (int h = 0; h < 3; ++h) sum += w[g] * w[h] * double(l.covariance(g, h));
    least = std::min(least, largest > 0 ? sum / largest : 0);
  }
  return least;
}

TEST(Mixing, KeepsACovarianceMatrix) {
  const twohistory::Policies<3> policies{Policy{Weighting::frames, Forgetting::decay, 0.95},
                                         Policy{Weighting::samples, Forgetting::decay, 0.98},
                                         Policy{Weighting::samples, Forgetting::decay, 0.6}};
  double least = 1, control = 1;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    core::Rng rng(31, core::Pass::other, i, 0);
    core::Image<Ledger<3>> before(2, 2);
    for (int k = 0; k < 4; ++k) before(k % 2, k / 2) = randomLedger(rng, policies);
    const Taps taps = tapsAt(rng.uniform(), rng.uniform(), 2);
    const auto n = static_cast<float>(rng.below(9));
    least = std::min(least, leastVariance(rng, twohistory::gather<3, float>(taps, before, policies, n)));
    auto sums = twohistory::sumTaps<3, float>(taps, before.view());  // control: only covariances are thought alike
    for (int g = 0; g < 3; ++g)
      for (int h = g + 1; h < 3; ++h) {
        const int pair = twohistory::pairIndex<3>(g, h);
        sums.ledger.powerSums[pair] += sums.shared[pair];
      }
    control = std::min(control, leastVariance(rng, sums.ledger));
  }
  EXPECT_GT(least, -1e-6);
  EXPECT_LT(control, -1e-2);
}

}  // namespace
