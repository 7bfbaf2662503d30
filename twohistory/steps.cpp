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

TileMotion tileMotion(core::In<Taps> taps, core::ivec2 first, core::ivec2 end) {
  Axis column, row;
  float count = 0;
  for (int y = first.y; y < end.y; y += kStride)
    for (int x = first.x; x < end.x; x += kStride) {
      const Taps& t = taps(x, y);
      if (!t.valid()) continue;
      const TapPairs pairs = pairsOf(t, taps.width);
      const std::int32_t from = t.pixel[strongest(t)];
      column.add(pairs.alongRow(), from % taps.width - x), row.add(pairs.alongColumn(), from / taps.width - y);
      count += 1;
    }
  if (!(count > 0)) return {};
  const core::vec2 middle = 0.5f * core::vec2(first + end - 1), moved(column.moved, row.moved);
  const core::vec2 last(taps.width - 1, taps.height - 1);
  return {false, {column.mean(), row.mean()}, glm::clamp(middle + moved / count, core::vec2(0), last)};
}

StepTiles::StepTiles(int width, int height)
    : width_(width),
      height_(height),
      now_((width + kSide - 1) / kSide, (height + kSide - 1) / kSide, Tile{}),
      before_(now_) {}

StepTiles::Tile StepTiles::mixedAt(core::vec2 position) const {
  const TilePlace p(position.x, position.y, kSide, now_.width(), now_.height());
  const Tile &a = now_(p.i0, p.j0), &b = now_(p.i1, p.j0), &c = now_(p.i0, p.j1), &d = now_(p.i1, p.j1);
  return {{p.mix(a.sum.x, b.sum.x, c.sum.x, d.sum.x), p.mix(a.sum.y, b.sum.y, c.sum.y, d.sum.y)},
          p.mix(a.weight, b.weight, c.weight, d.weight)};
}

WalkSteps<float> StepTiles::at(std::int32_t pixel) const {
  const Tile tile = mixedAt({pixel % width_, pixel / width_});
  if (!(tile.weight > 0)) return {0, 0};
  const float one = 1 / tile.weight;
  return {one * tile.sum.x, one * tile.sum.y};
}

StepTiles::Tile StepTiles::next(const TileMotion& motion) const {
  if (motion.isNew) return {};
  const Tile old = mixedAt(motion.from);
  return {{kKept * old.sum.x + motion.steps.x, kKept * old.sum.y + motion.steps.y},
          kKept * old.weight + 1};  // [ledger step]
}

void StepTiles::update(core::In<Taps> taps) {
  CHECK_EQ(taps.width, width_);
  CHECK_EQ(taps.height, height_);
  core::forEachTile(
      width_, height_,
      [&](int x0, int y0, int x1, int y1) {
        before_(x0 / kSide, y0 / kSide) = next(tileMotion(taps, {x0, y0}, {x1, y1}));
      },
      kSide);
  std::swap(now_, before_);
}

}  // namespace twohistory
