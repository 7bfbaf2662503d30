// Reservoirs choose in proportion to weights, and merging equals streaming. Smallest bias of a mean that is detected
// half of the time: 1 %; every control has more.
#include "restir/reservoir.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "restir/mis.h"
#include "tests/chi_square.h"
#include "tests/expect_mean.h"

namespace {

using core::LightSample;
using restir::Mis;
using restir::Reservoir;
using restir::ReservoirBuilder;

constexpr double kSignificance = 1e-6;

core::Rng rngOf(std::uint32_t trial, std::uint64_t seed = 1) { return {seed, core::Pass::lab, trial, 0}; }

/// A target over a few lights.
struct Table {
  std::vector<float> values;
  float operator()(const LightSample& y) const { return values[y.light]; }
};

std::vector<float> weightsOf(int count, double decades, bool descending) {
  std::vector<float> w(count);
  for (int i = 0; i < count; ++i) {
    const int at = descending ? count - 1 - i : i;
    w[at] = static_cast<float>(std::pow(10.0, -decades * i / count));
  }
  return w;
}

Reservoir stream(const std::vector<float>& weights, core::Rng& rng) {
  ReservoirBuilder builder;
  for (std::uint32_t i = 0; i < weights.size(); ++i) builder.add({i, {}}, 1, weights[i], rng);
  return builder.finish(1, 0);
}

/// p value of which candidate is kept; keep: draws one trial.
template <class Keep>
double chiSquareOf(const std::vector<float>& weights, int trials, Keep&& keep) {
  std::vector<double> counts(weights.size()), expected(weights.size());
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) expected[i] = trials * weights[i] / sum;
  for (int t = 0; t < trials; ++t) {
    core::Rng rng = rngOf(t);
    ++counts[keep(rng)];
  }
  return tests::chiSquareP(counts, expected);
}

TEST(Reservoir, KeepsInProportionToWeights) {
  for (int count : {1, 2, 3, 16, 256, 4096})
    for (double decades : {0.0, 6.0})
      for (bool descending : {false, true}) {
        const auto weights = weightsOf(count, decades, descending);
        const int trials = std::clamp(4'000'000 / count, 2000, 1'000'000);
        EXPECT_GT(chiSquareOf(weights, trials, [&](core::Rng& rng) { return stream(weights, rng).sample.light; }),
                  kSignificance)
            << count << " candidates over " << decades << " decades";
      }
}

TEST(Reservoir, ChiSquareCatchesAReservoirThatFavoursItsLast) {
  // A random number in (0, 0.97) instead of (0, 1) keeps later candidates 3 % too often.
  const std::vector<float> weights{1, 1, 1};
  const auto keep = [&](core::Rng& rng) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < 3; ++i)
      if (0.97f * rng.uniform() * (i + 1) < 1) kept = i;
    return kept;
  };
  EXPECT_LT(chiSquareOf(weights, 1'000'000, keep), kSignificance);
}

// Ten fixed candidates of one target: streamed, or split, and merged.
const Table kTen{{3, 1, 4, 1, 5, 9, 2, 6, 5, 3}};
const std::vector<float> kTenDensities{.1f, .2f, .05f, .05f, .1f, .1f, .1f, .1f, .1f, .1f};
using Split = std::vector<std::vector<std::uint32_t>>;

struct Merged {
  double p;       ///< of what is kept, against streaming
  double worstW;  ///< largest relative difference of p-hat W from streaming's, which is the same for whatever is kept
};
/// confidence: of a part of so many candidates.
template <class Confidence>
Merged mergedTen(const Split& split, Mis mis, int trials, Confidence&& confidence) {
  std::vector<float> weights(10);
  for (int i = 0; i < 10; ++i) weights[i] = kTen.values[i] / kTenDensities[i];
  const double mean = std::accumulate(weights.begin(), weights.end(), 0.0) / 10;
  Merged merged{0, 0};
  merged.p = chiSquareOf(weights, trials, [&](core::Rng& rng) {
    std::vector<restir::Source<Table>> sources;
    for (const auto& indices : split) {
      ReservoirBuilder builder;
      for (std::uint32_t i : indices)
        builder.add({i, {}}, kTen.values[i], weights[i] / static_cast<double>(indices.size()), rng);
      sources.push_back({builder.finish(confidence(indices.size()), 0), kTen});
    }
    const Reservoir r = restir::mergeReservoirs<Table>(sources, mis, 0, rng);
    merged.worstW = std::max(merged.worstW, std::abs(r.unbiasedWeight * kTen(r.sample) / mean - 1));
    return r.sample.light;
  });
  return merged;
}

