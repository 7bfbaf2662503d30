// What a frame's taps do to a tile of pixels: how far they step, and where they came from.
#pragma once

#include "core/image.h"
#include "twohistory/mixing.h"

namespace twohistory {

struct TileMotion {
  bool isNew = true;             ///< nothing of it was in the last frame; the rest then means nothing
  WalkSteps<float> steps{0, 0};  ///< s
  core::vec2 from{0};            ///< where its middle was, pixels
};

/// Pixels [first, end) of which every fourth of a row and column is looked at: what is thinner and moves over what
/// stands is missed. s = sum s_i^2 / sum s_i, so that what stands still does not slow down what moves before it.
TileMotion tileMotion(core::In<Taps> taps, core::ivec2 first, core::ivec2 end);

}  // namespace twohistory
