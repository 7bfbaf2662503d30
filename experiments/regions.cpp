#include "experiments/regions.h"

#include <cmath>

#include "core/parallel.h"

namespace experiments {

namespace {

constexpr std::uint8_t kNever = 255;

/// Pixel that holds image position p, if it is finite and inside.
bool pixelAt(core::vec2 p, int width, int height, core::ivec2& pixel) {
  if (!(p.x >= 0 && p.y >= 0 && p.x < static_cast<float>(width) && p.y < static_cast<float>(height))) return false;
  pixel = {static_cast<int>(p.x), static_cast<int>(p.y)};
  return true;
}

}  // namespace

std::string_view regionName(Region region) {
  constexpr std::array<std::string_view, 4> names{"full", "fovea", "periphery", "recently_foveal"};
  return names[static_cast<std::size_t>(region)];
}

std::string_view regionMeaning(Region region) {
  constexpr std::array<std::string_view, 4> meanings{
      "every pixel of the frame", "pixels that have the foveal sample count in this frame",
      "pixels outside the fovea in this frame",
      "pixels outside the fovea now whose surface was inside it within the last 30 frames (followed by its motion)"};
  return meanings[static_cast<std::size_t>(region)];
}

FovealMemory::FovealMemory(int width, int height)
    : since_(width, height, kNever),
      before_(width, height, kNever),
      idBefore_(width, height, core::kNoId),
      fovea_(width, height),
      periphery_(width, height),
      recent_(width, height) {}

std::uint8_t FovealMemory::carried(const core::Guide& now, int x, int y) const {
  core::ivec2 from;
  const core::vec2 centre(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  if (!pixelAt(centre + now.motion(x, y), now.width(), now.height(), from)) return kNever;
  if (idBefore_(from.x, from.y) != now.id(x, y)) return kNever;
  const std::uint8_t since = before_(from.x, from.y);
  return since == kNever ? kNever : static_cast<std::uint8_t>(since + 1);
}

void FovealMemory::advance(const core::Guide& now, core::In<std::uint8_t> inside) {
  const int width = since_.width(), height = since_.height();
  CHECK(now.width() == width && now.height() == height && inside.width == width && inside.height == height);
  std::swap(since_, before_);
  core::forEachPixel(width, height, [&](int x, int y) {
    const std::uint8_t since = inside(x, y) ? std::uint8_t{0} : carried(now, x, y);
    since_(x, y) = since;
    fovea_(x, y) = since == 0;
    periphery_(x, y) = since != 0;
    recent_(x, y) = since != 0 && since <= kRecentFrames;
  });
  core::forEachPixel(width, height, [&](int x, int y) { idBefore_(x, y) = now.id(x, y); });
}

core::In<std::uint8_t> FovealMemory::mask(Region region) const {
  switch (region) {
    case Region::fovea:
      return fovea_;
    case Region::periphery:
      return periphery_;
    case Region::recentlyFoveal:
      return recent_;
    case Region::full:
      break;
  }
  return {};
}

}  // namespace experiments