const std::vector<Split> kSplits{
    {{9}, {1, 2, 3}, {0, 4, 5, 6, 7, 8}}, {{5, 7, 9}, {0, 1, 2, 3, 4, 6, 8}}, {{0, 1, 2, 3, 4}, {5, 6, 7, 8, 9}}};

TEST(Reservoir, MergingIsStreaming) {
  constexpr int kTrials = 400'000;
  for (const Split& split : kSplits)
    for (Mis mis : {Mis::constant, Mis::contribution, Mis::balance}) {
      const Merged m = mergedTen(split, mis, kTrials, [](std::size_t count) { return static_cast<float>(count); });
      EXPECT_GT(m.p, kSignificance);
      EXPECT_LT(m.worstW, 1e-5);
    }
  // What is kept too often or too seldom by 1 % adds trials (1 %)^2 to the nine that chi-square has in the mean.
  EXPECT_LT(tests::upperGamma(4.5, 0.5 * (9 + kTrials * 1e-4)), kSignificance);
}

TEST(Reservoir, MergingByPartsInPlaceOfCandidatesIsNotStreaming) {
  for (const Split& split : {kSplits[0], kSplits[1]}) {  // weights 1/k in place of M_i/M
    const Merged m = mergedTen(split, Mis::constant, 100'000, [](std::size_t) { return 1.0f; });
    EXPECT_LT(m.p, kSignificance);
    EXPECT_GT(m.worstW, 0.01);
  }
}

constexpr double kSumOfG = 1 + 2 + 3 + 4 + 0.5 + 2;

/// W g(y), whose mean is the sum of g over the target's support. spoil: factor on W as a function of how many of the M
/// candidates had weight.
template <class Spoil>
core::RunningMoments weightTimesFunction(Spoil&& spoil) {
  const Table target{{2, 0, 1, 5, 0, 0.2f, 3, 1}};
  const std::vector<float> g{1, 100, 2, 3, 100, 4, 0.5f, 2};  // elsewhere than the target: no matter
  constexpr int kCandidates = 4, kTrials = 2'000'000;
  core::RunningMoments moments;
  for (int t = 0; t < kTrials; ++t) {
    core::Rng rng = rngOf(t);
    ReservoirBuilder builder;
    int valid = 0;
    for (int i = 0; i < kCandidates; ++i) {
      const LightSample y{rng.below(8), {}};
      valid += target(y) > 0;
      builder.add(y, target(y), target(y) * 8.0 / kCandidates, rng);
    }
    const Reservoir r = builder.finish(kCandidates, 0);
    moments.add(r.unbiasedWeight > 0 ? r.unbiasedWeight * g[r.sample.light] * spoil(valid, kCandidates) : 0.0);
  }
  return moments;
}

TEST(Reservoir, WeightTimesFunctionIsItsSumOverTheSupport) {
  tests::expectUnbiased(weightTimesFunction([](int, int) { return 1.0; }), kSumOfG);
}

TEST(Reservoir, ExpectationCatchesNullSamplesThatDoNotCount) {
  tests::expectBiased(weightTimesFunction([](int valid, int all) { return double(all) / valid; }), kSumOfG);
}

/// A merge whose targets and confidences range widely; some are 0.
std::vector<restir::Source<Table>> oddSources(core::Rng& rng) {
  std::vector<restir::Source<Table>> sources(1 + rng.below(6));
  for (auto& s : sources) {
    const bool canonical = &s == sources.data();  // it has samples, and a target that can produce y
    s.reservoir.confidence = !canonical && rng.uniform() < 0.2f ? 0.0f : std::pow(10.0f, 6 * rng.uniform() - 2);
    s.target.values = {!canonical && rng.uniform() < 0.4f ? 0.0f : std::pow(10.0f, 12 * rng.uniform() - 6)};
  }
  return sources;
}

/// Sum of what each input that can produce y contributes; 1 if the mode is unbiased.
double sumOfWeights(Mis mis, std::span<const restir::Source<Table>> sources, const LightSample& y) {
  const float canonical = sources[0].target(y);
  double sum = 0;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (sources[i].reservoir.confidence > 0 && sources[i].target(y) > 0)
      sum += restir::misWeight<Table>(mis, sources, i, y, canonical);
  return sum * restir::normalisation<Table>(mis, sources, y, canonical);
}

TEST(Mis, WeightsSumToOneOverWhoeverCanProduceASample) {
  core::Rng rng = rngOf(0);
  int failedByConstant = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const auto sources = oddSources(rng);
    for (Mis mis : {Mis::contribution, Mis::balance, Mis::pairwise})
      EXPECT_NEAR(sumOfWeights(mis, sources, {0, {}}), 1, 1e-6) << static_cast<int>(mis);
    failedByConstant += std::abs(sumOfWeights(Mis::constant, sources, {0, {}}) - 1) > 1e-6;
  }
  EXPECT_GT(failedByConstant, 1000);
}

