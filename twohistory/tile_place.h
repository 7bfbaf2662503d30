// Where a pixel lies between the centres of tiles, to read values of tiles without steps at their edges.
#pragma once

#include <algorithm>

namespace twohistory {

struct TilePlace {
  int i0, i1, j0, j1;  ///< columns and rows of the four nearest tiles
  float a, b;          ///< share of the second column and row

  TilePlace(float x, float y, int tile, int columns, int rows) {
    a = along(x, tile, columns, i0, i1), b = along(y, tile, rows, j0, j1);
  }
  float mix(float v00, float v10, float v01, float v11) const {
    return (1 - b) * ((1 - a) * v00 + a * v10) + b * ((1 - a) * v01 + a * v11);
  }

 private:
  static float along(float i, int tile, int tiles, int& first, int& second) {
    const float t = std::clamp((i + 0.5f) / static_cast<float>(tile) - 0.5f, 0.0f, static_cast<float>(tiles - 1));
    first = static_cast<int>(t), second = std::min(first + 1, tiles - 1);
    return t - static_cast<float>(first);
  }
};

}  // namespace twohistory
