#include "svgf/atrous.h"

#include <cstring>

#include "core/parallel.h"
#include "core/simd.h"

namespace svgf {
namespace {

using core::Guide;
using core::In;
using core::kBlock;

constexpr int kRadius = kAtrousRadius;
constexpr float kKernel[kRadius + 1] = {1.0f, 2.0f / 3, 1.0f / 6};  // B3 spline, relative to its centre
constexpr int kMostDifferences = 6;                                 // three colours of two more histories
constexpr int kChannels = core::kChannels<core::Stored>;            // of them in one element of Level::differences

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
  float plane[3][kBlock];
  float difference[kMostDifferences][kBlock];
};

/// Pixels of a row, and those among them whose differences are not all 0.
struct Span {
  int y, x0, x1, d0, d1;

  Span(const Level& level, int row, int begin, int end) : y(row), x0(begin), x1(end), d0(begin), d1(end) {
    if (level.twins) level.twins->narrow(y, kRadius * level.step, d0, d1);
  }
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

/// To the rows of as many sums as one element has channels.
TWOFOLD_CLONES void addDifferences(const float* __restrict weight, const core::Stored* __restrict value, int count,
                                   float* __restrict sum) {
#pragma omp simd
  for (int i = 0; i < count; ++i)
    for (int c = 0; c < kChannels; ++c) sum[c * kBlock + i] += weight[i] * core::channelOf(value[i], c);
}

void clear(Sums& s, std::size_t differences, int count) {
  std::fill_n(s.weight, count, 0.0f);
  std::fill_n(s.variance, count, 0.0f);
  for (auto& plane : s.plane) std::fill_n(plane, count, 0.0f);
  for (std::size_t c = 0; c < differences * kChannels; ++c) std::fill_n(s.difference[c], count, 0.0f);
}

/// Adds the tap (dx, dy), in pixels, to the sums.
void addTap(const Level& level, const Guide& guide, const Span& span, int dx, int dy, float kernel, Sums& s) {
  const int x0 = span.x0, y = span.y, begin = std::max(x0, -dx), end = std::min(span.x1, guide.width() - dx);
  if (end <= begin || y + dy < 0 || y + dy >= guide.height()) return;
  float exponent[kBlock], factor[kBlock], weight[kBlock];
  core::edgeTerms(guide, level.edges, y, dx, dy, begin, end, exponent, factor);
  const int i = begin - x0, count = end - begin, q = begin + dx;
  weightKernel(exponent, factor, level.luminance.row(y) + begin, level.luminance.row(y + dy) + q,
               level.tolerance.row(y) + begin, level.variance.row(y + dy) + q, kernel, count, weight, s.weight + i,
               s.variance + i);
  for (int c = 0; c < 3; ++c) addKernel(weight, level.input.plane[c].row(y + dy) + q, count, s.plane[c] + i);
  const int first = std::max(begin, span.d0), last = std::min(end, span.d1);
  if (last <= first) return;
  for (std::size_t d = 0; d < level.differences.size(); ++d)
    addDifferences(weight + first - begin, level.differences[d].row(y + dy) + first + dx, last - first,
                   s.difference[d * kChannels] + first - x0);
}

/// Mean of the differences whose sums begin at `sum`, one row a channel, at pixel i of the block.
template <class Stored>
Stored meanDifference(const float (*sum)[kBlock], float scale, int i) {
  if constexpr (kChannels == 1)
    return sum[0][i] * scale;
  else
    return core::vec3(sum[0][i], sum[1][i], sum[2][i]) * scale;
}

void writeDifferences(const Level& level, const Span& span, const Sums& s) {
  for (std::size_t d = 0; d < level.differences.size(); ++d) {
    core::Stored* out = level.differencesOut[d].row(span.y);
    const core::Stored* in = level.differences[d].row(span.y);
    std::fill(out + span.x0, out + span.d0, core::Stored(0));
    for (int x = span.d0; x < span.d1; ++x) {
      const int i = x - span.x0;
      out[x] = s.weight[i] > 0 ? meanDifference<core::Stored>(&s.difference[d * kChannels], 1 / s.weight[i], i) : in[x];
    }
    std::fill(out + std::max(span.d0, span.d1), out + span.x1, core::Stored(0));
  }
}

void writeBlock(const Level& level, const Span& span, const Sums& s) {
  for (int x = span.x0; x < span.x1; ++x) {
    const int i = x - span.x0;
    const bool any = s.weight[i] > 0;
    const float scale = any ? 1 / s.weight[i] : 0.0f;
    level.varianceOut(x, span.y) = any ? s.variance[i] * scale * scale : level.variance(x, span.y);
    for (int c = 0; c < 3; ++c)
      level.output.plane[c](x, span.y) = any ? s.plane[c][i] * scale : level.input.plane[c](x, span.y);
  }
  writeDifferences(level, span, s);
}

}  // namespace

void atrous(const Level& level, const Guide& guide) {
  CHECK_LE(level.differences.size() * kChannels, static_cast<std::size_t>(kMostDifferences));
  CHECK_EQ(level.differences.size(), level.differencesOut.size());
  fillTolerance(level, guide);
  core::forEachRow(guide.height(), [&](int y) {
    Sums sums;
    for (int x0 = 0; x0 < guide.width(); x0 += kBlock) {
      const Span span(level, y, x0, std::min(x0 + kBlock, guide.width()));
      clear(sums, level.differences.size(), span.x1 - x0);
      for (int j = -kRadius; j <= kRadius; ++j)
        for (int i = -kRadius; i <= kRadius; ++i)
          addTap(level, guide, span, i * level.step, j * level.step, kKernel[std::abs(i)] * kKernel[std::abs(j)], sums);
      writeBlock(level, span, sums);
    }
  });
}

}  // namespace svgf
