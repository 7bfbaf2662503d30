#include "twohistory/steps.h"

#include <cmath>

#include "core/parallel.h"
#include "twohistory/tile_place.h"

namespace twohistory {
namespace {

constexpr float kKept = 0.75f;  // a frame; docs/decisions.md "Steps are remembered for four frames"
constexpr int kStride = 4;      // pixels between those that are looked at

/// Steps along one axis of a tile's pixels.
struct Axis {
  float sum = 0, squares = 0, moved = 0;

  void add(float step, int pixels) { sum += step, squares += step * step, moved += static_cast<float>(pixels); }
  /// Mean, each weighted by itself.
  float mean() const { return sum > 0 ? squares / sum : 0.0f; }
};

}  // namespace

StepTiles::StepTiles(int width, int height)
    : width_(width),
      height_(height),
      now_((width + kSide - 1) / kSide, (height + kSide - 1) / kSide, Tile{}),
      before_(now_) {}

StepTiles::Tile StepTiles::mixedAt(int x, int y) const {
  const TilePlace p(x, y, kSide, now_.width(), now_.height());
  const Tile &a = now_(p.i0, p.j0), &b = now_(p.i1, p.j0), &c = now_(p.i0, p.j1), &d = now_(p.i1, p.j1);
  return {{p.mix(a.sum.x, b.sum.x, c.sum.x, d.sum.x), p.mix(a.sum.y, b.sum.y, c.sum.y, d.sum.y)},
          p.mix(a.weight, b.weight, c.weight, d.weight)};
}

WalkSteps<float> StepTiles::at(std::int32_t pixel) const {
  const Tile tile = mixedAt(pixel % width_, pixel / width_);
  if (!(tile.weight > 0)) return {0, 0};
  const float one = 1 / tile.weight;
  return {one * tile.sum.x, one * tile.sum.y};
}

StepTiles::Tile StepTiles::next(core::In<Taps> taps, int x0, int y0, int x1, int y1) const {
  Axis column, row;
  float count = 0;
  for (int y = y0; y < y1; y += kStride)
    for (int x = x0; x < x1; x += kStride) {
      const Taps& t = taps(x, y);
      if (!t.valid()) continue;
      const TapPairs pairs = pairsOf(t, width_);
      const std::int32_t from = t.pixel[strongest(t)];
      column.add(pairs.alongRow(), from % width_ - x), row.add(pairs.alongColumn(), from / width_ - y);
      count += 1;
    }
  if (!(count > 0)) return {};
  const auto cameFrom = [&](int middle, float moved, int size) {
    return std::clamp(middle + static_cast<int>(std::lround(moved / count)), 0, size - 1);
  };
  const Tile old = mixedAt(cameFrom((x0 + x1) / 2, column.moved, width_), cameFrom((y0 + y1) / 2, row.moved, height_));
  return {{kKept * old.sum.x + column.mean(), kKept * old.sum.y + row.mean()},
          kKept * old.weight + 1};  // [ledger step]
}

void StepTiles::update(core::In<Taps> taps) {
  CHECK_EQ(taps.width, width_);
  CHECK_EQ(taps.height, height_);
  core::forEachTile(
      width_, height_,
      [&](int x0, int y0, int x1, int y1) { before_(x0 / kSide, y0 / kSide) = next(taps, x0, y0, x1, y1); }, kSide);
  std::swap(now_, before_);
}

}  // namespace twohistory
