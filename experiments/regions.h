// The regions of a frame that errors are reported for: where the fovea is, is not, and was a moment ago.
#pragma once

#include <array>
#include <string_view>

#include "core/guide.h"

namespace experiments {

enum class Region { full, fovea, periphery, recentlyFoveal };
inline constexpr std::array kRegions{Region::full, Region::fovea, Region::periphery, Region::recentlyFoveal};
inline constexpr int kRecentFrames = 30;  ///< "recently": inside within this many frames, one second

/// Name in results: full, fovea, periphery, recently_foveal.
std::string_view regionName(Region region);
/// What the region is, one sentence for reports.
std::string_view regionMeaning(Region region);

/// Remembers for every pixel how long ago its surface was inside the fovea, carried along with the frame's motion.
class FovealMemory {
 public:
  FovealMemory(int width, int height);

  /// Goes on to the next frame: nearest-tap reprojection by now.motion, kept where the instance id is the same.
  /// inside: nonzero where a pixel has the foveal sample count. Sizes must agree.
  void advance(const core::Guide& now, core::In<std::uint8_t> inside);

  /// Nonzero where a pixel belongs to the region; empty for Region::full. Valid until advance().
  core::In<std::uint8_t> mask(Region region) const;
  /// Frames since the pixel's surface was inside: 0 now, 255 = never or longer ago than that.
  core::In<std::uint8_t> framesSince() const { return since_; }

 private:
  std::uint8_t carried(const core::Guide& now, int x, int y) const;

  core::Image<std::uint8_t> since_, before_;
  core::Image<std::uint32_t> idBefore_;
  core::Image<std::uint8_t> fovea_, periphery_, recent_;
};

}  // namespace experiments
