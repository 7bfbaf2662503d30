// One instant of a scene as reuse sees it: camera, lights, geometry and the surfaces that the camera sees.
#pragma once

#include "core/lights.h"
#include "core/surface.h"
#include "core/tracer.h"

namespace core {

/// Views only; whoever renders keeps the owners of this frame and of the frames before alive.
struct Moment {
  std::uint32_t frame = 0;
  vec3 cameraPosition{0};
  const Lights* lights = nullptr;
  const Tracer* tracer = nullptr;
  In<Surface> surfaces;
  Guide guide;
};

}  // namespace core
