// Presampled light tiles: light samples that many pixels take their candidates from, small enough to stay in the cache.
//
// A candidate drawn from a table of a million lights waits for memory three times: for its bin, its light and its
// texel. So once a frame some tiles are filled with light samples, drawn as ever, beside what a target needs of them,
// and each block of pixels takes its candidates from one tile, chosen at random every frame. A candidate keeps the
// density of Lights::sample(), and the expectation of [candidates 1] and of every merge is a sum over candidates, each
// by itself: that neighbours share some changes how their noise correlates, not the mean.
// Source: Wyman and Panteleev, "Rearchitecting Spatiotemporal Resampling for Production" (HPG 2021), section 5.
#pragma once

#include <span>
#include <vector>

#include "core/lights.h"
#include "core/moment.h"

namespace restir {

/// automatic: where the lights outgrow the cache.
enum class TileUse { automatic, always, never };

/// The tiles of one frame. Their content depends on seed, frame and lights alone, not on threads or render tiles.
class LightTiles {
 public:
  static constexpr int kTileSize = 512;  ///< samples; 32 KiB
  static constexpr int kBlock = 16;      ///< pixels on the side of a block that shares a tile
  /// Lights from which on `automatic` uses tiles: their table and records then take some MiB (docs/results.md).
  static constexpr std::uint32_t kManyLights = 1u << 15;

  /// Fills the frame's tiles, or none where the lights do not ask for it. candidates: light samples that the image's
  /// pixels draw with one batch each; a tile serves about 32 times its size.
  void fill(TileUse use, const core::Lights& lights, core::LightFeatures features, std::int64_t candidates,
            std::uint64_t seed, std::uint32_t frame);

  /// The tile of a pixel in the frame last filled; empty where candidates are drawn from the lights themselves.
  std::span<const core::PresampledLight> of(int x, int y) const;

 private:
  int count_ = 0;
  std::uint64_t seed_ = 0;
  std::uint32_t frame_ = 0;
  std::vector<core::PresampledLight> samples_;
};

}  // namespace restir
