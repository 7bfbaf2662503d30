#include "twohistory/reprojection.h"

#include "core/parallel.h"

namespace twohistory {
namespace {

using core::Guide;
using core::ivec2;
using core::vec2;

/// Where a surface point was: id and normal are the point's own, depth is what it had then.
struct Expected {
  std::uint32_t id;
  core::vec3 normal;
  float depth, tolerance;
};

/// q: inside the image.
bool isSameSurface(const Guide& before, ivec2 q, const Expected& e, float normalCosine) {
  if (before.id(q.x, q.y) != e.id) return false;
  if (std::abs(before.depth(q.x, q.y) - e.depth) > e.tolerance) return false;
  return dot(before.normal.load(q.x, q.y), e.normal) >= normalCosine;
}

Taps tapsOf(const Guide& now, const Guide& before, const ReprojectionParameters& p, int x, int y) {
  Taps taps;
  const std::uint32_t id = now.id(x, y);
  const vec2 position = vec2(x, y) + now.motion(x, y);
  const vec2 size(now.width(), now.height());
  if (id == core::kNoId || !(position.x > -1 && position.y > -1 && position.x < size.x && position.y < size.y))
    return taps;

  const float depth = now.depth(x, y);
  const float change = now.depthChange.empty() ? 0.0f : now.depthChange(x, y);
  const Expected expected{id, now.normal.load(x, y), depth + change,
                          p.depthTolerance * now.depthSlope(x, y) + p.relativeDepthTolerance * depth};
  const vec2 corner = glm::floor(position), f = position - corner;
  const float b[4] = {(1 - f.x) * (1 - f.y), f.x * (1 - f.y), (1 - f.x) * f.y, f.x * f.y};
  float sum = 0, outside = 0;
  for (int k = 0; k < 4; ++k) {
    const ivec2 q = ivec2(corner) + ivec2(k & 1, k >> 1);
    const bool isInside = before.depth.contains(q.x, q.y);
    if (!isInside) outside += b[k];
    if (!isInside || !(b[k] > 0) || !isSameSurface(before, q, expected, p.normalCosine)) continue;
    taps.pixel[k] = q.y * now.width() + q.x;
    sum += taps.b[k] = b[k];
  }
  if (sum < p.leastWeight) return {};
  for (float& w : taps.b) w /= sum;
  if (p.edgeReach > 0) taps.carried = std::max(0.0f, 1 - outside / p.edgeReach);  // [ledger edge]
  return taps;
}

}  // namespace

void reproject(const Guide& now, const Guide& before, const ReprojectionParameters& parameters,
               core::ImageView<Taps> out) {
  core::forEachPixel(out.width, out.height, [&](int x, int y) { out(x, y) = tapsOf(now, before, parameters, x, y); });
}

}  // namespace twohistory
