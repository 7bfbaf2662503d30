#include "svgf/atrous.h"

#include <cstring>

#include "core/parallel.h"
#include "core/simd.h"

namespace svgf {
namespace {

using core::Guide;
using core::In;
using core::kBlock;

constexpr int kRadius = 2;
constexpr float kKernel[kRadius + 1] = {1.0f, 2.0f / 3, 1.0f / 6};  // B3 spline, relative to its centre
constexpr int kMostPlanes = 9;                                      // three colours of three histories

/// Variance around a pixel, 3x3 Gaussian over pixels of the same instance, renormalised at borders and edges.
float smoothVariance(const Guide& guide, In<float> variance, int x, int y) {
  constexpr float kGauss[2] = {0.5f, 0.25f};
  float sum = 0, total = 0;
  for (int j = std::max(0, y - 1); j <= std::min(y + 1, guide.height() - 1); ++j) {
    for (int i = std::max(0, x - 1); i <= std::min(x + 1, guide.width() - 1); ++i) {
      if (guide.id(i, j) != guide.id(x, y)) continue;
      const float w = kGauss[std::abs(i - x)] * kGauss[std::abs(j - y)];
      sum += w * variance(i, j);
      total += w;
    }
  }
  return sum / total;
}

/// [SVGF (5)] 1 / (sigma_l sqrt(g3x3(Var))), with a floor relative to the luminance itself: the filter must do the same
/// at every exposure.
void fillTolerance(const Level& level, const Guide& guide) {
  constexpr float kRelativeFloor = 1e-4f, kTiny = 1e-30f;
  core::forEachPixel(guide.width(), guide.height(), [&](int x, int y) {
    const float floor = kRelativeFloor * level.luminance(x, y);
    const float variance = smoothVariance(guide, level.variance, x, y) + floor * floor + kTiny;
    level.tolerance(x, y) = 1 / (level.phiColour * std::sqrt(variance));
  });
}

/// Sums of one block of a row.
struct Sums {
  float weight[kBlock], variance[kBlock];
  float plane[kMostPlanes][kBlock];
};

TWOFOLD_CLONES void weightKernel(const float* __restrict exponent, const float* __restrict factor, const float* lumP,
                                 const float* lumQ, const float* tolerance, const float* varianceQ, float kernel,
                                 int count, float* __restrict weight, float* __restrict sumWeight,
                                 float* __restrict sumVariance) {
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const float luminanceCost = std::abs(lumP[i] - lumQ[i]) * tolerance[i];
    const float w = kernel * factor[i] * core::expNegative(-(exponent[i] + luminanceCost));
    weight[i] = w;
    sumWeight[i] += w;
    sumVariance[i] += w * w * varianceQ[i];
  }
}

TWOFOLD_CLONES void addKernel(const float* __restrict weight, const float* __restrict value, int count,
                              float* __restrict sum) {
#pragma omp simd
  for (int i = 0; i < count; ++i) sum[i] += weight[i] * value[i];
}

void clear(Sums& s, std::size_t planes, int count) {
  std::fill_n(s.weight, count, 0.0f);
  std::fill_n(s.variance, count, 0.0f);
  for (std::size_t c = 0; c < planes; ++c) std::fill_n(s.plane[c], count, 0.0f);
}

/// Adds the tap (dx, dy), in pixels, to the sums of [x0, x1).
void addTap(const Level& level, const Guide& guide, int y, int x0, int x1, int dx, int dy, float kernel, Sums& s) {
  const int begin = std::max(x0, -dx), end = std::min(x1, guide.width() - dx);
  if (end <= begin || y + dy < 0 || y + dy >= guide.height()) return;
  float exponent[kBlock], factor[kBlock], weight[kBlock];
  core::edgeTerms(guide, level.edges, y, dx, dy, begin, end, exponent, factor);
  const int i = begin - x0, count = end - begin, q = begin + dx;
  weightKernel(exponent, factor, level.luminance.row(y) + begin, level.luminance.row(y + dy) + q,
               level.tolerance.row(y) + begin, level.variance.row(y + dy) + q, kernel, count, weight, s.weight + i,
               s.variance + i);
  for (std::size_t c = 0; c < level.inputs.size(); ++c)
    addKernel(weight, level.inputs[c].row(y + dy) + q, count, s.plane[c] + i);
}

void writeBlock(const Level& level, int y, int x0, int x1, const Sums& s) {
  for (int x = x0; x < x1; ++x) {
    const int i = x - x0;
    const bool any = s.weight[i] > 0;
    const float scale = any ? 1 / s.weight[i] : 0.0f;
    level.varianceOut(x, y) = any ? s.variance[i] * scale * scale : level.variance(x, y);
    for (std::size_t c = 0; c < level.inputs.size(); ++c)
      level.outputs[c](x, y) = any ? s.plane[c][i] * scale : level.inputs[c](x, y);
  }
}

}  // namespace

void atrous(const Level& level, const Guide& guide) {
  CHECK_LE(level.inputs.size(), static_cast<std::size_t>(kMostPlanes));
  CHECK_EQ(level.inputs.size(), level.outputs.size());
  fillTolerance(level, guide);
  core::forEachRow(guide.height(), [&](int y) {
    Sums sums;
    for (int x0 = 0; x0 < guide.width(); x0 += kBlock) {
      const int x1 = std::min(x0 + kBlock, guide.width());
      clear(sums, level.inputs.size(), x1 - x0);
      for (int j = -kRadius; j <= kRadius; ++j)
        for (int i = -kRadius; i <= kRadius; ++i)
          addTap(level, guide, y, x0, x1, i * level.step, j * level.step, kKernel[std::abs(i)] * kKernel[std::abs(j)],
                 sums);
      writeBlock(level, y, x0, x1, sums);
    }
  });
}

}  // namespace svgf
