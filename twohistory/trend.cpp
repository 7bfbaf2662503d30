#include "twohistory/trend.h"

#include <cmath>

#include "twohistory/tile_place.h"

namespace twohistory {
namespace {

/// [blend trend] of up to nine tiles. noise2: variance of their weighted mean, from how they differ.
double shrunkRatio(const std::array<Trend::Sums, 9>& tiles, int count) {
  double change = 0, scale = 0, scale2 = 0, squared = 0;
  for (int i = 0; i < count; ++i) {
    if (!(tiles[i].scale > 0)) continue;
    change += tiles[i].change, scale += tiles[i].scale, scale2 += tiles[i].scale * tiles[i].scale;
    squared += tiles[i].change * tiles[i].change / tiles[i].scale;
  }
  if (!(scale > 0)) return 0;
  const double mean = change / scale, effective = scale * scale / scale2;  // [blend trend]
  if (!(effective > 1.5)) return 0;
  const double noise2 = std::max(0.0, squared / scale - mean * mean) / (effective - 1);
  return std::copysign(std::sqrt(std::max(0.0, mean * mean - noise2)), mean);
}

}  // namespace

void Trend::solve() {
  for (int y = 0; y < sums_.height(); ++y)
    for (int x = 0; x < sums_.width(); ++x)
      for (int k = 0; k < DriftRow::kMost; ++k) {
        std::array<Sums, 9> around;
        int count = 0;
        for (int v = std::max(0, y - 1); v <= std::min(y + 1, sums_.height() - 1); ++v)
          for (int u = std::max(0, x - 1); u <= std::min(x + 1, sums_.width() - 1); ++u)
            around[count++] = sums_(u, v)[k];
        value_(x, y)[k] = static_cast<float>(shrunkRatio(around, count));
      }
}

Trends Trend::at(int x, int y) const {
  const TilePlace p(x, y, kTile, value_.width(), value_.height());
  Trends t;
  for (int k = 0; k < DriftRow::kMost; ++k)
    t[k] = p.mix(value_(p.i0, p.j0)[k], value_(p.i1, p.j0)[k], value_(p.i0, p.j1)[k], value_(p.i1, p.j1)[k]);
  return t;
}

}  // namespace twohistory
