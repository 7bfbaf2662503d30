// A pyramid of texture averages, and the cells that a triangle touches.
#include "core/texture_mean.h"

#include "core/texture.h"

namespace core {
namespace {

constexpr int kCellsPerAxis = 16;  // a mean reads at most about this many cells squared

}  // namespace

TextureMean::TextureMean(const Texture& texture) : texture_(texture) {
  levels_.push_back({texture.width, texture.height, {}});
  while (std::max(levels_.back().width, levels_.back().height) > kCellsPerAxis) {
    const std::size_t below = levels_.size() - 1;
    const int width = levels_[below].width, height = levels_[below].height;
    Level next{(width + 1) / 2, (height + 1) / 2, {}};
    next.cells.reserve(static_cast<std::size_t>(next.width) * next.height);
    for (int y = 0; y < height; y += 2)
      for (int x = 0; x < width; x += 2) {
        const int right = std::min(x + 1, width - 1), down = std::min(y + 1, height - 1);
        next.cells.push_back(
            0.25f * (cell(below, x, y) + cell(below, right, y) + cell(below, x, down) + cell(below, right, down)));
      }
    levels_.push_back(std::move(next));
  }
}

vec3 TextureMean::cell(std::size_t level, int x, int y) const {
  const std::size_t index = static_cast<std::size_t>(y) * levels_[level].width + x;
  if (level > 0) return levels_[level].cells[index];
  const std::uint8_t* t = &texture_.texels[4 * index];
  return {kSrgbToLinear[t[0]], kSrgbToLinear[t[1]], kSrgbToLinear[t[2]]};
}

/// All texels that bilinear look-ups between a, b and c may read; the whole axis where they cross its border.
TextureMean::Range TextureMean::texelRange(float a, float b, float c, int size, Texture::Wrap wrap) {
  float low = std::min({a, b, c}), high = std::max({a, b, c});
  if (wrap == Texture::Wrap::repeat) {
    const float whole = std::floor(low);
    low -= whole, high -= whole;
  }
  const float texels = static_cast<float>(size);
  const float first = std::floor(low * texels - 1), last = std::floor(high * texels + 1);
  const bool inside = first >= 0 && last < texels;
  if (!inside && wrap != Texture::Wrap::clamp) return {0, size - 1};
  const auto clamped = [&](float x) { return static_cast<int>(std::clamp(x, 0.0f, texels - 1)); };
  return std::isfinite(low + high) ? Range{clamped(first), clamped(last)} : Range{0, size - 1};
}

vec3 TextureMean::over(const std::array<vec2, 3>& uvs) const {
  Range x = texelRange(uvs[0].x, uvs[1].x, uvs[2].x, texture_.width, texture_.wrapU);
  Range y = texelRange(uvs[0].y, uvs[1].y, uvs[2].y, texture_.height, texture_.wrapV);
  std::size_t level = 0;
  while (std::max(x.last - x.first, y.last - y.first) >= kCellsPerAxis) {
    ++level;
    x = {x.first / 2, x.last / 2}, y = {y.first / 2, y.last / 2};
  }
  vec3 sum(0);
  for (int j = y.first; j <= y.last; ++j)
    for (int i = x.first; i <= x.last; ++i) sum += cell(level, i, j);
  return sum / static_cast<float>((x.last - x.first + 1) * (y.last - y.first + 1));
}

}  // namespace core
