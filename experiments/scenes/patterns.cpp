#include "experiments/scenes/patterns.h"

#include "core/random.h"

namespace experiments {

using core::Texture;
using core::Track;
using core::vec3;
using core::vec4;

namespace {

/// Linear to sRGB. [IEC 61966-2-1]
std::uint8_t encode(float v, bool linear) {
  v = std::clamp(v, 0.0f, 1.0f);
  if (!linear) v = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(v * 255 + 0.5f);
}

/// Index of the stone or brick at (x, y) in rows that are shifted by half; -1 in the joint.
int brickAt(int x, int y, int width, int height, int size) {
  const int row = y / height, shifted = (x + (row % 2) * width / 2) % size;
  const bool joint = y % height == 0 || shifted % width == 0;
  return joint ? -1 : row * (size / width) + shifted / width;
}

vec3 toned(const vec3& color, int key, float amount) {
  return color * (1 - amount * hashed(static_cast<std::uint32_t>(key)));
}

/// Smooth noise that repeats every `cells` cells, in [0, 1].
float valueNoise(float x, float y, int cells) {
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const auto corner = [&](int dx, int dy) {
    return hashed(static_cast<std::uint32_t>((x0 + dx) % cells + cells * ((y0 + dy) % cells)), 7);
  };
  const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
  const float u = smooth(x - static_cast<float>(x0)), v = smooth(y - static_cast<float>(y0));
  return core::lerp(core::lerp(corner(0, 0), corner(1, 0), u), core::lerp(corner(0, 1), corner(1, 1), u), v);
}

}  // namespace

float hashed(std::uint32_t key, std::uint32_t stream) {
  const std::uint64_t keys = std::uint64_t{stream} << 32 | key;
  return static_cast<float>(core::mixBits(keys + 0x9E3779B97F4A7C15u) >> 40) * 0x1p-24f;  // SplitMix64
}

Texture paint(int size, const std::function<vec3(int, int)>& color, bool linear) {
  Texture texture{size, size, {}};
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const vec3 c = color(x, y);
      for (int i = 0; i < 3; ++i) texture.texels.push_back(encode(c[i], linear));
      texture.texels.push_back(255);
    }
  return texture;
}

Texture brickTexture() {
  return paint(64, [](int x, int y) {
    const int brick = brickAt(x, y, 16, 8, 64);
    return brick < 0 ? vec3(0.25f) : toned(vec3(0.45f, 0.2f, 0.13f), brick, 0.5f);
  });
}

Texture stripeTexture(const vec3& a, const vec3& b) {
  return paint(32, [&](int x, int) { return x % 16 < 8 ? a : b; });
}

Texture plankTexture() {
  return paint(64, [](int x, int y) {
    const int plank = brickAt(y, x, 64, 16, 64);
    const float grain = hashed(static_cast<std::uint32_t>(x + 64 * (y / 8)), 3);
    return plank < 0 ? vec3(0.08f, 0.05f, 0.03f) : toned(vec3(0.5f, 0.32f, 0.18f), plank, 0.4f) * (0.8f + 0.2f * grain);
  });
}

Texture pavingTexture() {
  return paint(64, [](int x, int y) {
    const int stone = brickAt(x, y, 32, 16, 64);
    return stone < 0 ? vec3(0.06f) : toned(vec3(0.34f, 0.33f, 0.36f), stone, 0.5f);
  });
}

Texture wetnessTexture() {
  constexpr int kSize = 64, kCells = 8;
  const auto roughness = [](int x, int y) {
    const float noise = valueNoise(x * float(kCells) / kSize, y * float(kCells) / kSize, kCells);
    return vec3(0, 0.15f + 0.15f * std::clamp(4 * noise - 1.5f, 0.0f, 1.0f), 0);
  };
  return paint(kSize, roughness, true);
}

Track sampled(float seconds, float keysPerSecond, const std::function<vec4(float)>& value,
              core::Interpolation interpolation) {
  Track track;
  track.interpolation = interpolation;
  const int keys = static_cast<int>(seconds * keysPerSecond);
  for (int k = 0; k <= keys; ++k) {
    track.times.push_back(static_cast<float>(k) / keysPerSecond);
    track.values.push_back(value(track.times.back()));
  }
  return track;
}

Track swing(float seconds, float degrees, float period, float phase, const vec3& axis) {
  return sampled(seconds, 10, [=](float time) {
    const float angle = glm::radians(degrees) * std::sin(2 * core::kPi * (time / period + phase));
    return vec4(std::sin(angle / 2) * axis, std::cos(angle / 2));
  });
}

Track glide(float seconds, const vec3& a, const vec3& b) {
  Track track;
  track.times = {0, seconds};
  track.values = {vec4(a, 0), vec4(b, 0)};
  return track;
}

}  // namespace experiments
