#include "core/edge_weight.h"

namespace core {
namespace {

/// Rows that one call reads, offset so that index i is pixel x0 + i (p) or x0 + dx + i (q).
struct EdgeRows {
  const float *depthP, *depthQ, *slope;
  const float *nxP, *nyP, *nzP, *nxQ, *nyQ, *nzQ;
  const std::uint32_t *idP, *idQ;
};

EdgeRows rowsOf(const Guide& g, int y, int dx, int dy, int x0) {
  const auto row = [](const auto& image, int line, int x) { return image.row(line) + x; };
  const auto& n = g.normal.plane;
  const int q = x0 + dx, yq = y + dy;
  return {row(g.depth, y, x0), row(g.depth, yq, q), row(g.depthSlope, y, x0), row(n[0], y, x0),
          row(n[1], y, x0),    row(n[2], y, x0),    row(n[0], yq, q),         row(n[1], yq, q),
          row(n[2], yq, q),    row(g.id, y, x0),    row(g.id, yq, q)};
}

TWOFOLD_CLONES void edgeKernel(const EdgeRows& r, float depthScale, float relativeDepth, float distance, int count,
                               float* __restrict exponent, float* __restrict factor) {
  const float *zp = r.depthP, *zq = r.depthQ, *slope = r.slope;
  const float *ax = r.nxP, *ay = r.nyP, *az = r.nzP, *bx = r.nxQ, *by = r.nyQ, *bz = r.nzQ;
  const std::uint32_t *ip = r.idP, *iq = r.idQ;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const float tolerance = (depthScale * slope[i] + relativeDepth * zp[i]) * distance;
    const float cost = std::abs(zp[i] - zq[i]) / tolerance;  // [SVGF (3)]
    float cosine = ax[i] * bx[i] + ay[i] * by[i] + az[i] * bz[i];
    cosine = cosine > 0 ? cosine : 0;
    cosine = cosine < 1 ? cosine : 1;
    float power = cosine * cosine;  // [SVGF (4)]: 2, 4, ... 128
    power *= power, power *= power, power *= power, power *= power, power *= power, power *= power;
    const bool same = ip[i] == iq[i] && ip[i] != kNoId;
    exponent[i] = same ? cost : 0.0f;  // where nothing was hit the depths are infinite and cost is not a number
    factor[i] = same ? power : 0.0f;
  }
}

}  // namespace

void edgeTerms(const Guide& guide, const EdgeParameters& parameters, int y, int dx, int dy, int x0, int x1,
               float* exponent, float* factor) {
  const float distance = std::sqrt(static_cast<float>(dx * dx + dy * dy));
  if (dx == 0 && dy == 0) {
    for (int i = 0; i < x1 - x0; ++i) {
      exponent[i] = 0;
      factor[i] = guide.id(x0 + i, y) == kNoId ? 0.0f : 1.0f;
    }
    return;
  }
  edgeKernel(rowsOf(guide, y, dx, dy, x0), parameters.depthScale, parameters.relativeDepth, distance, x1 - x0, exponent,
             factor);
}

}  // namespace core
