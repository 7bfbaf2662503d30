// Light from infinitely far away: an image of all directions, drawn in proportion to its light.
//
// The image is a latitude-longitude map with y up. Its centre is +x and its left and right edges are -x, so u = 0.25 is
// -z and u = 0.75 is +z; row 0 is around +y. With theta from +y and phi from +x towards +z:
//   [env 1]  (u, v) = (1/2 + phi / (2 pi), theta / pi)
//   [env 2]  d omega = 2 pi^2 sin(theta) du dv
// By derivation that is also how three.js places such a map (not tried there). Texels are constant: no mixing between
// neighbours, so that the density below is exactly proportional to the luminance within a texel row.
// Sources: Pharr et al., "Physically Based Rendering" (2023), section 12.5; Walker 1977 (core/alias_table.h).
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/alias_table.h"
#include "core/image.h"

namespace core {

/// Immutable. Memory: 24 bytes a texel.
class Environment {
 public:
  /// image: linear RGB radiance, times scale. where: the name that errors give. Throws Error where the image is empty,
  /// or a value is not finite (scaled or not). Negative values, as lossy compression leaves them, count as 0. An image
  /// that is black everywhere is allowed: it gives no light.
  Environment(PlanesView<const float> image, const std::string& where, float scale = 1);

  int width() const { return texels_.width(); }
  int height() const { return texels_.height(); }
  /// True if no direction shines.
  bool black() const { return rows_.empty(); }
  /// Pixels of the image that had a negative value.
  std::int64_t negatives() const { return negatives_; }
  /// Mean over the sphere of directions; times 4 pi, what arrives at a point from everywhere.
  double meanLuminance() const { return meanLuminance_; }
  /// All texels, row by row.
  std::span<const vec3> texels() const { return {texels_.data(), texels_.size()}; }

  /// uv: in [0, 1)^2.
  vec3 radiance(vec2 uv) const { return texels_(texelOf(uv.x, width()), texelOf(uv.y, height())); }

  /// A point of the map in proportion to luminance x sin(theta); the map must not be black. bits: 32 uniform bits for u
  /// and for v, which choose a texel and the place in it; keepBits: as many again, for the alias tables.
  vec2 sample(std::array<std::uint32_t, 2> bits, std::array<std::uint32_t, 2> keepBits) const;
  /// Density of sample() over [0, 1)^2; 0 for a black map. Positive wherever the luminance is.
  float pdf(vec2 uv) const;

  /// Unit direction of a point of the map.
  static vec3 directionOf(vec2 uv);
  /// Point of the map of a direction (any length above 0); never on a pole itself, where d omega vanishes.
  static vec2 uvOf(const vec3& direction);
  /// d omega / d(u, v), sr: [env 2].
  static float solidAngle(vec2 uv);

 private:
  static int texelOf(float u, int size) { return std::min(static_cast<int>(u * static_cast<float>(size)), size - 1); }
  void fillTexels(PlanesView<const float> image, const std::string& where, float scale);
  void buildTables();

  Image<vec3> texels_;
  AliasTable rows_;
  std::vector<AliasTable> columns_;  // a row; empty where it is black
  double meanLuminance_ = 0;
  std::int64_t negatives_ = 0;
};

/// Reads an OpenEXR or Radiance HDR image, told apart by their first bytes; relative paths start at the working
/// directory. Throws Error where it is neither, broken (core/exr.h, core/hdr.h), or no environment (see there).
std::shared_ptr<const Environment> loadEnvironment(const std::filesystem::path& path, float scale = 1);

}  // namespace core
