// The noise that a history would have whose pixels have a tile's mean counts and where the taps of past frames stepped
// as they did: what makes the noise of neighbours alike (mixing.h), without waiting for it to settle.
//
// Beside every tile of pixels lie two references, one that weighs frames equally and one by samples: the covariances
// R_ij of pixels i, j apart are walked on, frame by frame, for a ladder of death rates u, carried along with the image:
//
//   [ledger reference]  R <- D K_x K_y R, then R_00 + f,  D = 1 / (1 + u)
//                       K R_n = s/2 R_(n-1) + (1 - s) R_n + s/2 R_(n+1);  f: the tile's mean of w^2 / n, 1/n or n
//   [ledger along]      V = R_0 / S,  rho = R_1 / R_0
//
// R reaches as far as kReach pixels; beyond, its logarithm goes on as a parabola. The second, for the image's edge
// (edge_noise.h), is of a walk along one axis alone; S is the noise of what never steps.
#pragma once

#include "core/image.h"
#include "twohistory/reference_walk.h"
#include "twohistory/sample_counts.h"
#include "twohistory/tile_motion.h"

namespace twohistory {

class WalkTiles {
 public:
  static constexpr int kSide = 16;  ///< pixels
  static constexpr int kReach = 3;  ///< i, j < kReach

  WalkTiles() = default;
  WalkTiles(int width, int height);

  /// At a pixel (row-major index) of the last frame.
  ReferenceWalk at(std::int32_t pixel) const;

  /// Adds a frame, after everything of that frame has been gathered. taps: width x height, without padding; counts: of
  /// that frame.
  void update(core::In<Taps> taps, const SampleCounts& counts);

  std::size_t bytes() const { return now_.bytes() + before_.bytes() + noise_.bytes(); }

 private:
  using Lags = std::array<float, kReach * kReach>;  ///< R_ij at j kReach + i
  using Line = std::array<float, kReach>;           ///< of a walk in x or y alone
  /// Of one reference that dies at one rate.
  struct Reference {
    Lags lags{};
    Line alongRow{}, alongColumn{};
    float still = 0;               ///< S
    float weight = 0, ageSum = 0;  ///< as in a Ledger
  };
  /// Means over a tile's pixels.
  struct TileSamples {
    OfReferences<float> noise{}, weight{};  ///< f = w^2 / n, w
  };
  struct Tile {
    std::array<OfReferences<Reference>, kReferenceRates> references{};
    OfReferences<float> last{};  ///< f
    float frames = 0;            ///< how long the tile has been in the image
  };
  static TileSamples samplesOf(const SampleCounts& counts, int width, core::ivec2 first, core::ivec2 end);
  Tile mixedAt(core::vec2 position) const;
  Tile next(const TileMotion& motion, const TileSamples& samples) const;
  static void step(Reference& reference, const WalkSteps<float>& s, float kept, float noise, float weight);
  static ReferenceNoise noiseOf(const Reference& reference, float fresh);
  static TileNoise noiseOf(const Tile& tile);

  int width_ = 0, height_ = 0;
  core::Image<Tile> now_, before_;  ///< before_ is where the next frame is written
  core::Image<TileNoise> noise_;
};

}  // namespace twohistory
