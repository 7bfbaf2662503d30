// All that reprojection and filters see of a frame's geometry. A G-buffer fills one; so do a laboratory without a
// renderer and frames that another renderer wrote.
#pragma once

#include "core/image.h"

namespace core {

inline constexpr std::uint32_t kNoId = 0xffffffffu;  ///< id of a pixel without surface

/// Geometry guides of one frame, all of one size. x right, y down, pixel centres at +0.5.
struct Guide {
  In<float> depth;                 ///< distance along the view axis in scene units; infinity where nothing was hit
  In<float> depthSlope;            ///< |d depth / dx| + |d depth / dy| per pixel, of the surface's tangent plane
  PlanesView<const float> normal;  ///< unit shading normal, 0 where nothing was hit
  In<std::uint32_t> id;            ///< instance id, kNoId where nothing was hit
  In<vec2> motion;                 ///< previous - current position in pixels
  In<float> depthChange;  ///< depth of the same surface point in the previous frame - depth now; may be empty (0)

  int width() const { return depth.width; }
  int height() const { return depth.height; }
};

/// Owner of a guide.
class GuideImages {
 public:
  GuideImages() = default;
  GuideImages(int width, int height)
      : depth(width, height, kInfinity),
        depthSlope(width, height),
        depthChange(width, height),
        normal(width, height),
        id(width, height, kNoId),
        motion(width, height) {}
  Guide view() const { return {depth, depthSlope, normal, id, motion, depthChange}; }

  Image<float> depth, depthSlope, depthChange;
  Planes normal;
  Image<std::uint32_t> id;
  Image<vec2> motion;
};

}  // namespace core
