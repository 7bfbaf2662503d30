// Philox gives the published vectors; streams are uniform and independent of each other, by chi-square tests at a
// significance of 1e-4 with fixed seeds, each shown to catch a biased variant.
#include "core/random.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <vector>

namespace core {
namespace {

using Block = std::array<std::uint32_t, 4>;

// Source: Random123 1.14, examples/kat_vectors, philox4x32 with 10 rounds.
TEST(Philox, KnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t kOnes = 0xffffffffu;
  EXPECT_EQ(philox({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

constexpr int kBins = 64, kDraws = 1 << 16;
constexpr double kBound = 113.5;  ///< chi-square with 63 degrees of freedom exceeds it with probability 1e-4

/// Chi-square of draw(i), i in [0, kDraws), against the uniform distribution on [0, 1).
double chiSquare(const std::function<float(int)>& draw) {
  std::vector<int> counts(kBins);
  for (int i = 0; i < kDraws; ++i) ++counts[static_cast<int>(draw(i) * kBins)];
  const double expected = static_cast<double>(kDraws) / kBins;
  double sum = 0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

TEST(Rng, OneStreamIsUniform) {
  Rng rng(7, Pass::candidates, 11, 3);
  EXPECT_LT(chiSquare([&](int) { return rng.uniform(); }), kBound);
}

TEST(Rng, FirstNumbersOfManyStreamsAreUniform) {
  const auto number = [](int i) { return static_cast<std::uint32_t>(i); };
  EXPECT_LT(chiSquare([&](int i) { return Rng(1, Pass::shade, number(i), 0).uniform(); }), kBound) << "pixels";
  EXPECT_LT(chiSquare([&](int i) { return Rng(1, Pass::shade, 0, number(i)).uniform(); }), kBound) << "frames";
  EXPECT_LT(chiSquare([&](int i) { return Rng(1, Pass::shade, 0, 0, number(i)).uniform(); }), kBound) << "samples";
  EXPECT_LT(chiSquare([&](int i) { return Rng(number(i), Pass::shade, 0, 0).uniform(); }), kBound) << "seeds";
}

TEST(Rng, NeighbouringStreamsDoNotFollowEachOther) {
  const auto difference = [](int i) {
    const auto pixel = static_cast<std::uint32_t>(2 * i);
    const float d = Rng(5, Pass::lab, pixel, 9).uniform() - Rng(5, Pass::lab, pixel + 1, 9).uniform();
    return d - std::floor(d);
  };
  EXPECT_LT(chiSquare(difference), kBound);
}

TEST(Rng, ChiSquareCatchesABiasOfTwoPercent) {
  Rng rng(7, Pass::candidates, 11, 3);
  const auto biased = [&](int) {
    const float u = rng.uniform();
    return u < 0.02f ? 0.5f * rng.uniform() : u;
  };
  EXPECT_GT(chiSquare(biased), kBound);
}

TEST(Rng, SeedsPassesPixelsFramesAndSamplesDiffer) {
  std::set<std::uint32_t> first;
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    for (const Pass pass : {Pass::candidates, Pass::temporal, Pass::spatial})
      for (std::uint32_t pixel = 0; pixel < 3; ++pixel)
        for (std::uint32_t frame = 0; frame < 3; ++frame)
          for (std::uint32_t sample = 0; sample < 3; ++sample)
            first.insert(Rng(seed, pass, pixel, frame, sample).bits());
  EXPECT_EQ(first.size(), 243u);
}

TEST(Rng, UniformStaysBelowOneAndBelowStaysBelow) {
  EXPECT_LT(static_cast<float>(0xffffffffu >> 8) * 0x1p-24f, 1.0f);
  Rng rng(3, Pass::other, 0, 0);
  std::set<std::uint32_t> seen;
  for (int i = 0; i < 1000; ++i) seen.insert(rng.below(5));
  EXPECT_EQ(seen, (std::set<std::uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(rng.below(1), 0u);
}

}  // namespace
}  // namespace core
