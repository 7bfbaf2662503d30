// The last frame's sample counts, a byte a pixel: how much of what a pixel's taps remember was fresh (mixing.h).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/check.h"
#include "core/image.h"
#include "core/parallel.h"

namespace twohistory {

/// n >= 0 with 3 bits of mantissa, relative error at most 1/16; 0, powers of two and whole numbers up to 16 are exact.
/// Counts saturate at 2^-16 and 57344.
namespace count_code {

inline constexpr int kDropped = 20;             ///< bits of a float's mantissa
inline constexpr std::int32_t kBase = 887;      ///< top bits of the float below code 1, which is 2^-16
inline constexpr std::int32_t kMostCode = 255;  ///< 57344

inline std::uint8_t pack(float n) {
  if (!(n > 0)) return 0;
  const auto top = static_cast<std::int32_t>((std::bit_cast<std::uint32_t>(n) + (1u << (kDropped - 1))) >> kDropped);
  return static_cast<std::uint8_t>(std::clamp(top - kBase, 1, kMostCode));
}
inline float unpack(std::uint8_t code) {
  return code == 0 ? 0.0f : std::bit_cast<float>((static_cast<std::uint32_t>(code) + kBase) << kDropped);
}

}  // namespace count_code

class SampleCounts {
 public:
  SampleCounts() = default;
  SampleCounts(int width, int height) : codes_(width, height, std::uint8_t{0}) {}

  /// Of a pixel (row-major index) in the last frame; 0 before the first.
  float at(std::int32_t pixel) const { return count_code::unpack(codes_.data()[pixel]); }
  void update(core::In<float> counts) {
    CHECK_EQ(counts.width, codes_.width());
    CHECK_EQ(counts.height, codes_.height());
    core::forEachPixel(codes_.width(), codes_.height(),
                       [&](int x, int y) { codes_(x, y) = count_code::pack(counts(x, y)); });
  }
  std::size_t bytes() const { return codes_.bytes(); }

 private:
  core::Image<std::uint8_t> codes_;
};

}  // namespace twohistory
