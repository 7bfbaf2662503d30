// Drawing neighbours from a disk.
#include "restir/spatial.h"

namespace restir {

using core::Surface;
using core::vec2;
using core::vec3;

bool similar(const Surface& a, const Surface& b, const vec3& viewer, const SpatialParameters& p) {
  if (!b.hit() || dot(a.normal, b.normal) < p.normalCosine) return false;
  const vec3 between = b.position - a.position, view = viewer - a.position;
  const float height = dot(a.geometricNormal, between);
  return height * height <= p.planeDistance * p.planeDistance * dot(view, view);
}

Neighbours chooseNeighbours(const core::Moment& now, core::ivec2 pixel, const SpatialParameters& p, core::Rng& rng) {
  constexpr int kTries = 3;  // a wanted neighbour
  const core::In<Surface>& surfaces = now.surfaces;
  const Surface& here = surfaces(pixel.x, pixel.y);
  const float radius = std::max(p.radius * static_cast<float>(surfaces.height), 1.5f);
  Neighbours found;
  for (int i = 0; i < kTries * p.neighbours && found.count < p.neighbours; ++i) {
    const vec2 u = rng.uniform2();
    const float distance = radius * std::sqrt(u.x), angle = 2 * core::kPi * u.y;
    const int x = pixel.x + static_cast<int>(std::lround(distance * std::cos(angle)));
    const int y = pixel.y + static_cast<int>(std::lround(distance * std::sin(angle)));
    if (!surfaces.contains(x, y) || (x == pixel.x && y == pixel.y)) continue;
    if (!similar(here, surfaces(x, y), now.cameraPosition, p)) continue;
    found.pixel[found.count++] = y * surfaces.width + x;
  }
  return found;
}

}  // namespace restir
