// Every way to forget leaves reuse unbiased under counts that vary and lights that come, go and move; and a capped
// history repeats itself as long as theory says. The smallest bias of a frame's light that is detected half of the time
// is 2 %; tests of this file's claims on correlation state their own.
#include <gtest/gtest.h>

#include "restir/mis.h"
#include "tests/restir_worlds.h"
#include "twohistory/ledger.h"

namespace {

using core::LightSample;
using core::vec3;
using restir::Mis;
using restir::Reservoir;
using restir::RestirParameters;
using restir::Reuse;
using tests::Hooks;
using tests::Motion;
using tests::World;
using twohistory::Forgetting;
using twohistory::Policy;
using twohistory::Weighting;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kFrames = 6;

constexpr std::array<Policy, 6> kPolicies{{{Weighting::samples, Forgetting::decay, 0.9},
                                           {Weighting::samples, Forgetting::relativeCap, 5},
                                           {Weighting::samples, Forgetting::absoluteCap, 12},
                                           {Weighting::frames, Forgetting::decay, 0.9},
                                           {Weighting::frames, Forgetting::relativeCap, 5},
                                           {Weighting::frames, Forgetting::absoluteCap, 3}}};

RestirParameters with(const Policy& policy, Reuse reuse = Reuse::temporal) {
  RestirParameters p;
  p.reuse = reuse, p.temporal.policy = policy, p.candidates = {4, 1};
  p.spatial = tests::farAndAroundCorners();
  return p;
}

tests::Comparison comparisonOf(const World& world, const RestirParameters& p, const Hooks& hooks, int sequences = 512) {
  return tests::compare(tests::estimate(world, p, sequences, hooks), tests::reference(world, 16, 512, hooks.compared));
}
void expectUnbiased(const World& world, const RestirParameters& p, const Hooks& hooks, int sequences = 512) {
  const auto c = comparisonOf(world, p, hooks, sequences);
  EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.detectable, tests::detectableBias(0.02));
}

Motion ofLight() {
  Motion m;
  m.light = vec3(0.2f, 0, 0.05f);
  return m;
}

/// A fovea of 16 samples that sweeps over the image: pixels go from 1 to 16 and from 16 to 1.
float sweepingFovea(int frame, int x, int, const vec3&) { return std::abs(x - 3 * frame) <= 3 ? 16.0f : 1.0f; }
float fixedMap(int, int x, int y, const vec3&) { return (x / 4 + y / 4) % 2 ? 8.0f : 1.0f; }
float withPauses(int frame, int x, int y, const vec3&) {
  return frame == kFrames - 1 ? 1.0f : static_cast<float>((x + 2 * y + frame) % 3);
}

class Forget : public testing::TestWithParam<Policy> {
 protected:
  static void expectUnbiasedUnder(float (*samples)(int, int, int, const vec3&)) {
    static const World world(tests::makeWorld(ofLight()), kFrames);
    static const tests::Estimate truth = tests::reference(world, 16, 512);
    const auto c = tests::compare(tests::estimate(world, with(GetParam()), 512, {samples, {}, {}}), truth);
    EXPECT_LT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
    EXPECT_LT(c.detectable, tests::detectableBias(0.02));
  }
};

TEST_P(Forget, FixedMapIsUnbiased) { expectUnbiasedUnder(fixedMap); }
TEST_P(Forget, MovingFoveaIsUnbiased) { expectUnbiasedUnder(sweepingFovea); }
TEST_P(Forget, PausesAreUnbiased) { expectUnbiasedUnder(withPauses); }
INSTANTIATE_TEST_SUITE_P(Policies, Forget, testing::ValuesIn(kPolicies));

/// The world with its first lamp lit in some frames only; values: emission factors of the frames.
core::Scene flickeringWorld(std::vector<float> factors) {
  core::Scene scene = tests::makeWorld();
  core::Track track;
  track.interpolation = core::Interpolation::step;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    track.times.push_back((static_cast<float>(f) - 0.5f) / 30);
    track.values.push_back(core::vec4(factors[f]));
  }
  scene.flickers.push_back(track);
  scene.materials[2].flicker = 0;
  return scene;
}

TEST(TemporalOptions, LightsThatAppearAndVanishLeaveItUnbiased) {
  const RestirParameters p = with({Weighting::samples, Forgetting::relativeCap, 20});
  expectUnbiased(World(flickeringWorld({0, 0, 0, 0, 0, 1}), kFrames), p, {}, 768);
  expectUnbiased(World(flickeringWorld({1, 1, 1, 1, 1, 0}), kFrames), p, {}, 768);
  expectUnbiased(World(flickeringWorld({1, 0, 1, 0, 0, 1}), kFrames), p, {withPauses, {}, {}}, 768);
}

TEST(TemporalOptions, ALightThatAppearsNeedsTheDarknessBefore) {
  RestirParameters p = with({Weighting::samples, Forgetting::relativeCap, 20});
  p.temporal.previousLights = false;
  const auto c = comparisonOf(World(flickeringWorld({0, 0, 0, 0, 0, 1}), kFrames), p, {}, 768);
  EXPECT_GT(std::abs(c.z), kLargestZ) << "ratio " << c.ratio;
  EXPECT_LT(c.ratio, 0.98);
}

