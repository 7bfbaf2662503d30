// What the camera sees in every pixel: surfaces, the guides that reprojection and filters use, and direct emission.
#pragma once

#include <vector>

#include "core/guide.h"
#include "core/parallel.h"
#include "core/scene.h"
#include "core/surface.h"
#include "core/tracer.h"

namespace core {

/// One frame's G-buffer; all images have one size.
struct GBuffer {
  GBuffer() = default;
  GBuffer(int width, int height) : surfaces(width, height), guide(width, height), emission(width, height) {}
  Image<Surface> surfaces;
  GuideImages guide;
  Planes emission;  ///< radiance towards the camera of the surface itself, or of the environment; never filtered
};

/// Where an instance is now and was one frame before.
struct InstanceState {
  mat4 toWorld{1}, toWorldBefore{1};
  glm::mat3 normalToWorld{1};  ///< inverse transpose: keeps the object's front side in front under mirroring
  bool moved = false;
};
std::vector<InstanceState> instanceStates(const Scene& scene, const Pose& now, const Pose& before);

/// What kernels are compiled for, so that a scene pays only for what it has.
struct SurfaceFeatures {
  bool textured = true, moving = true;
};
SurfaceFeatures featuresOf(const Scene& scene, const SceneMotion& motion);

/// Traces primary rays through pixel centres, in packets on a grid of its own: output does not depend on the tile.
/// now, before: poses of this frame and the previous one (equal in the first frame).
void traceGBuffer(const Scene& scene, const Pose& now, const Pose& before, const Tracer& tracer,
                  const SurfaceFeatures& features, GBuffer& out, int tile = kDefaultTile);

}  // namespace core
