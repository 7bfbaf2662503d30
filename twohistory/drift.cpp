#include "twohistory/drift.h"

namespace twohistory {
namespace {

/// Edge weights o of one tap, for all pixels of the block.
TWOFOLD_CLONES void weighTap(const float* exponent, const float* factor, int count, float* __restrict o) {
#pragma omp simd
  for (int i = 0; i < count; ++i) o[i] = factor[i] * core::expNegative(-exponent[i]);
}

/// sum += o v
TWOFOLD_CLONES void addWeighted(const float* o, const float* v, int count, float* __restrict sum) {
#pragma omp simd
  for (int i = 0; i < count; ++i) sum[i] += o[i] * v[i];
}

/// Sums along a row of what does not depend on the difference.
TWOFOLD_CLONES void addWeights(const float* o, const float* sampleVariance, int count, float* __restrict weight,
                               float* __restrict weightSquared, float* __restrict variance) {
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    weight[i] += o[i];
    weightSquared[i] += o[i] * o[i];
    variance[i] += o[i] * sampleVariance[i];
  }
}

TWOFOLD_CLONES void addDifference(const float* o, const float* d, const float* v, int count,
                                  float* __restrict difference, float* __restrict squared, float* __restrict noise) {
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const float od = o[i] * d[i];
    difference[i] += od;
    squared[i] += od * d[i];
    noise[i] += o[i] * o[i] * v[i];
  }
}

/// all += o (left + centre + right)
TWOFOLD_CLONES void addRow(const float* o, const float* left, const float* centre, const float* right, int count,
                           float* __restrict all) {
#pragma omp simd
  for (int i = 0; i < count; ++i) all[i] += o[i] * (left[i] + centre[i] + right[i]);
}

/// sum += o (a + b)
TWOFOLD_CLONES void addPair(const float* o, const float* a, const float* b, int count, float* __restrict sum) {
#pragma omp simd
  for (int i = 0; i < count; ++i) sum[i] += o[i] * (a[i] + b[i]);
}

/// sum += o^2 v
TWOFOLD_CLONES void addSquared(const float* o, const float* v, int count, float* __restrict sum) {
#pragma omp simd
  for (int i = 0; i < count; ++i) sum[i] += o[i] * o[i] * v[i];
}

void clear(DriftRow& r, int differences, int count) {
  const auto zero = [count](DriftRow::Row& row) { std::fill_n(row.begin(), count, 0.0f); };
  zero(r.weight), zero(r.weightSquared), zero(r.sampleVariance), zero(r.brightness);
  for (auto& q : r.quadrantWeight) zero(q);
  for (int k = 0; k < differences; ++k) {
    zero(r.of[k].difference), zero(r.of[k].squared), zero(r.of[k].noise);
    for (auto& q : r.of[k].quadrant) zero(q);
  }
}

/// Edge weights of the leg (dx, dy) from pixels [begin, end) of row y.
void weighLeg(const DriftSource& s, int y, int dx, int dy, int begin, int end, float* o) {
  float exponent[DriftBlock::kWidth], factor[DriftBlock::kWidth];
  core::edgeTerms(s.guide, s.edges, y, dx, dy, begin, end, exponent, factor);
  weighTap(exponent, factor, end - begin, o);
}

}  // namespace

float DriftRow::spread(int k, int i) const {
  const float m = mean(k, i);
  return weight[i] > 0 ? std::max(0.0f, of[k].squared[i] / weight[i] - m * m) : 0;
}

float DriftRow::safeNoise(int k, int i) const {
  float noise2 = predictedNoise(k, i);
  if (!(weight[i] > 0)) return noise2;
  const float count = weight[i] * weight[i] / weightSquared[i];
  if (count > 1) noise2 = std::max(noise2, spread(k, i) / (count - 1));

  float sum = 0, sumSquared = 0;
  int quadrants = 0;
  for (int q = 0; q < kQuadrants; ++q) {
    if (!(quadrantWeight[q][i] > 0.05f * weight[i])) continue;
    const float value = of[k].quadrant[q][i] / quadrantWeight[q][i];
    sum += value, sumSquared += value * value, ++quadrants;
  }
  if (quadrants < 2) return noise2;
  const float n = static_cast<float>(quadrants);
  return std::max(noise2, (sumSquared - sum * sum / n) / ((n - 1) * n));  // variance of the quadrants' mean
}

