#include "core/foveation.h"

#include "core/exr.h"
#include "core/parallel.h"
#include "core/random.h"

namespace core {
namespace {

/// 0 below 0, 1 above 1, a cubic without kinks between.
float smoothStep(float t) {
  const float u = std::clamp(t, 0.0f, 1.0f);
  return u * u * (3 - 2 * u);
}

Image<float> readMap(const std::string& path, float scale) {
  ExrImage file = readExr(path);
  if (file.channels.size() != 1)
    throw Error(path, std::to_string(file.channels.size()) + " channels in a map of sample counts",
                "write one channel");
  Image<float> map = std::move(file.channels.begin()->second);
  for (std::size_t i = 0; i < map.size(); ++i) {
    float& count = map.data()[i];
    count *= scale;
    if (!(count >= 0 && count <= kMaxSamples)) {
      const std::string pixel = std::to_string(i % map.width()) + ", " + std::to_string(i / map.width());
      throw Error(path, "count " + std::to_string(count) + " at pixel " + pixel, "use counts from 0 to 4096");
    }
  }
  return map;
}

/// A whole number near count; stochastic rounding adds a uniform number so that the mean is kept.
float roundCount(float count, Rounding rounding, std::uint64_t seed, std::uint32_t pixel, std::uint32_t frame) {
  if (rounding == Rounding::nearest) return std::floor(count + 0.5f);
  const float whole = std::floor(count);
  return whole + (Rng(seed, Pass::foveation, pixel, frame).uniform() < count - whole ? 1.0f : 0.0f);
}

}  // namespace

Foveation::Foveation(const FoveationParameters& parameters) : parameters_(parameters) {
  if (parameters.kind == FoveationKind::map) map_ = readMap(parameters.file, parameters.scale);
}

float Foveation::mapped(int x, int y, int width, int height) const {
  const auto nearest = [](int i, int size, int mapSize) {
    return static_cast<int>((2 * static_cast<std::int64_t>(i) + 1) * mapSize / (2 * size));
  };
  return map_(nearest(x, width, map_.width()), nearest(y, height, map_.height()));
}

float Foveation::wanted(float distance, float height) const {
  const FoveationParameters& p = parameters_;
  if (p.kind == FoveationKind::uniform) return p.samples;
  const float beyond = distance - p.radius * height;
  if (beyond <= 0) return p.inside;
  if (p.kind == FoveationKind::circle || p.fallOff <= 0) return p.outside;
  return lerp(p.inside, p.outside, smoothStep(beyond / (p.fallOff * height)));
}

void Foveation::place(vec2 gaze, std::uint64_t seed, std::uint32_t frame, ImageView<float> counts,
                      ImageView<std::uint8_t> fovea) const {
  CHECK(counts.width == fovea.width && counts.height == fovea.height);
  const float height = static_cast<float>(counts.height), radius = parameters_.radius * height;
  const bool fromMap = parameters_.kind == FoveationKind::map;
  forEachPixel(counts.width, counts.height, [&](int x, int y) {
    const float distance = glm::distance(vec2(x, y) + 0.5f, gaze);
    const float target = fromMap ? mapped(x, y, counts.width, counts.height) : wanted(distance, height);
    const auto pixel = static_cast<std::uint32_t>(y * counts.width + x);
    counts(x, y) = roundCount(target, parameters_.rounding, seed, pixel, frame);
    fovea(x, y) = fromMap ? counts(x, y) >= parameters_.inside : distance <= radius;
  });
}

}  // namespace core