TEST(TemporalOptions, DisocclusionLeavesItUnbiased) {
  // Walls sweep over the floor that the camera sees, and the camera moves: pixels lose their history all the time.
  Motion m;
  m.occluder = vec3(0.25f, 0, 0.15f), m.camera = vec3(-0.1f, 0, 0.05f);
  const World world(tests::makeWorld(m), kFrames);
  int lost = 0;
  const core::Image<float> one(tests::kWidth, tests::kHeight, 1.0f);
  const restir::Frame last = world.frame(kFrames - 1, one, 1);
  for (int i = 0; i < tests::kPixels; ++i) lost += !last.taps.at(i).valid();
  EXPECT_GT(lost, 5);
  expectUnbiased(world, with(kPolicies[1], Reuse::both), {}, 768);
}

/// Variance of the mean of T frames over that of T independent ones: frames that one independent frame is worth. One
/// pixel under 64 lights of equal power and unequal targets, one candidate a frame.
core::RunningMoments correlationOf(const Policy& policy, float n, int frames, int chains) {
  constexpr int kLights = 64, kWarmUp = 300;
  struct Flat {
    float operator()(const LightSample&) const { return 1; }
  };
  const auto valueOf = [](std::uint32_t light) { return light % 2 ? 1.0 : -1.0; };  // mean 0, variance 1
  std::vector<double> squares(chains);
  tbb::parallel_for(0, chains, [&](int c) {
    core::Rng rng(1, core::Pass::lab, static_cast<std::uint32_t>(c), 0);
    twohistory::Ledger<1> ledger;
    Reservoir history{{}, 0, 0, 0};
    double sum = 0;
    for (int f = -kWarmUp; f < frames; ++f) {
      const auto change = twohistory::advanceOf(ledger, twohistory::Policies<1>{policy}, n);
      history.confidence = change.factor[0] * ledger.weight[0];
      const Reservoir fresh{{rng.below(kLights), {}}, 1, change.fresh[0], 0};
      const std::array<restir::Source<Flat>, 2> sources{{{fresh, {}}, {history, {}}}};
      history = restir::mergeReservoirs(std::span<const restir::Source<Flat>>(sources), Mis::balance, 0, rng);
      ledger = twohistory::advance(ledger, change, n);
      if (f >= 0) sum += valueOf(history.sample.light);
    }
    squares[c] = sum * sum / frames;
  });
  core::RunningMoments moments;
  for (double s : squares) moments.add(s);
  return moments;
}

/// Each frame keeps its sample with probability r = Q / (1 + Q), so the frames' correlation is r^lag and
///   N / N_eff = (1 + r) / (1 - r) - 2 r (1 - r^T) / (T (1 - r)^2)    which is 2 Q + 1 for T without end.
double correlationTheory(double q, int frames) {
  const double r = q / (1 + q);
  return (1 + r) / (1 - r) - 2 * r * (1 - std::pow(r, frames)) / (frames * (1 - r) * (1 - r));
}

TEST(EffectiveFrames, ACappedHistoryRepeatsItselfForTwiceItsCapPlusOne) {
  for (double q : {5.0, 20.0, 100.0}) {
    const int frames = static_cast<int>(100 * q);
    const auto m = correlationOf({Weighting::samples, Forgetting::relativeCap, q}, 4, frames, 6400);
    EXPECT_LT(std::abs(m.mean() - correlationTheory(q, frames)), kLargestZ * std::sqrt(m.meanVariance())) << q;
    EXPECT_NEAR(m.mean(), 2 * q + 1, 0.1 * (2 * q + 1));
    EXPECT_LT(kLargestZ * std::sqrt(m.meanVariance()), 0.1 * m.mean());
    std::printf("relative cap %g: N / N_eff = %.1f +- %.1f, 2 Q + 1 = %g\n", q, m.mean(),
                1.96 * std::sqrt(m.meanVariance()), 2 * q + 1);
  }
}

TEST(EffectiveFrames, ARelativeCapKeepsTheSameMemoryAtEveryRate) {
  const auto slow = correlationOf({Weighting::samples, Forgetting::relativeCap, 10}, 1, 500, 1600);
  const auto fast = correlationOf({Weighting::samples, Forgetting::relativeCap, 10}, 16, 500, 1600);
  EXPECT_LT(std::abs(slow.mean() - fast.mean()), kLargestZ * std::sqrt(slow.meanVariance() + fast.meanVariance()));
}

TEST(EffectiveFrames, AnAbsoluteCapForgetsFasterWhereThereAreMoreSamples) {
  for (float n : {1.0f, 4.0f, 16.0f}) {  // cap C acts like a relative cap C / n
    const auto m = correlationOf({Weighting::samples, Forgetting::absoluteCap, 32}, n, 1000, 1600);
    EXPECT_LT(std::abs(m.mean() - correlationTheory(32 / n, 1000)), kLargestZ * std::sqrt(m.meanVariance())) << n;
  }
}

TEST(EffectiveFrames, ADecayIsTheRelativeCapOfItsRatio) {
  const auto m = correlationOf({Weighting::samples, Forgetting::decay, 10.0 / 11}, 1, 1000, 1600);
  EXPECT_LT(std::abs(m.mean() - correlationTheory(10, 1000)), kLargestZ * std::sqrt(m.meanVariance()));
}

}  // namespace
