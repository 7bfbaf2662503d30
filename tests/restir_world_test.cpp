// A world of three pixels and four lights whose sums are known exactly: which ways of reuse are unbiased, which are
// biased, and by how much. Every bias that is claimed is predicted or more than 1 %; smallest bias detected half of the
// time: 1 %.
#include <functional>

#include "tests/tiny_world.h"

namespace {

using namespace tests::tiny;

/// What merging with constant weights gives: each input i finds the lights that its own target sees.
double predictedConstant(int pixel, const std::vector<std::pair<float, Table>>& inputs) {
  double sum = 0, confidence = 0;
  for (const auto& [c, target] : inputs) {
    confidence += c;
    for (int y = 0; y < kLights; ++y)
      if (target.values[y] > 0) sum += c * double(kNow[pixel].values[y]) * kSees[pixel].values[y];
  }
  return sum / confidence;
}

std::vector<Source> spatialSources(int pixel, const std::function<Reservoir(int)>& reservoirOf) {
  std::vector<Source> sources{{reservoirOf(pixel), kNow[pixel]}};
  for (int q = 0; q < 3; ++q)
    if (q != pixel) sources.push_back({reservoirOf(q), kNow[q]});
  return sources;
}

Reservoir spatial(int pixel, Mis mis, core::Rng& rng, const std::function<Reservoir(int)>& reservoirOf) {
  return restir::mergeReservoirs<Table>(spatialSources(pixel, reservoirOf), mis, 0, rng);
}

/// The same in time and space, with every sample shaded in place of the one that is chosen.
float shadeAll(int pixel, Mis mis, core::Rng& rng) {
  const auto sources = spatialSources(pixel, [&](int q) { return temporal(q, mis, rng, kBefore[q], kBefore[q]); });
  float sum = 0;
  restir::forEachMerged<Table>(sources, mis, [&](const LightSample& y, float weight) {
    sum += shadePixel(pixel, Reservoir{y, weight, 1, 0});
  });
  return sum;
}

TEST(TinyWorld, ResamplingAloneIsUnbiased) {
  for (int p = 0; p < 3; ++p)
    expectUnbiased(average([&](core::Rng& rng) { return shadePixel(p, fresh(kNow[p], 3, rng)); }), exact(p));
}

class UnbiasedMode : public testing::TestWithParam<Mis> {};

TEST_P(UnbiasedMode, InTime) {
  for (int p = 0; p < 3; ++p)
    expectUnbiased(
        average([&](core::Rng& rng) { return shadePixel(p, temporal(p, GetParam(), rng, kBefore[p], kBefore[p])); }),
        exact(p));
}

TEST_P(UnbiasedMode, InSpace) {
  for (int p = 0; p < 3; ++p)
    expectUnbiased(average([&](core::Rng& rng) {
                     return shadePixel(p,
                                       spatial(p, GetParam(), rng, [&](int q) { return fresh(kNow[q], 1 + q, rng); }));
                   }),
                   exact(p));
}

TEST_P(UnbiasedMode, InTimeAndSpace) {
  for (int p = 0; p < 3; ++p)
    expectUnbiased(average([&](core::Rng& rng) {
                     return shadePixel(p, spatial(p, GetParam(), rng, [&](int q) {
                                         return temporal(q, GetParam(), rng, kBefore[q], kBefore[q]);
                                       }));
                   }),
                   exact(p));
}

TEST_P(UnbiasedMode, InTimeAndSpaceWithAllSamplesShaded) {
  for (int p = 0; p < 3; ++p)
    expectUnbiased(average([&](core::Rng& rng) { return shadeAll(p, GetParam(), rng); }), exact(p));
}

INSTANTIATE_TEST_SUITE_P(TinyWorld, UnbiasedMode, testing::Values(Mis::contribution, Mis::balance, Mis::pairwise));

TEST(TinyWorld, ConstantIsBiasedInTimeAsPredicted) {
  for (int p = 0; p < 3; ++p) {
    const auto m =
        average([&](core::Rng& rng) { return shadePixel(p, temporal(p, Mis::constant, rng, kBefore[p], kBefore[p])); });
    expectUnbiased(m, predictedConstant(p, {{2, kNow[p]}, {5, kBefore[p]}}));
    const double predicted = predictedConstant(p, {{2, kNow[p]}, {5, kBefore[p]}});
    if (std::abs(predicted - exact(p)) > 0.01 * exact(p)) expectBiased(m, exact(p));
  }
  EXPECT_LT(predictedConstant(0, {{2, kNow[0]}, {5, kBefore[0]}}), 0.9 * exact(0));  // there is one to see
}

TEST(TinyWorld, ConstantIsBiasedInSpaceAsPredicted) {
  for (int p = 0; p < 3; ++p) {
    const double predicted = predictedConstant(p, {{1, kNow[0]}, {2, kNow[1]}, {3, kNow[2]}});
    const auto m = average([&](core::Rng& rng) {
      return shadePixel(p, spatial(p, Mis::constant, rng, [&](int q) { return fresh(kNow[q], 1 + q, rng); }));
    });
    expectUnbiased(m, predicted);
    expectBiased(m, exact(p));
  }
}

/// How often, in the mean, a light is counted after merging with constant weights in time and then in space: each pixel
/// finds what it sees now, from the shares of its inputs that saw it.
double predictedInTimeAndSpace(int pixel) {
  double sum = 0;
  for (int y = 0; y < kLights; ++y)
    for (int q = 0; q < 3; ++q) {
      const double found = (2.0 * (kNow[q].values[y] > 0) + 5.0 * (kBefore[q].values[y] > 0)) / 7;
      if (kNow[q].values[y] > 0) sum += found / 3 * double(kNow[pixel].values[y]) * kSees[pixel].values[y];
    }
  return sum;
}

TEST(TinyWorld, ConstantIsBiasedInTimeAndSpaceAsPredicted) {
  for (int p = 0; p < 3; ++p) {
    const auto m = average([&](core::Rng& rng) {
      return shadePixel(p, spatial(p, Mis::constant, rng,
                                   [&](int q) { return temporal(q, Mis::constant, rng, kBefore[q], kBefore[q]); }));
    });
    expectUnbiased(m, predictedInTimeAndSpace(p));
    expectBiased(m, exact(p));
  }
}

TEST(TinyWorld, ConstantIsBiasedByTheSameWithAllSamplesShaded) {
  for (int p = 0; p < 3; ++p) {
    const auto m = average([&](core::Rng& rng) { return shadeAll(p, Mis::constant, rng); });
    expectUnbiased(m, predictedInTimeAndSpace(p));
    expectBiased(m, exact(p));
  }
}

TEST(TinyWorld, WaitingReservoirNeedsTheTargetItHad) {
  // Two frames old after a frame with n = 0. The last frame's target in its place has another support.
  const auto remembered =
      average([&](core::Rng& rng) { return shadePixel(0, temporal(0, Mis::balance, rng, kLongAgo[0], kLongAgo[0])); });
  const auto latest =
      average([&](core::Rng& rng) { return shadePixel(0, temporal(0, Mis::balance, rng, kLongAgo[0], kBefore[0])); });
  expectUnbiased(remembered, exact(0));
  expectBiased(latest, exact(0));
}

TEST(TinyWorld, RejectingNeighboursByTheirReservoirIsBiased) {
  // The same merge, but neighbours that found nothing are left out, with their confidence.
  const auto m = average([&](core::Rng& rng) {
    std::vector<Source> sources{{fresh(kNow[0], 1, rng), kNow[0]}};
    for (int q = 1; q < 3; ++q) {
      const Reservoir r = fresh(kNow[q], 1, rng);
      if (r.unbiasedWeight > 0) sources.push_back({r, kNow[q]});
    }
    return shadePixel(0, restir::mergeReservoirs<Table>(sources, Mis::balance, 0, rng));
  });
  expectBiased(m, exact(0));
}

TEST(TinyWorld, ConfidenceFromTheSampleIsBiased) {
  const auto m = average([&](core::Rng& rng) {
    std::vector<Source> sources{{fresh(kNow[0], 2, rng), kNow[0]}, {fresh(kBefore[0], 5, rng), kBefore[0]}};
    Reservoir& old = sources[1].reservoir;
    if (old.unbiasedWeight > 0) old.confidence *= kNow[0](old.sample);
    return shadePixel(0, restir::mergeReservoirs<Table>(sources, Mis::balance, 0, rng));
  });
  expectBiased(m, exact(0));
}

/// Last frame of a chain of ten frames of one pixel under relative cap 20; counts: of a frame, from the estimate
/// before.
core::RunningMoments chain(const std::function<int(int frame, float before)>& counts) {
  return average(
      [&](core::Rng& rng) {
        Reservoir history;
        float estimate = 0;
        for (int f = 0; f < 10; ++f) {
          const int n = counts(f, estimate);
          history.confidence = std::min(history.confidence, 20.0f * n);
          const std::vector<Source> sources{{fresh(kNow[0], n, rng), kNow[0]}, {history, kNow[0]}};
          history = restir::mergeReservoirs<Table>(sources, Mis::balance, f, rng);
          estimate = shadePixel(0, history);
        }
        return estimate;
      },
      200'000);
}

TEST(TinyWorld, CountsOnAScheduleAreUnbiased) {
  expectUnbiased(chain([](int f, float) { return f % 3 == 0 ? 8 : 1; }), exact(0));
}

TEST(TinyWorld, CountsFromTheLastEstimateAreBiased) {
  expectBiased(chain([](int, float before) { return before > 5 ? 1 : 8; }), exact(0));
}

/// Mean of four results in the last of six frames of one pixel; each frame, one of the results is fed back.
core::RunningMoments resultsFedBack(const std::function<int(const std::array<Reservoir, 4>&)>& choose) {
  return average(
      [&](core::Rng& rng) {
        Reservoir history;
        float mean = 0;
        for (int f = 0; f < 6; ++f) {
          history.confidence = std::min(history.confidence, 20.0f);
          std::array<Reservoir, 4> results;
          mean = 0;
          for (Reservoir& r : results) {
            const std::vector<Source> sources{{fresh(kNow[0], 1, rng), kNow[0]}, {history, kNow[0]}};
            r = restir::mergeReservoirs<Table>(sources, Mis::balance, 0, rng);
            mean += shadePixel(0, r) / 4;
          }
          history = results[choose(results)];
        }
        return mean;
      },
      200'000);
}

TEST(TinyWorld, ResultsFedBackByIndexAreUnbiased) {
  expectUnbiased(resultsFedBack([](const auto&) { return 0; }), exact(0));
}

TEST(TinyWorld, ResultsFedBackByTheBrightestAreBiased) {
  const auto m = resultsFedBack([](const std::array<Reservoir, 4>& results) {
    int best = 0;
    for (int i = 1; i < 4; ++i)
      if (shadePixel(0, results[i]) > shadePixel(0, results[best])) best = i;
    return best;
  });
  expectBiased(m, exact(0));
  EXPECT_GT(m.mean() / exact(0), 1.01);
}

}  // namespace
