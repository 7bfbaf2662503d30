// How long ago each part of the image came in over its edge. Where it comes in slower than a pixel a frame the edge
// keeps what it remembers (reprojection.h), and what has passed it is more alike than a walk makes it (edge_noise.h).
//
//   [ledger arrival]  T <- 0 where the history lies beyond the edge by less than a pixel,  T + 1 at what came along
//
// along each axis, at every fourth pixel of a row and column, carried along with the image.
#pragma once

#include "core/image.h"
#include "twohistory/taps.h"

namespace twohistory {

/// Frames since a part of the image came in over the left or right (x) and the upper or lower edge (y); kLongAgo where
/// it never did, came in by whole pixels or more, or is new.
struct Arrival {
  static constexpr float kLongAgo = 128;
  float x = kLongAgo, y = kLongAgo;

  bool isLongAgo() const { return x >= kLongAgo && y >= kLongAgo; }
};

class ArrivalGrid {
 public:
  static constexpr int kSpacing = 4;  ///< pixels; the last node of a row or column is the image's last pixel
  static constexpr int kTile = 16;    ///< pixels, for which it is known whether any of it came in lately

  ArrivalGrid() = default;
  ArrivalGrid(int width, int height);

  /// Of the last frame's image at the mean position of `taps`, at least one with b > 0. near: a pixel beside it.
  Arrival at(const Taps& taps, core::ivec2 near) const {
    return isRecent_(near.x / kTile, near.y / kTile) ? between(meanPosition(taps, width_)) : Arrival{};
  }
  /// Adds a frame. taps: width x height, without padding.
  void update(core::In<Taps> taps);

  std::size_t bytes() const { return now_.bytes() + before_.bytes() + isRecent_.bytes(); }

 private:
  /// T of both axes in 1/256 frames.
  struct Node {
    std::uint16_t x, y;
  };
  Arrival between(core::vec2 position) const;
  Node next(core::In<Taps> taps, core::ivec2 node) const;

  int width_ = 0, height_ = 0;
  core::Image<Node> now_, before_;  ///< before_ is where the next frame is written
  core::Image<std::uint8_t> isRecent_;
};

}  // namespace twohistory
