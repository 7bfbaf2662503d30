#include "twohistory/drift.h"

namespace twohistory {
namespace {

using core::kBlock;

/// One tap of the window: pointers to q's values, and to the sums of p.
struct Tap {
  const float *exponent, *factor, *difference, *noise, *sampleVariance;
  int count;
};

TWOFOLD_CLONES void addTap(const Tap& t, float* __restrict weight, float* __restrict difference,
                           float* __restrict squared, float* __restrict noise, float* __restrict weightSquared,
                           float* __restrict sampleVariance, float* __restrict quadrantWeight,
                           float* __restrict quadrantDifference) {
  const float *e = t.exponent, *f = t.factor, *d = t.difference, *v = t.noise, *s = t.sampleVariance;
#pragma omp simd
  for (int i = 0; i < t.count; ++i) {
    const float o = f[i] * core::expNegative(-e[i]);
    const float od = o * d[i];
    weight[i] += o;
    difference[i] += od;
    squared[i] += od * d[i];
    noise[i] += o * o * v[i];
    weightSquared[i] += o * o;
    sampleVariance[i] += o * s[i];
    quadrantWeight[i] += o;
    quadrantDifference[i] += od;
  }
}

/// Pinwheel: every tap but the centre belongs to one of four equal quadrants.
int quadrantOf(int dx, int dy) {
  if (dx > 0 && dy >= 0) return 0;
  if (dx <= 0 && dy > 0) return 1;
  if (dx < 0 && dy <= 0) return 2;
  return 3;
}

void clear(DriftRow& r, int count) {
  for (auto* sums : {&r.weight, &r.difference, &r.squared, &r.noise, &r.weightSquared, &r.sampleVariance})
    std::fill_n(sums->begin(), count, 0.0f);
  for (int q = 0; q < DriftRow::kQuadrants; ++q) {
    std::fill_n(r.quadrantWeight[q].begin(), count, 0.0f);
    std::fill_n(r.quadrantDifference[q].begin(), count, 0.0f);
  }
}

}  // namespace

float DriftRow::safeNoise(int i) const {
  float noise2 = predictedNoise(i);
  if (!(weight[i] > 0)) return noise2;
  const float m = mean(i), count = weight[i] * weight[i] / weightSquared[i];
  if (count > 1) noise2 = std::max(noise2, (squared[i] / weight[i] - m * m) / (count - 1));

  float sum = 0, sumSquared = 0;
  int quadrants = 0;
  for (int q = 0; q < kQuadrants; ++q) {
    if (!(quadrantWeight[q][i] > 0.05f * weight[i])) continue;
    const float value = quadrantDifference[q][i] / quadrantWeight[q][i];
    sum += value, sumSquared += value * value, ++quadrants;
  }
  if (quadrants < 2) return noise2;
  const float n = static_cast<float>(quadrants);
  return std::max(noise2, (sumSquared - sum * sum / n) / ((n - 1) * n));  // variance of the quadrants' mean
}

void sumDrift(const core::Guide& guide, const core::EdgeParameters& edges, core::In<float> difference,
              core::In<float> noise, core::In<float> sampleVariance, int radius, int y, int x0, int x1, DriftRow& out) {
  clear(out, x1 - x0);
  float exponent[kBlock], factor[kBlock];
  for (int dy = -radius; dy <= radius; ++dy) {
    if (y + dy < 0 || y + dy >= guide.height()) continue;
    for (int dx = -radius; dx <= radius; ++dx) {
      const int begin = std::max(x0, -dx), end = std::min(x1, guide.width() - dx), i = begin - x0;
      if (end <= begin) continue;
      core::edgeTerms(guide, edges, y, dx, dy, begin, end, exponent, factor);
      const int q = dx == 0 && dy == 0 ? -1 : quadrantOf(dx, dy);
      float spareWeight[kBlock], spareDifference[kBlock];
      if (q < 0) std::fill_n(spareWeight, end - begin, 0.0f), std::fill_n(spareDifference, end - begin, 0.0f);
      addTap({exponent, factor, difference.row(y + dy) + begin + dx, noise.row(y + dy) + begin + dx,
              sampleVariance.row(y + dy) + begin + dx, end - begin},
             &out.weight[i], &out.difference[i], &out.squared[i], &out.noise[i], &out.weightSquared[i],
             &out.sampleVariance[i], q < 0 ? spareWeight : &out.quadrantWeight[q][i],
             q < 0 ? spareDifference : &out.quadrantDifference[q][i]);
    }
  }
}

}  // namespace twohistory
