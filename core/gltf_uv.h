// Texture coordinates moved, turned and scaled. Baked into the mesh, so one transform a material.
// Source: KHR_texture_transform, with its rotation as its text says: counter-clockwise as seen, v pointing down.
#pragma once

#include "core/maths.h"

namespace core {

struct UvTransform {
  vec2 offset{0}, scale{1};
  float rotation = 0;  ///< radians

  vec2 apply(const vec2& uv) const {
    const vec2 s = scale * uv;
    const float c = std::cos(rotation), d = std::sin(rotation);
    return offset + vec2(c * s.x + d * s.y, c * s.y - d * s.x);
  }
  bool isIdentity() const { return *this == UvTransform{}; }
  friend bool operator==(const UvTransform& a, const UvTransform& b) {
    return a.offset == b.offset && a.scale == b.scale && a.rotation == b.rotation;
  }
};

}  // namespace core
