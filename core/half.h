// A float of two bytes for storage, IEEE 754 binary16: 11 significant bits, up to 65504.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace core {

/// Relative rounding error at most 2^-11 from 2^-14 to 65504; below, an absolute one of 2^-25. Larger magnitudes,
/// infinite ones too, become 65504. NaN stays NaN.
class Half {
 public:
  static constexpr float kMost = 65504;

  Half() = default;
  Half(float x) {
    const float magnitude = std::min(std::abs(x), kMost);
    const auto u = std::bit_cast<std::uint32_t>(magnitude);
    const std::uint32_t normal = (u - (112u << 23) + 0xfffu + (u >> 13 & 1u)) >> 13;  // to nearest, ties to even
    const std::uint32_t tiny = std::bit_cast<std::uint32_t>(magnitude + 0.5f) - std::bit_cast<std::uint32_t>(0.5f);
    const std::uint32_t sign = std::bit_cast<std::uint32_t>(x) >> 16 & 0x8000u;
    bits_ = static_cast<std::uint16_t>(x != x ? kNaN : ((magnitude < 0x1p-14f ? tiny : normal) | sign));
  }
  [[gnu::always_inline]] operator float() const {
    const std::uint32_t magnitude = static_cast<std::uint32_t>(bits_ & 0x7fff) << 13;
    const std::uint32_t sign = static_cast<std::uint32_t>(bits_ & 0x8000) << 16;
    const float x = std::bit_cast<float>(magnitude) * 0x1p112f;
    return std::bit_cast<float>((bits_ == kNaN ? 0x7fc00000u : std::bit_cast<std::uint32_t>(x)) | sign);
  }

 private:
  static constexpr std::uint16_t kNaN = 0x7fff;
  std::uint16_t bits_ = 0;
};

}  // namespace core
