// The laboratory makes the truths, motions and noises that it says, and measures what it says.
#include "experiments/lab/lab.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/statistics.h"
#include "experiments/lab/measure.h"
#include "experiments/lab/overview.h"

namespace {

using namespace experiments::lab;
using core::vec2;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kSize = 64;

/// Noise factors of a whole field over some frames of still taps, n samples a pixel.
core::RunningMoments factors(const NoiseParameters& p, float n, int frames, std::vector<float>* last = nullptr) {
  NoiseField field(p, 5, kSize, kSize);
  core::Image<float> counts(kSize, kSize, n);
  core::Image<twohistory::Taps> taps(kSize, kSize);
  core::RunningMoments moments;
  for (int f = 0; f < frames; ++f) {
    field.advance(counts, taps, static_cast<std::uint32_t>(f));
    for (int i = 0; i < kSize * kSize; ++i) {
      moments.add(static_cast<double>(field.at(i % kSize, i / kSize)));
      if (last) last->push_back(field.at(i % kSize, i / kSize));
      taps.data()[i] = twohistory::stillTap(i);
    }
  }
  return moments;
}

TEST(LabNoise, HasMeanOneAndTheVarianceItClaims) {
  for (const float sigma : {0.5f, 1.5f})
    for (const float n : {1.0f, 8.0f}) {
      NoiseParameters p;
      p.sigma = sigma;
      const core::RunningMoments m = factors(p, n, 16);
      EXPECT_LT(std::abs(m.mean() - 1) / std::sqrt(m.meanVariance()), kLargestZ);
      EXPECT_NEAR(m.variance() * n / (sigma * sigma), 1, 0.05);
    }
}

TEST(LabNoise, FirefliesAndSharingKeepMeanAndVariance) {
  NoiseParameters fireflies;
  fireflies.fireflies = 1e-3f;
  const core::RunningMoments m = factors(fireflies, 1, 64);
  EXPECT_LT(std::abs(m.mean() - 1) / std::sqrt(m.meanVariance()), kLargestZ);
  NoiseParameters shared;
  shared.shared = true;
  EXPECT_NEAR(factors(shared, 4, 32).variance() * 4 / (1.5 * 1.5), 1, 0.06);
}

TEST(LabNoise, HeldFactorsRepeatAsOftenAsTheySay) {
  NoiseParameters p;
  p.held = 0.9f;
  std::vector<float> all;
  factors(p, 1, 20, &all);
  int same = 0;
  const int pairs = 19 * kSize * kSize;
  for (int i = 0; i < pairs; ++i) same += all[i] == all[i + kSize * kSize];
  EXPECT_NEAR(double(same) / pairs, 0.9, 0.01);
}

TEST(LabMotion, ViewsInvertThemselvesAndMotionFollowsThePlane) {
  const View now({0.3f, -0.2f, 2}, 7), before({0.3f, -0.2f, 2}, 6);
  const vec2 p(11, -5);
  EXPECT_LT(length(now.toImage(now.toPlane(p)) - p), 1e-4f);
  EXPECT_GT(length(before.toImage(now.toPlane(p)) - p), 0.1f);
}

TEST(LabSignal, StepsPulsesAndStripesAreWhereTheySay) {
  SignalParameters s;
  s.kind = SignalKind::step;
  EXPECT_EQ(signalAt(s, vec2(0), s.at - 1), 1);
  EXPECT_EQ(signalAt(s, vec2(0), s.at), s.high);
  s.kind = SignalKind::pulse;
  EXPECT_NEAR(signalAt(s, vec2(0), 8), 1.5f, 1e-4f);
  s.apart = 0.25f;  // green follows red a quarter of the period of 32 later, blue half
  EXPECT_LT(length(colourAt(s, vec2(0), 8) - core::vec3(1.5f, 1, 0.5f)), 1e-4f);
  s.kind = SignalKind::shadow;
  EXPECT_EQ(signalAt(s, vec2(3, 0), 0), signalAt(s, vec2(10, 0), 7));  // moves one pixel a frame
  s.kind = SignalKind::edge;
  EXPECT_NE(signalAt(s, vec2(-1, 0), 0), signalAt(s, vec2(1, 0), 0));
  EXPECT_EQ(surfaceAt(s, vec2(-1, 0)), surfaceAt(s, vec2(1, 0)));
  s.separate = true;
  EXPECT_NE(surfaceAt(s, vec2(-1, 0)), surfaceAt(s, vec2(1, 0)));
}

TEST(LabMeasure, ErrorOfColourIsTheMeanOverChannels) {
  core::Planes image(kSize, kSize), truth(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) image.view().store(x, y, core::vec3(2, 1, 3));
  Measure m;
  m.add(image, truth, experiments::FovealMemory(kSize, kSize));
  EXPECT_NEAR(m.squaredColourError(experiments::Region::full), 5.0 / 3, 1e-6);
  const double luminance = 0.2126 + 2 * 0.0722;
  EXPECT_NEAR(m.squaredError(experiments::Region::full), luminance * luminance, 1e-6);
}

TEST(LabMeasure, BorderStepSeesALevelAndNotNoise) {
  core::Image<float> level(kSize, kSize), noise(kSize, kSize);
  core::Image<std::uint8_t> inside(kSize, kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      core::Rng rng(1, core::Pass::lab, static_cast<std::uint32_t>(y * kSize + x), 0);
      inside(x, y) = x < 24;
      level(x, y) = x < 24 ? 0.5f : 0.2f;
      noise(x, y) = 0.3f * (rng.uniform() < 0.5f ? -1.0f : 1.0f);
    }
  const core::Image<float> zero(kSize, kSize);
  experiments::BorderStep ofLevel, ofNoise, ofNothing;
  ofLevel.add(level, {zero, zero}, inside);
  ofNoise.add(noise, {zero, zero}, inside);
  EXPECT_NEAR(ofLevel.meanSquare(), 0.09, 1e-6);
  EXPECT_LT(ofNoise.meanSquare(), 0.1 * 0.09);
  EXPECT_NEAR(ofNoise.noiseRatio(), 1, 0.1);
  EXPECT_TRUE(std::isnan(ofNothing.meanSquare()));
  EXPECT_TRUE(std::isnan(ofNothing.noiseRatio()));
}

/// Contrasts and noise ratio of a truth of 2 with a step of 0.02 * `step` at x = 24, under independent noise, ten times
/// as strong outside.
experiments::BorderStep noisyBorder(std::uint64_t seed, float step) {
  core::Image<float> image(kSize, kSize), truth(kSize, kSize, 2.0f);
  core::Image<std::uint8_t> inside(kSize, kSize);
  experiments::BorderStep border;
  for (std::uint32_t frame = 0; frame < 32; ++frame) {
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        core::Rng rng(seed, core::Pass::lab, static_cast<std::uint32_t>(y * kSize + x), frame);
        inside(x, y) = x < 24;
        image(x, y) = 2 + (x < 24 ? 0.02f * step : 0) + (x < 24 ? 0.1f : 1.0f) * (rng.uniform() - 0.5f);
      }
    border.add(image, {truth, truth}, inside);
  }
  return border;
}

