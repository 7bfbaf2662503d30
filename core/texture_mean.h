// Mean colour of a texture over a triangle, for the power of textured emitters.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/scene.h"

namespace core {

/// Averages of an sRGB texture over 2^k x 2^k texels, decoded to linear.
///
/// A mean is taken over the cells that a triangle's bounding box touches, a bilinear texel more on every side. So it
/// may be a little off, but it is 0 only where every point of the triangle is black: light sampling by power then never
/// misses a point that shines.
class TextureMean {
 public:
  /// texture: not empty; must outlive this.
  explicit TextureMean(const Texture& texture);
  /// uvs: the triangle's corners, wrapped as the texture says. RGB, linear, in [0, 1].
  vec3 over(const std::array<vec2, 3>& uvs) const;

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<vec3> cells;
  };
  /// Texels [first, last] along one axis.
  struct Range {
    int first, last;
  };
  vec3 cell(std::size_t level, int x, int y) const;
  static Range texelRange(float a, float b, float c, int size, Texture::Wrap wrap);

  const Texture& texture_;
  std::vector<Level> levels_;  // [0] is empty: it is the texture itself
};

}  // namespace core
