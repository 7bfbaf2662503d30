// 8-bit pictures for people: tone-mapped frames, error maps, and the gaze drawn in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/metrics.h"

namespace experiments {

/// 8-bit sRGB pixels, 3 bytes each, row-major from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;

  Picture() = default;
  Picture(int w, int h) : width(w), height(h), bytes(3 * static_cast<std::size_t>(w) * h) {}
  std::uint8_t* at(int x, int y) { return &bytes[3 * (static_cast<std::size_t>(y) * width + x)]; }
  const std::uint8_t* at(int x, int y) const { return &bytes[3 * (static_cast<std::size_t>(y) * width + x)]; }
};

/// Exposure in stops, then SSIM's tone map. Pixels that are not finite are magenta.
Picture toneMappedPicture(const Colour& image, float stops = 0);

/// Values, 0 < low < high, that the ends of the colour map stand for; the scale is logarithmic. By default relative
/// squared errors.
struct ErrorScale {
  double low = 1e-4, high = 1;
};

/// Colour of t in [0, 1], clamped outside: dark blue over red to pale yellow, lightness rising throughout. sRGB in
/// [0, 1].
core::vec3 mapColour(double t);

/// Relative squared error of every pixel on a logarithmic colour scale.
Picture errorPicture(const Comparison& comparison, const ErrorScale& scale);

/// Positive values on the same logarithmic colours; grey where a value is 0, negative or not finite.
Picture scalarPicture(core::In<float> values, const ErrorScale& scale);

/// Draws a circle with a dark rim, radius and centre in pixels; parts outside the picture are left out.
void drawCircle(Picture& picture, core::vec2 centre, float radius, core::vec3 colour = core::vec3(1));

/// The picture as a PNG file's bytes.
std::string pngBytes(const Picture& picture);

}  // namespace experiments
