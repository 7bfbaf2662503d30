// Environment maps that tests make: with independent texels, of a sky, as Radiance HDR bytes.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/environment.h"
#include "core/random.h"

namespace tests {

inline std::shared_ptr<const core::Environment> environmentFrom(const core::Planes& image) {
  return std::make_shared<const core::Environment>(image.view(), "test map");
}

/// Independent coloured texels, from `darkest` to 1 over equal shares of the logarithm.
inline core::Planes noiseMap(int width, int height, float darkest, std::uint64_t seed = 1) {
  core::Planes map(width, height);
  core::Rng rng(seed, core::Pass::lab, 0, 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float brightness = std::pow(darkest, rng.uniform());
      map.view().store(x, y, brightness * (0.5f * core::vec3(1) + 0.5f * rng.uniform3()));
    }
  return map;
}

/// The map seen by a viewer who turned by some texels.
inline core::Planes turnedMap(const core::Planes& map, int texels) {
  core::Planes turned(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) turned.view().store((x + texels) % map.width(), y, map.view().load(x, y));
  return turned;
}

/// A blue sky, brown ground, and one texel of sun at (sunX, sunY) of the given radiance.
inline core::Planes skyMap(int width, int height, int sunX, int sunY, float sun) {
  core::Planes map(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float up = 1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(height);  // 1 zenith, -1 nadir
      const core::vec3 sky = core::lerp(core::vec3(0.9f, 0.95f, 1), core::vec3(0.2f, 0.4f, 0.9f), std::max(up, 0.0f));
      map.view().store(x, y, up > 0 ? sky : core::vec3(0.15f, 0.12f, 0.09f));
    }
  if (sun > 0) map.view().store(sunX, sunY, sun * core::vec3(1, 0.95f, 0.85f));
  return map;
}

enum class HdrCoding { flat, oldRuns, newRuns };

using Rgbe = std::array<std::uint8_t, 4>;

/// Random pixels with runs of equal ones; the mantissa's largest byte has its top bit, as writers of the format do it.
inline std::vector<Rgbe> rgbePixels(int count) {
  std::vector<Rgbe> pixels;
  core::Rng rng(7, core::Pass::lab, 0, 0);
  while (static_cast<int>(pixels.size()) < count) {
    Rgbe p;
    for (std::uint8_t& b : p) b = static_cast<std::uint8_t>(rng.below(256));
    p[rng.below(3)] |= 0x80;
    p[3] = static_cast<std::uint8_t>(120 + rng.below(20));
    if (rng.below(8) == 0) p = {0, 0, 0, 0};
    const std::uint32_t run = rng.below(3) == 0 ? 1 + rng.below(400) : 1;
    for (std::uint32_t i = 0; i < run && static_cast<int>(pixels.size()) < count; ++i) pixels.push_back(p);
  }
  return pixels;
}

inline core::vec3 radianceOf(const Rgbe& p) {
  return p[3] ? std::ldexp(1.0f, p[3] - 136) * core::vec3(p[0], p[1], p[2]) : core::vec3(0);
}

inline void appendOldRuns(const Rgbe* row, int width, std::string& out) {
  for (int i = 0; i < width;) {
    out.append(reinterpret_cast<const char*>(row[i].data()), 4);
    int run = 0;
    while (i + 1 + run < width && row[i + 1 + run] == row[i]) ++run;
    for (int rest = run; rest > 0; rest >>= 8) out += {1, 1, 1, static_cast<char>(rest & 0xff)};
    i += 1 + run;
  }
}

inline void appendNewRuns(const Rgbe* row, int width, std::string& out) {
  out += {2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 0xff)};
  for (int c = 0; c < 4; ++c)
    for (int i = 0; i < width;) {
      int run = 1;
      while (run < 127 && i + run < width && row[i + run][c] == row[i][c]) ++run;
      if (run > 2) {
        out += {static_cast<char>(128 + run), static_cast<char>(row[i][c])};
        i += run;
        continue;
      }
      const int count = std::min(5, width - i);  // literal bytes, equal or not
      out += static_cast<char>(count);
      for (int k = 0; k < count; ++k) out += static_cast<char>(row[i + k][c]);
      i += count;
    }
}

/// A whole file. size: the line that gives it, such as "-Y 4 +X 8"; variables: further lines of the header.
inline std::string hdrBytes(const std::vector<Rgbe>& pixels, int width, HdrCoding coding, const std::string& size,
                            const std::string& variables = "") {
  std::string out = "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n" + variables + "\n" + size + "\n";
  for (std::size_t start = 0; start < pixels.size(); start += static_cast<std::size_t>(width)) {
    const Rgbe* row = &pixels[start];
    if (coding == HdrCoding::flat) out.append(reinterpret_cast<const char*>(row), 4 * static_cast<std::size_t>(width));
    if (coding == HdrCoding::oldRuns) appendOldRuns(row, width, out);
    if (coding == HdrCoding::newRuns) appendNewRuns(row, width, out);
  }
  return out;
}

}  // namespace tests
