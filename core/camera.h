// Pinhole camera at one instant.
#pragma once

#include "core/maths.h"

namespace core {

/// Looks along forward; the image plane is at distance 1. Pixels: x right, y down, centres at +0.5.
struct Camera {
  vec3 position{0};
  vec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  ///< orthonormal
  float tanHalfFovY = 0.5f;                             ///< tan(yfov / 2)
};

/// A camera seen through an image of a given size.
class Projection {
 public:
  Projection() = default;
  Projection(const Camera& camera, int width, int height);

  /// Unnormalised direction through image point p in pixels; its component along the view axis is 1.
  vec3 direction(vec2 p) const { return corner_ + p.x * stepX_ + p.y * stepY_; }
  /// Change of direction() for one pixel to the right, and down.
  const vec3& stepX() const { return stepX_; }
  const vec3& stepY() const { return stepY_; }
  /// Distance along the view axis; negative behind the camera.
  float depth(const vec3& world) const { return dot(world - camera_.position, camera_.forward); }
  /// Image position in pixels; meaningless where depth() <= 0.
  vec2 project(const vec3& world) const;
  const Camera& camera() const { return camera_; }

 private:
  Camera camera_;
  vec3 corner_{0}, stepX_{0}, stepY_{0};
  vec2 size_{1};
};

/// Camera from a node's transform (looks along -z, as in glTF).
Camera cameraFromMatrix(const mat4& toWorld, float yfov);

}  // namespace core
