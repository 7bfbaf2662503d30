// Geometric edge-stopping weights, shared by à-trous filtering, lag regression's window means and gradient filters.
// Source: SVGF (Schied et al. 2017), equations (3) and (4).
#pragma once

#include "core/guide.h"
#include "core/simd.h"

namespace core {

/// weight(p, q) = factor * exp(-exponent):
///   [SVGF (3)] exponent = |z_p - z_q| / ((depthScale slope_p + relativeDepth z_p) |p - q|)
///   [SVGF (4)] factor   = max(0, n_p . n_q)^128, 0 where the instances differ
struct EdgeParameters {
  float depthScale = 1;         ///< sigma_z
  float relativeDepth = 1e-3f;  ///< keeps fronto-parallel planes together
};

/// Both terms for pixels x in [x0, x1) of row y against (x + dx, y + dy), which must lie inside the image.
/// exponent, factor: arrays whose element 0 belongs to x0.
void edgeTerms(const Guide& guide, const EdgeParameters& parameters, int y, int dx, int dy, int x0, int x1,
               float* exponent, float* factor);

/// The weight of one pair of pixels, for passes that look at few: the same formula, a pixel at a time.
inline float edgeWeight(const Guide& guide, const EdgeParameters& parameters, ivec2 p, ivec2 q) {
  const std::uint32_t id = guide.id(p.x, p.y);
  if (id == kNoId || id != guide.id(q.x, q.y)) return 0;
  if (p == q) return 1;
  const float z = guide.depth(p.x, p.y),
              distance = std::sqrt(static_cast<float>((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y)));
  const float tolerance =
      (parameters.depthScale * guide.depthSlope(p.x, p.y) + parameters.relativeDepth * z) * distance;
  float power = std::clamp(dot(guide.normal.load(p.x, p.y), guide.normal.load(q.x, q.y)), 0.0f, 1.0f);
  for (int doubling = 0; doubling < 7; ++doubling) power *= power;               // [SVGF (4)]
  return power * expNegative(-std::abs(z - guide.depth(q.x, q.y)) / tolerance);  // [SVGF (3)]
}

}  // namespace core
