// How much n results of one pixel, and frames of one chain, really hold: calibrates [told].
//
// Significance 1e-6 where a bound is tested; intervals printed are 95 %. Negative control: results without reuse are
// independent, and the same measure must say so.
#include <gtest/gtest.h>

#include <cstdio>

#include "restir/told.h"
#include "tests/restir_worlds.h"

namespace {

using restir::RestirParameters;
using restir::Reuse;
using tests::World;

RestirParameters with(Reuse reuse) {
  RestirParameters p;
  p.reuse = reuse;
  return p;
}

/// Variance of a pixel's luminance in the last frame, n samples everywhere, summed over pixels; of these sequences.
double summedVariance(const World& world, Reuse reuse, float n, int sequences, std::uint64_t firstSeed) {
  tests::Hooks hooks;
  hooks.samples = [n](int, int, int, const core::vec3&) { return n; };
  return tests::totalVariance(tests::estimate(world, with(reuse), sequences, hooks, firstSeed));
}

/// rho with Var(n) = Var(1) (rho + (1 - rho) / n), of groups of sequences.
struct SharedVariance {
  static constexpr int kGroups = 8, kSequences = 128;
  const World& world;
  Reuse reuse;
  std::array<double, kGroups> ofOne = {};

  SharedVariance(const World& w, Reuse r) : world(w), reuse(r) {
    for (int g = 0; g < kGroups; ++g) ofOne[g] = varianceOf(1, g);
  }
  double varianceOf(float n, int group) const {
    return summedVariance(world, reuse, n, kSequences, 1 + std::uint64_t{kSequences} * static_cast<unsigned>(group));
  }
  core::Interval rho(float n) const {
    core::RunningMoments moments;
    const double inverse = 1 / static_cast<double>(n);
    for (int g = 0; g < kGroups; ++g) moments.add((varianceOf(n, g) / ofOne[g] - inverse) / (1 - inverse));
    return core::meanInterval(moments);
  }
};

TEST(EffectiveCount, ResultsWithoutReuseAreIndependentAndReusedOnesShareVariance) {
  const World world(tests::makeWorld(), 24);
  const SharedVariance alone(world, Reuse::none), shared(world, Reuse::both);
  for (const float n : {2.0f, 4.0f, 8.0f}) {
    const core::Interval without = alone.rho(n), reused = shared.rho(n);
    std::printf("n = %g: rho %.3f +- %.3f without reuse, %.3f +- %.3f with both\n", static_cast<double>(n),
                without.mean, without.halfWidth(), reused.mean, reused.halfWidth());
    EXPECT_NEAR(without.mean, 0, 0.05);
    EXPECT_NEAR(reused.mean, static_cast<double>(RestirParameters{}.sharedVariance), 0.08);
  }
}

/// Frames that are worth one independent frame: variance of a mean of T frames over Var(frame) / T, all pixels.
double framesPerIndependent(Reuse reuse, double cap, int sequences) {
  constexpr int kWarm = 40, kFrames = 1000;
  static const World world(tests::makeWorld(), kWarm + kFrames);
  RestirParameters p = with(reuse);
  p.temporal.policy.amount = cap;
  std::vector<std::vector<core::RunningMoments>> within(sequences);
  tbb::parallel_for(0, sequences, [&](int i) {
    within[i].resize(tests::kPixels);
    core::Planes image(tests::kWidth, tests::kHeight);
    tests::Hooks hooks;
    hooks.after = [&](int f, restir::RestirState&) {
      if (f >= kWarm)
        for (int k = 0; k < tests::kPixels; ++k)
          within[i][k].add(static_cast<double>(core::luminance(image.view().at(k))));
    };
    tests::renderSequence(world, p, hooks, static_cast<std::uint64_t>(i + 1), image);
  });
  double ofMeans = 0, ofFrames = 0;
  for (int k = 0; k < tests::kPixels; ++k) {
    core::RunningMoments means, frames;
    for (const auto& sequence : within) means.add(sequence[k].mean()), frames.merge(sequence[k]);
    ofMeans += means.meanVariance() * sequences;
    ofFrames += frames.meanVariance() * static_cast<double>(sequences) * kFrames;
  }
  return ofMeans * kFrames / ofFrames;
}

TEST(EffectiveCount, FramesOfOneChainHoldAsMuchAsPredicted) {
  const double rho = static_cast<double>(RestirParameters{}.sharedVariance);
  for (const double cap : {5.0, 20.0}) {
    const double temporal = framesPerIndependent(Reuse::temporal, cap, 48),
                 both = framesPerIndependent(Reuse::both, cap, 48);
    std::printf("cap %.0f: %.1f frames with temporal reuse (predicted %.0f), %.1f with both (%.1f)\n", cap, temporal,
                2 * cap + 1, both, 1 + 2 * rho * cap);
    EXPECT_GT(temporal / (2 * cap + 1), 0.8);
    EXPECT_LT(temporal / (2 * cap + 1), 1.25);
    EXPECT_GT(both / (1 + 2 * rho * cap), 0.8);
    EXPECT_LT(both / (1 + 2 * rho * cap), 1.25);
    EXPECT_GT((2 * cap + 1) / both, 1.25);  // control: as if no neighbour were reused
  }
  EXPECT_NEAR(framesPerIndependent(Reuse::none, 20, 48), 1, 0.2);  // control
}

}  // namespace