TEST(Border, SeedsTogetherSeeAContrastOfOnePercentBelowTheNoiseAndNoneWhereThereIsNone) {
  for (const float step : {1.0f, 0.0f}) {
    std::vector<experiments::BorderStep> borders;
    std::vector<const std::vector<experiments::BorderStep::Contrast>*> contrasts;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) borders.push_back(noisyBorder(seed, step));
    for (const auto& b : borders) contrasts.push_back(&b.contrasts());
    const std::vector<double> values = experiments::systematicContrast2(contrasts);
    const core::Interval i = core::meanInterval(values, 1 - 1e-6);
    const double floor = 1.01, truth = 1e-4 * static_cast<double>(step) / (floor * floor);  // 1 % of the level is added
    EXPECT_LT(i.low, truth);
    EXPECT_GT(i.high, truth);
    EXPECT_LT(i.halfWidth(), 7e-5);
    EXPECT_EQ(i.low > 0, step > 0);
    EXPECT_NEAR(borders[0].noiseRatio(), 10, 0.3);
    const double naive = borders[0].meanSquare() / 4;  // control: one seed's squared step is mostly noise
    EXPECT_GT(naive, 2.0 * std::max(truth, 1e-4));
  }
  const std::vector<experiments::BorderStep::Contrast> one(3, {1, 1});
  for (const double v : experiments::systematicContrast2({&one, &one})) EXPECT_TRUE(std::isnan(v));
}

