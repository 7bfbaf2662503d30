// The noise that a history of uniform samples would have where the taps of past frames stepped as they did: what makes
// the noise of neighbours alike (mixing.h), without waiting for it to settle.
//
// Beside every tile of pixels lies a reference: the covariances R_ij of pixels i, j apart are walked on, frame by
// frame, for a ladder of death rates u, carried along with the image:
//
//   [ledger reference]  R <- D K_x K_y R, then R_00 + 1,  D = 1 / (1 + u)
//                       K R_n = s/2 R_(n-1) + (1 - s) R_n + s/2 R_(n+1)
//   [ledger older]      O = 1 - 1 / R_00,  q_ij = R_ij / (R_00 - 1)
//   [ledger along]      V = R_0 (1 - D) / (1 - D^N),  rho = R_1 / R_0
//   [ledger young]      u <- u + rate(A / W) - rate(a),  rate(x) = (1 + 1/x)^2 - 1
//
// The second: what is older than a frame, and how alike it is. R reaches as far as kReach pixels; beyond, it falls as
// between its last two. The third, for the image's edge (edge_noise.h), is of a walk along one axis alone, in a tile
// that has been seen for N frames. The fourth: a pixel that is younger than its tile, whose mean age is a, has a
// shorter walk.
#pragma once

#include "core/image.h"
#include "twohistory/edge_noise.h"
#include "twohistory/mixing.h"
#include "twohistory/tile_motion.h"

namespace twohistory {

/// u = 1, 1/4, 1/16, 1/64, 1/256: decays of .71, .89, .97, .992 and .998. Others lie between, or are the nearest.
inline constexpr int kReferenceRates = 5;

/// What a reference that dies at one rate knows of pixels that lie next to each other.
struct ReferenceNoise {
  float here = 0;                             ///< R_00
  float row = 0, column = 0, diagonal = 0;    ///< R_10, R_01, R_11
  float meanAge = 0;                          ///< in frames
  EdgeWalk<float> alongRow{}, alongColumn{};  ///< of a walk in x or y alone
};

/// References at a pixel, between the middles of four tiles. Points into WalkTiles until its next update.
class ReferenceWalk {
 public:
  using Rates = std::array<ReferenceNoise, kReferenceRates>;
  std::array<const Rates*, 4> tile;
  std::array<float, 4> part;  ///< of a tile, with sum 1

  /// As of SettledWalk (mixing.h).
  OlderNoise<float> older(const TapPairs& pairs, const Remembered<float>& history) const;
  EdgeNoise<float> edge(const TapPairs& pairs, const Arrival& arrival, const Remembered<float>& history,
                        float perNoise) const;

 private:
  template <class Add>
  void between(float place, const Add& add) const;
  /// Where a history's noise lies on the ladder, in [0, kReferenceRates - 1].
  float placeOf(const Remembered<float>& history) const;
};

class WalkTiles {
 public:
  static constexpr int kSide = 16;  ///< pixels
  static constexpr int kReach = 3;  ///< i, j < kReach

  WalkTiles() = default;
  WalkTiles(int width, int height);

  /// At a pixel (row-major index) of the last frame.
  ReferenceWalk at(std::int32_t pixel) const;

  /// Adds a frame, after everything of that frame has been gathered. taps: width x height, without padding.
  void update(core::In<Taps> taps);

  std::size_t bytes() const { return now_.bytes() + before_.bytes() + rates_.bytes(); }

 private:
  /// Of one death rate.
  struct Lags {
    std::array<float, kReach * kReach> r{};               ///< R_ij at j kReach + i
    std::array<float, kReach> alongRow{}, alongColumn{};  ///< of walks in x or y alone
  };
  struct Tile {
    std::array<Lags, kReferenceRates> lags{};
    float frames = 0;  ///< how long the tile has been in the image
  };
  Tile mixedAt(core::vec2 position) const;
  Tile next(const TileMotion& motion) const;
  static void step(Lags& lags, const WalkSteps<float>& s, float kept);
  static ReferenceNoise noiseOf(const Lags& lags, float frames, float death);

  int width_ = 0, height_ = 0;
  core::Image<Tile> now_, before_;  ///< before_ is where the next frame is written
  core::Image<ReferenceWalk::Rates> rates_;
};

}  // namespace twohistory
