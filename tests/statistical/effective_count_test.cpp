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

/// Variance of a pixel's luminance in the last frame, n samples everywhere, summed over lit pixels.
double summedVariance(const World& world, Reuse reuse, float n, int sequences) {
  tests::Hooks hooks;
  hooks.samples = [n](int, int, int, const core::vec3&) { return n; };
  const tests::Estimate e = tests::estimate(world, with(reuse), sequences, hooks);
  double sum = 0;
  for (const core::RunningMoments& m : e.pixels) sum += m.meanVariance() * sequences;
  return sum;
}

/// rho with Var(n) = Var(1) (rho + (1 - rho) / n).
double sharedVariance(const World& world, Reuse reuse, float n) {
  constexpr int kSequences = 512;
  const double ratio = summedVariance(world, reuse, n, kSequences) / summedVariance(world, reuse, 1, kSequences);
  const double inverse = 1 / static_cast<double>(n);
  return (ratio - inverse) / (1 - inverse);
}

TEST(EffectiveCount, ResultsWithoutReuseAreIndependentAndReusedOnesShareVariance) {
  const World world(tests::makeWorld(), 24);
  const double alone = sharedVariance(world, Reuse::none, 8), shared = sharedVariance(world, Reuse::both, 8);
  std::printf("n = 8: rho %.3f without reuse, %.3f with both\n", alone, shared);
  EXPECT_NEAR(alone, 0, 0.05);
  EXPECT_NEAR(shared, static_cast<double>(RestirParameters{}.sharedVariance), 0.08);
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
