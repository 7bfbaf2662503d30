#include "experiments/picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/png.h"
#include "experiments/ssim.h"

namespace experiments {

namespace {

std::uint8_t byteOf(double x) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(x, 0.0, 1.0))); }

void store(Picture& picture, int x, int y, const core::vec3& colour) {
  for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = byteOf(colour[c]);
}

/// Mixes a colour into a pixel; share in [0, 1].
void mix(Picture& picture, int x, int y, const core::vec3& colour, float share) {
  std::uint8_t* const p = picture.at(x, y);
  for (int c = 0; c < 3; ++c) p[c] = byteOf(std::lerp(p[c] / 255.0, double{colour[c]}, double{share}));
}

/// Share of a pixel that a line of a given half width covers, by its distance from the line's middle.
float coverage(float distance, float halfWidth) { return std::clamp(halfWidth + 0.5f - distance, 0.0f, 1.0f); }

constexpr core::vec3 kNotFinite{1, 0, 1}, kNothing{0.35f, 0.35f, 0.35f};

}  // namespace

Picture toneMappedPicture(const Colour& image, float stops) {
  Picture picture(image.width(), image.height());
  const float exposure = std::exp2(stops);
  core::forEachPixel(picture.width, picture.height, [&](int x, int y) {
    const core::vec3 colour = image.load(x, y);
    if (!core::isFinite(colour)) return store(picture, x, y, kNotFinite);
    for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = byteOf(toneMapped(double{exposure} * colour[c]));
  });
  return picture;
}

core::vec3 mapColour(double t) {
  // Chosen for this project: relative luminance rises from anchor to anchor.
  static constexpr std::array<core::vec3, 6> kAnchors{core::vec3{.03f, .03f, .09f}, {.16f, .12f, .42f},
                                                      {.50f, .12f, .46f},           {.83f, .25f, .27f},
                                                      {.97f, .58f, .13f},           {.99f, .97f, .70f}};
  const double at = std::clamp(t, 0.0, 1.0) * (kAnchors.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kAnchors.size() - 2);
  return core::lerp(kAnchors[i], kAnchors[i + 1], static_cast<float>(at - static_cast<double>(i)));
}

Picture errorPicture(const Comparison& comparison, const ErrorScale& scale) {
  CHECK(scale.low > 0 && scale.low < scale.high);
  Picture picture(comparison.width(), comparison.height());
  const double span = std::log(scale.high / scale.low);
  core::forEachPixel(picture.width, picture.height, [&](int x, int y) {
    const double error = std::max(std::abs(comparison.relativeError(x, y)), scale.low);
    store(picture, x, y, mapColour(std::log(error / scale.low) / span));
  });
  return picture;
}

Picture scalarPicture(core::In<float> values, const ErrorScale& scale) {
  CHECK(scale.low > 0 && scale.low < scale.high);
  Picture picture(values.width, values.height);
  const double span = std::log(scale.high / scale.low);
  core::forEachPixel(picture.width, picture.height, [&](int x, int y) {
    const double value = values(x, y);
    const bool shown = std::isfinite(value) && value > 0;
    store(picture, x, y, shown ? mapColour(std::log(std::max(value, scale.low) / scale.low) / span) : kNothing);
  });
  return picture;
}

void drawCircle(Picture& picture, core::vec2 centre, float radius, core::vec3 colour) {
  if (!(radius >= 0) || !std::isfinite(centre.x) || !std::isfinite(centre.y)) return;
  const float line = std::max(0.75f, 0.0015f * static_cast<float>(picture.height));  // half width in pixels
  core::forEachPixel(picture.width, picture.height, [&](int x, int y) {
    const core::vec2 offset = core::vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) - centre;
    const float distance = std::abs(std::hypot(offset.x, offset.y) - radius);
    if (distance > line + 2) return;
    mix(picture, x, y, core::vec3(0), 0.6f * coverage(distance, line + 1));
    mix(picture, x, y, colour, coverage(distance, line));
  });
}

std::string pngBytes(const Picture& picture) {
  return core::pngBytes({picture.width, picture.height, 3, picture.bytes});
}

}  // namespace experiments
