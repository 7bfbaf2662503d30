// One instant of a scene as reuse sees it: camera, lights, geometry and the surfaces that the camera sees.
#pragma once

#include <memory>

#include "core/lights.h"
#include "core/surface.h"
#include "core/tracer.h"

namespace core {

/// Images are views: whoever renders keeps their owners alive for this frame and the next. Lights and rays are shared,
/// because reservoirs that wait may need them for longer.
struct Moment {
  std::uint32_t frame = 0;
  vec3 cameraPosition{0};
  std::shared_ptr<const Lights> lights;
  std::shared_ptr<const Tracer> tracer;
  In<Surface> surfaces;
  Guide guide;
};

}  // namespace core
