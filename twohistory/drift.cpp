#include "twohistory/drift.h"

namespace twohistory {
namespace {

using core::kBlock;

/// Edge weights o of one tap, for all pixels of the block.
TWOFOLD_CLONES void weighTap(const float* exponent, const float* factor, int count, float* __restrict o) {
#pragma omp simd
  for (int i = 0; i < count; ++i) o[i] = factor[i] * core::expNegative(-exponent[i]);
}

TWOFOLD_CLONES void addWeights(const float* o, const float* sampleVariance, int count, float* __restrict weight,
                               float* __restrict weightSquared, float* __restrict variance,
                               float* __restrict quadrant) {
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    weight[i] += o[i];
    weightSquared[i] += o[i] * o[i];
    variance[i] += o[i] * sampleVariance[i];
    quadrant[i] += o[i];
  }
}

TWOFOLD_CLONES void addDifference(const float* o, const float* d, const float* v, int count,
                                  float* __restrict difference, float* __restrict squared, float* __restrict noise,
                                  float* __restrict quadrant) {
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const float od = o[i] * d[i];
    difference[i] += od;
    squared[i] += od * d[i];
    noise[i] += o[i] * o[i] * v[i];
    quadrant[i] += od;
  }
}

/// Pinwheel: every tap but the centre belongs to one of four equal quadrants.
int quadrantOf(int dx, int dy) {
  if (dx > 0 && dy >= 0) return 0;
  if (dx <= 0 && dy > 0) return 1;
  if (dx < 0 && dy <= 0) return 2;
  return 3;
}

void clear(DriftRow& r, int differences, int count) {
  const auto zero = [count](DriftRow::Row& row) { std::fill_n(row.begin(), count, 0.0f); };
  zero(r.weight), zero(r.weightSquared), zero(r.sampleVariance);
  for (auto& q : r.quadrantWeight) zero(q);
  for (int k = 0; k < differences; ++k) {
    zero(r.of[k].difference), zero(r.of[k].squared), zero(r.of[k].noise);
    for (auto& q : r.of[k].quadrant) zero(q);
  }
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

void sumDrift(const core::Guide& guide, const core::EdgeParameters& edges, const Difference* differences, int count,
              core::In<float> sampleVariance, int radius, int y, int x0, int x1, DriftRow& out) {
  clear(out, count, x1 - x0);
  float exponent[kBlock], factor[kBlock], o[kBlock], centre[kBlock];  // the centre tap belongs to no quadrant
  std::fill_n(centre, kBlock, 0.0f);
  for (int dy = -radius; dy <= radius; ++dy) {
    if (y + dy < 0 || y + dy >= guide.height()) continue;
    for (int dx = -radius; dx <= radius; ++dx) {
      const int begin = std::max(x0, -dx), end = std::min(x1, guide.width() - dx), i = begin - x0, n = end - begin;
      if (n <= 0) continue;
      core::edgeTerms(guide, edges, y, dx, dy, begin, end, exponent, factor);
      weighTap(exponent, factor, n, o);
      const int q = dx == 0 && dy == 0 ? -1 : quadrantOf(dx, dy);
      addWeights(o, sampleVariance.row(y + dy) + begin + dx, n, &out.weight[i], &out.weightSquared[i],
                 &out.sampleVariance[i], q < 0 ? centre : &out.quadrantWeight[q][i]);
      for (int k = 0; k < count; ++k) {
        DifferenceSums& sums = out.of[k];
        addDifference(o, differences[k].value.row(y + dy) + begin + dx, differences[k].noise.row(y + dy) + begin + dx,
                      n, &sums.difference[i], &sums.squared[i], &sums.noise[i], q < 0 ? centre : &sums.quadrant[q][i]);
      }
    }
  }
}

}  // namespace twohistory