constexpr double kSumAfterMerges = 1 + 2 + 30;

/// W g(y) after two merges, one after the other, whose targets see different lights: its mean is the sum of g over what
/// the last canonical target sees.
core::RunningMoments afterMergesOfMerges(Mis mis) {
  const std::array<Table, 3> targets{{{{2, 0, 1, 5}}, {{0, 3, 1, 0}}, {{1, 4, 0, 0.1f}}}};
  const std::array<float, 4> g{1, 100, 2, 30};
  const auto fresh = [](const Table& target, int count, core::Rng& rng) {
    ReservoirBuilder builder;
    for (int i = 0; i < count; ++i) {
      const LightSample y{rng.below(4), {}};
      builder.add(y, target(y), target(y) * 4.0 / count, rng);
    }
    return builder.finish(static_cast<float>(count), 0);
  };
  core::RunningMoments moments;
  for (int t = 0; t < 500'000; ++t) {
    core::Rng rng = rngOf(t);
    const std::vector<restir::Source<Table>> first{{fresh(targets[1], 1, rng), targets[1]},
                                                   {fresh(targets[2], 3, rng), targets[2]}};
    const Reservoir merged = restir::mergeReservoirs<Table>(first, mis, 0, rng);
    const std::vector<restir::Source<Table>> second{{fresh(targets[0], 2, rng), targets[0]}, {merged, targets[1]}};
    const Reservoir r = restir::mergeReservoirs<Table>(second, mis, 0, rng);
    moments.add(r.unbiasedWeight > 0 ? r.unbiasedWeight * g[r.sample.light] : 0.0);
  }
  return moments;
}

TEST(Mis, WeightTimesFunctionIsItsSumAfterMergesOfMerges) {
  for (Mis mis : {Mis::contribution, Mis::balance, Mis::pairwise})
    tests::expectUnbiased(afterMergesOfMerges(mis), kSumAfterMerges);
  tests::expectBiased(afterMergesOfMerges(Mis::constant), kSumAfterMerges);
}

// A surface in a lamp's plane sees it by rounding alone: a target of 1e-16, which no candidate ever realises.
TEST(Mis, ContributionDoesNotCountWhoSeesASampleByRoundingAlone) {
  const std::array<Table, 2> targets{{{{2, 1}}, {{1e-16f, 3}}}};
  core::RunningMoments moments, naive;
  for (int t = 0; t < 50'000; ++t) {
    core::Rng rng = rngOf(t);
    std::vector<restir::Source<Table>> sources;
    for (const Table& target : targets) {
      ReservoirBuilder builder;
      const LightSample y{rng.below(2), {}};
      builder.add(y, target(y), 2.0 * target(y), rng);
      sources.push_back({builder.finish(1, 0), target});
    }
    const Reservoir r = restir::mergeReservoirs<Table>(sources, Mis::contribution, 0, rng);
    const bool chosen = r.unbiasedWeight > 0;
    moments.add(chosen ? r.unbiasedWeight : 0.0);
    // Control: whoever has any target counts, so nothing makes up for light 0, which input 1 never brings.
    naive.add(chosen ? r.unbiasedWeight /
                           restir::normalisation<Table>(Mis::contribution, sources, r.sample, targets[0](r.sample))
                     : 0.0);
  }
  tests::expectUnbiased(moments, 2);
  tests::expectBiased(naive, 2);
}

TEST(Mis, PairwiseLeavesTheCanonicalInputItsShare) {
  core::Rng rng = rngOf(0);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto sources = oddSources(rng);
    const std::span<const restir::Source<Table>> span(sources);
    const double share = sources[0].reservoir.confidence / double{restir::sumConfidence(span)};
    EXPECT_GE(restir::misWeight(Mis::pairwise, span, 0, {0, {}}, sources[0].target({0, {}})), share * (1 - 1e-6));
  }
}

}  // namespace