void DriftBlock::sumRows(int x0, int x1, int y0, int y1) {
  x0_ = x0, x1_ = x1, first_ = std::max(0, y0 - source_.radius);
  const int last = std::min(source_.guide.height(), y1 + source_.radius);
  rows_.assign(static_cast<std::size_t>(last - first_), Along{});
  for (int y = first_; y < last; ++y) sumRow(y, rows_[static_cast<std::size_t>(y - first_)]);
}

void DriftBlock::sumRow(int y, Along& out) const {
  float o[kWidth];
  const auto third = [](Thirds& t, int dx) { return (dx < 0 ? t.left : dx > 0 ? t.right : t.centre).data(); };
  for (int dx = -source_.radius; dx <= source_.radius; ++dx) {
    const int begin = std::max(x0_, -dx), end = std::min(x1_, source_.guide.width() - dx), i = begin - x0_;
    if (end <= begin) continue;
    weighLeg(source_, y, dx, 0, begin, end, o);
    addWeights(o, source_.sampleVariance.row(y) + begin + dx, end - begin, third(out.weight, dx) + i,
               &out.weightSquared[i], &out.sampleVariance[i]);
    addWeighted(o, source_.brightness.row(y) + begin + dx, end - begin, &out.brightness[i]);
    for (int k = 0; k < source_.count; ++k) {
      const Difference& d = source_.differences[k];
      addDifference(o, d.value.row(y) + begin + dx, d.noise.row(y) + begin + dx, end - begin,
                    third(out.of[k].difference, dx) + i, &out.of[k].squared[i], &out.of[k].noise[i]);
    }
  }
}

/// Pinwheel: every tap but the centre belongs to one of four equal quadrants. 0: dx > 0, dy >= 0; 1: dx <= 0, dy > 0;
/// 2: dx < 0, dy <= 0; 3: dx >= 0, dy < 0.
void DriftBlock::addAlong(const Along& row, int i, int n, int dy, int differences, const float* o, DriftRow& out) {
  const auto thirds = [&](const Thirds& t, DriftRow::Row& all, std::array<DriftRow::Row, kQuadrants>& quadrant) {
    addRow(o, &t.left[i], &t.centre[i], &t.right[i], n, all.data());
    if (dy >= 0) addWeighted(o, &t.right[i], n, quadrant[0].data());
    if (dy > 0) addPair(o, &t.left[i], &t.centre[i], n, quadrant[1].data());
    if (dy <= 0) addWeighted(o, &t.left[i], n, quadrant[2].data());
    if (dy < 0) addPair(o, &t.centre[i], &t.right[i], n, quadrant[3].data());
  };
  thirds(row.weight, out.weight, out.quadrantWeight);
  addSquared(o, &row.weightSquared[i], n, out.weightSquared.data());
  addWeighted(o, &row.sampleVariance[i], n, out.sampleVariance.data());
  addWeighted(o, &row.brightness[i], n, out.brightness.data());
  for (int k = 0; k < differences; ++k) {
    thirds(row.of[k].difference, out.of[k].difference, out.of[k].quadrant);
    addWeighted(o, &row.of[k].squared[i], n, out.of[k].squared.data());
    addSquared(o, &row.of[k].noise[i], n, out.of[k].noise.data());
  }
}

void DriftBlock::sumWindows(int y, int begin, int end, DriftRow& out) const {
  clear(out, source_.count, end - begin);
  float o[kWidth];
  for (int dy = -source_.radius; dy <= source_.radius; ++dy) {
    if (y + dy < 0 || y + dy >= source_.guide.height()) continue;
    weighLeg(source_, y, 0, dy, begin, end, o);
    addAlong(rows_[static_cast<std::size_t>(y + dy - first_)], begin - x0_, end - begin, dy, source_.count, o, out);
  }
}

}  // namespace twohistory
