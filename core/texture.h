// Bilinear look-ups in a scene's textures.
// Source: glTF 2.0 specification, section 3.8.4 (sRGB is decoded before texels are mixed); IEC 61966-2-1 (sRGB).
#pragma once

#include <array>

#include "core/scene.h"

namespace core {

/// Linear value of each 8-bit sRGB code.
inline const std::array<float, 256> kSrgbToLinear = [] {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double c = static_cast<double>(i) / 255;
    table[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return table;
}();

/// Coordinate u folded into [0, 1] by the wrap mode; 0 where u is not finite.
inline float wrapCoordinate(float u, Texture::Wrap wrap) {
  if (!std::isfinite(u)) return 0;
  switch (wrap) {
    case Texture::Wrap::repeat:
      return u - std::floor(u);
    case Texture::Wrap::mirror:
      return 1 - std::abs(u - 2 * std::floor(0.5f * u) - 1);
    case Texture::Wrap::clamp:
      break;
  }
  return std::clamp(u, 0.0f, 1.0f);
}

/// Index of the texel at i in [-1, size]: across the border comes the other side, or the border again.
inline int wrapTexel(int i, int size, Texture::Wrap wrap) {
  if (wrap == Texture::Wrap::repeat) return i < 0 ? size - 1 : i >= size ? 0 : i;
  return std::clamp(i, 0, size - 1);
}

/// Mixes the four texels around uv; decode turns a pointer to 4 bytes into a vec4. The texture must not be empty.
template <class Decode>
vec4 lookup(const Texture& texture, vec2 uv, Decode&& decode) {
  const float x = wrapCoordinate(uv.x, texture.wrapU) * static_cast<float>(texture.width) - 0.5f;
  const float y = wrapCoordinate(uv.y, texture.wrapV) * static_cast<float>(texture.height) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const auto texel = [&](int dx, int dy) {
    const std::size_t column = wrapTexel(x0 + dx, texture.width, texture.wrapU);
    const std::size_t row = wrapTexel(y0 + dy, texture.height, texture.wrapV);
    return decode(&texture.texels[4 * (row * texture.width + column)]);
  };
  return lerp(lerp(texel(0, 0), texel(1, 0), fx), lerp(texel(0, 1), texel(1, 1), fx), fy);
}

/// RGBA in [0, 1], texels taken as they are (roughness, normals).
inline vec4 lookup(const Texture& texture, vec2 uv) {
  return lookup(texture, uv, [](const std::uint8_t* t) { return vec4(t[0], t[1], t[2], t[3]) * (1.0f / 255); });
}
inline vec4 sampleLinear(const Texture& texture, vec2 uv) { return lookup(texture, uv); }

/// RGBA in [0, 1], colour decoded from sRGB to linear before texels are mixed; alpha as it is.
inline vec4 sampleSrgb(const Texture& texture, vec2 uv) {
  return lookup(texture, uv, [](const std::uint8_t* t) {
    return vec4(kSrgbToLinear[t[0]], kSrgbToLinear[t[1]], kSrgbToLinear[t[2]], static_cast<float>(t[3]) * (1.0f / 255));
  });
}

}  // namespace core
