// Shadow rays.
#pragma once

#include "core/lights.h"
#include "core/surface.h"
#include "core/tracer.h"

namespace restir {

/// True if nothing lies between a surface and the light point that `in` comes from.
inline bool visible(const core::Tracer& tracer, const core::Surface& surface, const core::Incident& in) {
  constexpr float kBeforeLight = 1 - 1e-4f;  // so that the light does not hide itself
  const core::vec3 origin = core::offsetOrigin(surface.position, surface.geometricNormal);
  if (!(in.distance < core::kInfinity)) return !tracer.occluded(origin, in.direction, core::kInfinity);
  const core::vec3 toLight = surface.position + in.distance * in.direction - origin;
  return !tracer.occluded(origin, toLight, kBeforeLight);
}

}  // namespace restir
