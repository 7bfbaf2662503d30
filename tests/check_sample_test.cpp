// Check samples are unbiased, and depend on no earlier frame, which reused samples do. Significance 1e-6 a test.
#include <gtest/gtest.h>

#include "experiments/pipeline.h"
#include "experiments/scenes/builtin.h"
#include "tests/restir_worlds.h"

namespace {

using tests::kHeight, tests::kPixels, tests::kWidth;

const double kLargestZ = core::sidakBound(1, 1e-6);
constexpr int kFrames = 4, kSequences = 4096, kBlocks = 64;

/// Frame sums of the last two frames of one sequence.
struct Sums {
  double before = 0, reused = 0, check = 0;
  core::dvec3 checkColour{0}, reusedColour{0};
};

double total(const core::Planes& image) {
  double sum = 0;
  for (int i = 0; i < kPixels; ++i) sum += core::luminance(image.view().at(i));
  return sum;
}

/// Sum over the block's one sample, times the four pixels that it stands for.
double totalOfChecks(const core::Planes& check) {
  double sum = 0;
  for (int i = 0; i < kPixels; ++i) sum += std::max(0.0, 4 * double(core::luminance(check.view().at(i))));
  return sum;
}

Sums render(const tests::World& world, std::uint64_t seed) {
  restir::RestirParameters p;
  p.demodulate = false;
  restir::RestirState state(kWidth, kHeight);
  core::Image<float> samples(kWidth, kHeight, 2.0f);
  core::Planes radiance(kWidth, kHeight), check(kWidth, kHeight);
  Sums sums;
  for (int f = 0; f < world.frames(); ++f) {
    const restir::Frame frame = world.frame(f, samples, seed);
    sums.before = total(radiance);
    restir::drawCandidates(p, frame, state);
    restir::shadeCheckSamples(p, frame, state, check);
    restir::reuseTemporally(p, frame, state);
    restir::reuseSpatiallyAndShade(p, frame, state, radiance);
  }
  sums.reused = total(radiance), sums.check = totalOfChecks(check);
  for (int i = 0; i < kPixels; ++i) {
    sums.checkColour += 4.0 * glm::max(core::dvec3(check.view().at(i)), core::dvec3(0));
    sums.reusedColour += core::dvec3(radiance.view().at(i));
  }
  return sums;
}

std::vector<Sums> renderAll(const tests::World& world) {
  std::vector<Sums> all(kSequences);
  tbb::parallel_for(0, kBlocks, [&](int b) {
    for (int s = b * kSequences / kBlocks; s < (b + 1) * kSequences / kBlocks; ++s)
      all[s] = render(world, static_cast<std::uint64_t>(s + 1));
  });
  return all;
}

/// z of the correlation between two members, by Fisher's transform.
double zOfCorrelation(const std::vector<Sums>& all, double Sums::*a, double Sums::*b) {
  core::RunningMoments ma, mb, product;
  for (const Sums& s : all) ma.add(s.*a), mb.add(s.*b);
  for (const Sums& s : all) product.add((s.*a - ma.mean()) * (s.*b - mb.mean()));
  const double r = product.mean() / std::sqrt(ma.variance() * mb.variance());
  return std::atanh(r) * std::sqrt(kSequences - 3.0);
}

const tests::World& world() {
  static const tests::World w(tests::makeWorld({}, true), kFrames);
  return w;
}
const std::vector<Sums>& sequences() {
  static const std::vector<Sums> all = renderAll(world());
  return all;
}

TEST(CheckSamples, AreUnbiased) {
  const tests::Estimate reference = tests::reference(world(), 16, 512);
  core::RunningMoments check, half;
  for (const Sums& s : sequences()) check.add(s.check), half.add(0.95 * s.check);
  const auto z = [&](const core::RunningMoments& m) {
    return (m.mean() - reference.total.mean()) / std::sqrt(m.meanVariance() + reference.total.meanVariance());
  };
  EXPECT_LT(std::abs(z(check)), kLargestZ) << check.mean() << " against " << reference.total.mean();
  EXPECT_GT(std::abs(z(half)), kLargestZ);  // control: 5 % of the light lost
}

// Reuse is unbiased, so its colour is what colour there is.
TEST(CheckSamples, HaveTheColourOfTheLight) {
  for (int c = 0; c < 3; ++c) {
    core::RunningMoments difference, greyDifference;
    for (const Sums& s : sequences()) {
      difference.add(s.checkColour[c] - s.reusedColour[c]);
      greyDifference.add(s.check - s.reusedColour[c]);
    }
    const auto z = [](const core::RunningMoments& m) { return std::abs(m.mean()) / std::sqrt(m.meanVariance()); };
    EXPECT_LT(z(difference), kLargestZ) << c;
    EXPECT_GT(z(greyDifference), kLargestZ) << c;  // control: luminance in all channels
  }
}

TEST(CheckSamples, DependOnNoEarlierFrameAsReusedSamplesDo) {
  EXPECT_LT(std::abs(zOfCorrelation(sequences(), &Sums::check, &Sums::before)), kLargestZ);
  EXPECT_GT(zOfCorrelation(sequences(), &Sums::reused, &Sums::before), kLargestZ);  // control: reuse correlates frames
}

TEST(CheckSamples, AreOneInABlockOfFourAndNoneWithoutSamples) {
  restir::RestirState state(kWidth, kHeight);
  core::Image<float> samples(kWidth, kHeight, 1.0f);
  core::Planes check(kWidth, kHeight);
  for (int x = 0; x < kWidth / 2; ++x)
    for (int y = 0; y < kHeight; ++y) samples(x, y) = 0;
  const restir::Frame frame = world().frame(0, samples, 1);
  restir::drawCandidates({}, frame, state);
  restir::shadeCheckSamples({}, frame, state, check);
  int all = 0;
  for (int y = 0; y < kHeight; y += 2)
    for (int x = 0; x < kWidth; x += 2) {
      int inBlock = 0;
      for (int i = 0; i < 4; ++i) inBlock += check.view().load(x + i % 2, y + i / 2).r >= 0;
      EXPECT_LE(inBlock, x < kWidth / 2 ? 0 : 1);
      all += inBlock;
    }
  EXPECT_GT(all, kPixels / 16);  // half of the right half's blocks, some of which see no surface
}

TEST(CheckSamples, AreNotMadeWithoutReuseWhereRadianceItselfIsIndependent) {
  const core::Scene scene = experiments::builtinScene("cornell");
  const experiments::Stage stage(scene);
  for (const restir::Reuse reuse : {restir::Reuse::none, restir::Reuse::both}) {
    experiments::ShadeParameters p;
    p.checkSamples = true, p.restir.reuse = reuse;
    experiments::ShadeState state(stage, p, 1, 32, 24);
    EXPECT_EQ(shade(stage, p, 0, state).check.empty(), reuse == restir::Reuse::none);
  }
}

}  // namespace
