// How far the taps of past frames stepped: what made the noise of neighbours alike (mixing.h).
//
// A pixel's noise was mixed by the steps of all frames that it remembers, of which this frame's is the next. The mean
// of past steps is itself a history, of one value a tile of pixels, carried along with the image:
//
//   [ledger step]  s_past <- (0.75 W s_past + s) / (0.75 W + 1),  W <- 0.75 W + 1,  s = sum s_i^2 / sum s_i over a tile
//
// s weights pixels by how much they move, so that what stands still does not slow down what moves before it.
#pragma once

#include "core/image.h"
#include "twohistory/mixing.h"

namespace twohistory {

/// What a frame's taps do to a tile of pixels.
struct TileMotion {
  bool isNew = true;             ///< nothing of it was in the last frame; the rest then means nothing
  WalkSteps<float> steps{0, 0};  ///< s
  core::vec2 from{0};            ///< where its middle was, pixels
};

/// Every fourth pixel of a row and column of [first, end) is looked at.
TileMotion tileMotion(core::In<Taps> taps, core::ivec2 first, core::ivec2 end);

/// Past steps of one image. Where nothing is known yet they are 0: taps of a first motion are independent. What is
/// thinner than tileMotion sees and moves over what stands seems to have just begun.
class StepTiles {
 public:
  static constexpr int kSide = 16;  ///< pixels

  StepTiles() = default;
  StepTiles(int width, int height);

  /// What the taps' noise has been through. taps: of the frame that comes, at least one with b > 0.
  WalkSteps<float> operator()(const Taps& taps, const TapPairs&) const { return at(taps.pixel[strongest(taps)]); }
  /// At a pixel (row-major index) of the last frame.
  WalkSteps<float> at(std::int32_t pixel) const;

  /// Adds a frame's steps, after everything of that frame has been gathered. taps: width x height, without padding.
  void update(core::In<Taps> taps);

  std::size_t bytes() const { return now_.bytes() + before_.bytes(); }

 private:
  struct Tile {
    WalkSteps<float> sum{0, 0};  ///< W s_past: sums are what mixes
    float weight = 0;            ///< W
  };
  Tile mixedAt(core::vec2 position) const;
  Tile next(const TileMotion& motion) const;

  int width_ = 0, height_ = 0;
  core::Image<Tile> now_, before_;  ///< before_ is where the next frame is written
};

}  // namespace twohistory
