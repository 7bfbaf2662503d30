#include "twohistory/tile_motion.h"

namespace twohistory {
namespace {

constexpr int kStride = 4;  // pixels between those that are looked at

/// Steps along one axis of a tile's pixels.
struct Axis {
  float sum = 0, squares = 0, moved = 0;

  void add(float step, float pixels) { sum += step, squares += step * step, moved += pixels; }
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
      const core::vec2 moved = meanPosition(t, taps.width) - core::vec2(x, y);
      column.add(pairs.alongRow(), moved.x), row.add(pairs.alongColumn(), moved.y);
      count += 1;
    }
  if (!(count > 0)) return {};
  const core::vec2 middle = 0.5f * core::vec2(first + end - 1), moved(column.moved, row.moved);
  const core::vec2 last(taps.width - 1, taps.height - 1);
  return {false, {column.mean(), row.mean()}, glm::clamp(middle + moved / count, core::vec2(0), last)};
}

}  // namespace twohistory
