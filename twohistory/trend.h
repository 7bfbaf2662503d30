// What histories' differences are over large areas: what a window's noisy mean is shrunk towards. A change of light
// that many surfaces share is then seen the same everywhere, however few samples a pixel has.
#pragma once

#include <array>
#include <cmath>

#include "core/image.h"
#include "twohistory/drift.h"
#include "twohistory/twins.h"

namespace twohistory {

using Trends = std::array<float, DriftRow::kMost>;  ///< T of each difference

/// [blend trend] T = (sum sign(gap) d) / (sum |gap| lum(X_0)) over a tile and its neighbours, d the difference of two
/// histories, gap that of their ages: the relative change a frame, if lags were linear in age. Shrunk by how much the
/// tiles disagree, max(0, T^2 - noise2): where only some of them change, none is told.
class Trend {
 public:
  static constexpr int kTile = TwinTiles::kSide;  ///< pixels on a side

  /// Sums of one tile and difference.
  struct Sums {
    double change = 0, scale = 0;  ///< sign(gap) d; |gap| lum(X_0)
    void add(float d, float gap, float brightness) {
      change += static_cast<double>(gap < 0 ? -d : d), scale += static_cast<double>(std::abs(gap) * brightness);
    }
  };
  using TileSums = std::array<Sums, DriftRow::kMost>;

  Trend(int width, int height)
      : sums_((width + kTile - 1) / kTile, (height + kTile - 1) / kTile), value_(sums_.width(), sums_.height()) {}
  TileSums& tile(int x, int y) { return sums_(x / kTile, y / kTile); }
  /// From the sums of all tiles.
  void solve();
  /// T of all differences at a pixel, between the tiles' centres; 0 before solve().
  Trends at(int x, int y) const;

 private:
  core::Image<TileSums> sums_;
  core::Image<Trends> value_;
};

}  // namespace twohistory