LabConfig small() {
  LabConfig c = labConfigFrom({}, {"width=48", "height=32", "frames=12", "first=6", "seeds=[1,2]"}, "spot-moving");
  c.variants = {"unweighted", "seed", "lag-checked"};
  return c;
}

/// MSE of `unweighted` under constant light, the camera moving, with that reach of the edge.
double errorWithEdgeReach(const char* pixels) {
  LabConfig c = labConfigFrom(
      {},
      {"width=32", "height=24", "frames=24", "first=12", "seeds=[1]", std::string("reprojection.edgeReach=") + pixels},
      "");
  c.variants = {"unweighted"};
  std::erase_if(c.cases, [](const Case& each) { return each.name != "constant-moving"; });
  for (const experiments::Row& row : runLab(c).rows)
    if (row.metric == "MSE" && row.region == "full") return row.value;
  return -1;
}

TEST(Lab, AnEdgeThatForgetsIsNoisierUnderConstantLight) {
  const double one = errorWithEdgeReach("1"), eight = errorWithEdgeReach("8"), never = errorWithEdgeReach("0");
  EXPECT_GT(one, 1.1 * eight);
  EXPECT_GT(eight, 1.01 * never);
  EXPECT_GT(never, 0);
}

TEST(Lab, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto rowsOn = [](std::size_t threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return experiments::resultsCsv(runLab(small()));
  };
  EXPECT_EQ(rowsOn(1), rowsOn(3));
}

TEST(Lab, SummarisesEveryVariantInEveryCase) {
  const experiments::Results results = runLab(small());
  const auto full = standings(results, "full");
  ASSERT_EQ(full.size(), 2u);
  EXPECT_EQ(full[0].variant, "seed");
  EXPECT_NEAR(full[0].toSeed, 1, 1e-12);
  EXPECT_NEAR(full[0].bySeeds.high, 1, 1e-12);
  EXPECT_LT(full[1].bySeeds.low, full[1].bySeeds.high);
  EXPECT_NEAR(full[1].bySeeds.mean, full[1].toSeed, 0.1 * full[1].toSeed);
  EXPECT_GE(full[1].worst, full[1].toBaseline);
  EXPECT_NE(overviewText(results).find("lag-checked"), std::string::npos);
  EXPECT_NE(overviewHtml(results).find("<svg"), std::string::npos);
}

TEST(LabCases, StretchedOnesAreAllOthersAndStayLegal) {
  const LabConfig plain = labConfigFrom(experiments::Json::object(), {}, ""),
                  held = labConfigFrom({}, {"stretch=[0.7, 1.4]"}, "");
  const std::size_t count = plain.cases.size();
  ASSERT_EQ(held.cases.size(), 2 * count);
  for (std::size_t i = 0; i < 2 * count; ++i) {
    const Case& c = held.cases[i];
    EXPECT_EQ(c.name, plain.cases[i % count].name + (i < count ? "-x0.7" : "-x1.4"));
    EXPECT_NE(c.noise.sigma, plain.cases[i % count].noise.sigma);
    Case read;  // every number lies within the limits of its setting
    EXPECT_NO_THROW(experiments::fromJson(experiments::toJson(c), read));
    EXPECT_EQ(read.signal.period, c.signal.period);
  }
  EXPECT_EQ(held.cases[0].pattern.foveation.inside, 6);  // 5.6
  EXPECT_EQ(held.cases[0].pattern.foveation.outside, 1);
  EXPECT_TRUE(held.stretch.empty());  // a second reading stretches nothing again
  const LabConfig some = labConfigFrom({}, {"stretch=[1.4]"}, "held-spot");
  ASSERT_EQ(some.cases.size(), 1u);
  EXPECT_NEAR(some.cases[0].noise.held, 1 - 0.1f / 1.4f, 1e-6f);  // 14 frames instead of 10
}

TEST(Lab, RefusesWhatItCannotRun) {
  const auto refused = [](const std::vector<std::string>& changes, const char* only = "") {
    EXPECT_THROW(labConfigFrom({}, changes, only), core::UsageError);
  };
  refused({}, "no such case");
  refused({"seeds=[1,1]"});
  refused({"first=96"});
  refused({"variants=[\"nobody\"]"});
  refused({"cases.0.noise.sigma=-1"});
  refused({"stretch=[0]"});
  refused({"stretch=[2, 2]"});
}

}  // namespace
