// A world of three pixels and four lights whose sums are known exactly, and means over many trials in it.
#pragma once

#include <tbb/parallel_for.h>

#include <array>
#include <functional>
#include <vector>

#include "restir/mis.h"
#include "tests/expect_mean.h"

namespace tests::tiny {

using core::LightSample;
using restir::Mis;
using restir::Reservoir;
using restir::ReservoirBuilder;
using tests::expectBiased;
using tests::expectUnbiased;
using tests::kLeastBias;

inline constexpr int kPixels = 3, kLights = 4;

/// A target: its value for each light.
struct Table {
  std::array<float, kLights> values;
  float operator()(const LightSample& y) const { return values[y.light]; }
};
using Source = restir::Source<Table>;

// Unshadowed targets of the pixels now, one and two frames ago (a light moves), and who sees which light now.
inline constexpr std::array<Table, kPixels> kNow{{{{4, 1, 2, 0}}, {{0, 3, 1, 2}}, {{1, 0, 5, 1}}}};
inline constexpr std::array<Table, kPixels> kBefore{{{{1, 4, 0, 2}}, {{2, 3, 1, 0}}, {{1, 1, 3, 3}}}};
inline constexpr std::array<Table, kPixels> kLongAgo{{{{0, 1, 3, 3}}, {{1, 0, 0, 2}}, {{2, 2, 0, 1}}}};
inline constexpr std::array<Table, kPixels> kSees{{{{1, 0, 1, 1}}, {{1, 1, 1, 0}}, {{0, 1, 1, 1}}}};
inline constexpr std::array<float, kLights> kPower{0.1f, 0.2f, 0.3f, 0.4f};  // of drawing a light

inline LightSample drawLight(core::Rng& rng) {
  float u = rng.uniform();
  for (std::uint32_t i = 0; i + 1 < kLights; ++i) {
    if (u < kPower[i]) return {i, {}};
    u -= kPower[i];
  }
  return {kLights - 1, {}};
}

/// Resampling weight of one of `count` candidates.
inline double candidateWeight(const Table& target, const LightSample& y, int count) {
  return target(y) / double(count * kPower[y.light]);
}

inline Reservoir fresh(const Table& target, int count, core::Rng& rng) {
  ReservoirBuilder builder;
  for (int i = 0; i < count; ++i) {
    const LightSample y = drawLight(rng);
    builder.add(y, target(y), candidateWeight(target, y, count), rng);
  }
  return builder.finish(static_cast<float>(count), 0);
}

inline float shadePixel(int pixel, const Reservoir& r) {
  return r.unbiasedWeight > 0 ? kNow[pixel](r.sample) * kSees[pixel](r.sample) * r.unbiasedWeight : 0.0f;
}

inline double exact(int pixel) {
  double sum = 0;
  for (int y = 0; y < kLights; ++y) sum += double(kNow[pixel].values[y]) * kSees[pixel].values[y];
  return sum;
}

/// The pixel's own fresh reservoir and one of its history, drawn for one target and claimed to be for another.
inline Reservoir temporal(int pixel, Mis mis, core::Rng& rng, const Table& drawnFor, const Table& claimed) {
  const std::vector<Source> sources{{fresh(kNow[pixel], 2, rng), kNow[pixel]}, {fresh(drawnFor, 5, rng), claimed}};
  return restir::mergeReservoirs<Table>(sources, mis, 0, rng);
}

/// Blocks of trials run in parallel and are added in order.
inline core::RunningMoments average(const std::function<float(core::Rng&)>& estimate, int trials = 800'000) {
  constexpr int kBlocks = 64;
  std::vector<core::RunningMoments> blocks(kBlocks);
  tbb::parallel_for(0, kBlocks, [&](int b) {
    for (int t = b * trials / kBlocks; t < (b + 1) * trials / kBlocks; ++t) {
      core::Rng rng(1, core::Pass::lab, static_cast<std::uint32_t>(t), 0);
      blocks[b].add(estimate(rng));
    }
  });
  core::RunningMoments moments;
  for (const auto& block : blocks) moments.merge(block);
  return moments;
}

}  // namespace tests::tiny
