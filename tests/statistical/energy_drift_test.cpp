// The light of 10,000 frames neither rises nor falls: its slope by least squares, an interval over independent
// sequences. What returns to history is the reservoir before spatial reuse, so temporal reuse alone has the whole
// chain. 24 sequences of 64x48 pixels hold the slope's interval within +-0.1 % over 10,000 frames (TWOFOLD_SEQUENCES
// for more). A chain that loses more of W in every frame, 0.1 % in the last, must be caught.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "tests/restir_worlds.h"

namespace {

constexpr int kLong = 10'000, kStart = 32, kWide = 64, kHigh = 48;
constexpr std::array<int, 5> kShown{1, 32, 128, 1000, 10'000};

struct Drift {
  std::array<core::RunningMoments, 5> shown;  ///< light of frames 1, 32, ..., 10,000
  core::RunningMoments slope;                 ///< relative change over 10,000 frames
};

int sequencesWanted() {
  const char* text = std::getenv("TWOFOLD_SEQUENCES");
  return text ? std::max(std::atoi(text), 8) : 24;
}

/// Light of every frame of one sequence. loss: share of W that each frame loses.
std::vector<double> lightOf(const tests::World& world, std::uint64_t seed, float loss) {
  restir::RestirParameters p;
  p.reuse = restir::Reuse::temporal, p.candidates = {4, 1}, p.demodulate = false;
  restir::RestirState state(kWide, kHigh);
  const core::Image<float> samples(kWide, kHigh, 1.0f);
  core::Planes image(kWide, kHigh);
  std::vector<double> light(kLong);
  for (int f = 0; f < kLong; ++f) {
    const restir::Frame frame = world.frame(f, samples, seed, kWide);
    restir::drawCandidates(p, frame, state);
    restir::reuseTemporally(p, frame, state);
    restir::reuseSpatiallyAndShade(p, frame, state, image);
    for (int i = 0; i < kWide * kHigh; ++i) {
      light[f] += core::luminance(image.view().at(i));
      if (loss > 0) state.now.data()[i].unbiasedWeight *= 1 - loss * static_cast<float>(f);
    }
  }
  return light;
}

/// Change of the line through frames kStart.. over kLong frames, relative to its mean.
double slopeOf(const std::vector<double>& light) {
  const double middle = 0.5 * (kStart + kLong - 1);
  double sum = 0, product = 0, square = 0;
  for (int f = kStart; f < kLong; ++f) {
    sum += light[f];
    product += (f - middle) * light[f];
    square += (f - middle) * (f - middle);
  }
  return product / square * kLong / (sum / (kLong - kStart));
}

Drift driftOf(int sequences, float loss) {
  const tests::World world(tests::makeWorld(), 2, kWide, kHigh);
  std::vector<std::vector<double>> lights(sequences);
  tbb::parallel_for(0, sequences, [&](int i) { lights[i] = lightOf(world, static_cast<std::uint64_t>(i + 1), loss); });
  Drift drift;
  for (const auto& light : lights) {
    for (std::size_t k = 0; k < kShown.size(); ++k) drift.shown[k].add(light[kShown[k] - 1]);
    drift.slope.add(slopeOf(light));
  }
  return drift;
}

TEST(EnergyDrift, TheLightOfTenThousandFramesKeepsItsLevel) {
  const Drift drift = driftOf(sequencesWanted(), 0);
  for (std::size_t k = 0; k < kShown.size(); ++k) {
    const core::Interval light = core::meanInterval(drift.shown[k]);
    std::printf("light of frame %5d: %.3f +- %.3f\n", kShown[k], light.mean, light.halfWidth());
  }
  const core::Interval slope = core::meanInterval(drift.slope);
  std::printf("slope over 10,000 frames: %.4f %% .. %.4f %% (95 %%)\n", 100 * slope.low, 100 * slope.high);
  constexpr double kBound = 0.001;
  EXPECT_GT(slope.low, -kBound);
  EXPECT_LT(slope.high, kBound);
  EXPECT_LT(std::abs(drift.slope.mean()), core::sidakBound(1, 1e-6) * std::sqrt(drift.slope.meanVariance()));
}

TEST(EnergyDrift, AChainThatLosesALittleIsCaught) {
  const Drift drift = driftOf(8, 1e-7f);  // in the last frame 0.1 % of W, which the cap of 20 multiplies by 20
  EXPECT_LT(drift.slope.mean(), -core::sidakBound(1, 1e-6) * std::sqrt(drift.slope.meanVariance()));
}

}  // namespace
