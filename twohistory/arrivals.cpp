#include "twohistory/arrivals.h"

#include <cmath>

#include "core/parallel.h"

namespace twohistory {
namespace {

using core::ivec2;
using core::vec2;

int nodesOf(int pixels) { return (pixels - 1 + ArrivalGrid::kSpacing - 1) / ArrivalGrid::kSpacing + 1; }

/// Between which nodes a position lies, in pixels along an axis of `pixels`.
struct Span {
  int first, second;
  float share;  ///< of the second

  Span(float position, int pixels) {
    constexpr int kSpacing = ArrivalGrid::kSpacing;
    const int last = nodesOf(pixels) - 1;
    first = std::clamp(static_cast<int>(position) / kSpacing, 0, std::max(0, last - 1));
    second = std::min(first + 1, last);
    const int from = first * kSpacing, length = std::min(second * kSpacing, pixels - 1) - from;
    share = length > 0 ? std::clamp((position - static_cast<float>(from)) / static_cast<float>(length), 0.0f, 1.0f) : 0;
  }
};

constexpr float kUnits = 256;  // a frame
constexpr auto kLongAgo = static_cast<std::uint16_t>(kUnits * Arrival::kLongAgo);

/// T along one axis in units. old: T at the source in frames, if that is inside.
std::uint16_t arrivalAlong(float source, float motion, int pixels, float old) {
  const bool isInside = source >= 0 && source <= static_cast<float>(pixels - 1);
  const float now = isInside ? old + 1 : std::abs(motion) < 1 ? 0.0f : Arrival::kLongAgo;  // [ledger arrival]
  return static_cast<std::uint16_t>(std::min(kUnits * now + 0.5f, static_cast<float>(kLongAgo)));
}

}  // namespace

ArrivalGrid::ArrivalGrid(int width, int height)
    : width_(width),
      height_(height),
      now_(nodesOf(width), nodesOf(height), Node{kLongAgo, kLongAgo}),
      before_(now_),
      isRecent_((width + kTile - 1) / kTile, (height + kTile - 1) / kTile, 0) {}

Arrival ArrivalGrid::between(vec2 position) const {
  const Span x(position.x, width_), y(position.y, height_);
  const Node a = now_(x.first, y.first), b = now_(x.second, y.first), c = now_(x.first, y.second),
             d = now_(x.second, y.second);
  const auto mix = [&](float v00, float v10, float v01, float v11) {
    return ((1 - y.share) * ((1 - x.share) * v00 + x.share * v10) + y.share * ((1 - x.share) * v01 + x.share * v11)) /
           kUnits;
  };
  return {mix(a.x, b.x, c.x, d.x), mix(a.y, b.y, c.y, d.y)};
}

/// At the edge itself taps say nothing of what lies beyond, so the pixel beside it is asked how far it moves.
ArrivalGrid::Node ArrivalGrid::next(core::In<Taps> taps, ivec2 node) const {
  const ivec2 last(width_ - 1, height_ - 1), pixel = glm::min(node * kSpacing, last);
  const ivec2 asked = glm::clamp(pixel, glm::min(ivec2(1), last), glm::max(last - 1, ivec2(0)));
  const Taps& t = taps(asked.x, asked.y);
  if (!t.valid()) return {kLongAgo, kLongAgo};
  const vec2 motion = meanPosition(t, width_) - vec2(asked), source = vec2(pixel) + motion;
  const Arrival old = between(source);
  return {arrivalAlong(source.x, motion.x, width_, old.x), arrivalAlong(source.y, motion.y, height_, old.y)};
}

void ArrivalGrid::update(core::In<Taps> taps) {
  CHECK_EQ(taps.width, width_);
  CHECK_EQ(taps.height, height_);
  core::forEachPixel(before_.width(), before_.height(), [&](int i, int j) { before_(i, j) = next(taps, ivec2(i, j)); });
  std::swap(now_, before_);
  const auto hasRecent = [&](int column, int row) {
    const int step = kTile / kSpacing, iLast = std::min((column + 1) * step, now_.width() - 1),
              jLast = std::min((row + 1) * step, now_.height() - 1);
    for (int j = row * step; j <= jLast; ++j)
      for (int i = column * step; i <= iLast; ++i)
        if (now_(i, j).x < kLongAgo || now_(i, j).y < kLongAgo) return true;
    return false;
  };
  core::forEachPixel(isRecent_.width(), isRecent_.height(), [&](int i, int j) { isRecent_(i, j) = hasRecent(i, j); });
}

}  // namespace twohistory
