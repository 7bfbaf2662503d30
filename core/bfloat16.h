// A float of two bytes for storage: 8 bits of exponent, so any radiance fits, and 8 significant ones.
#pragma once

#include <bit>
#include <cstdint>

namespace core {

/// Relative rounding error at most 2^-8; nothing finite becomes infinite. NaN stays NaN.
class Bfloat16 {
 public:
  Bfloat16() = default;
  Bfloat16(float x) {
    const auto u = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t rounded = u + 0x7fffu + (u >> 16 & 1u);  // to nearest, ties to even
    const bool overflows = (rounded & 0x7f800000u) == 0x7f800000u;
    bits_ = static_cast<std::uint16_t>((overflows ? u : rounded) >> 16);
    if (x != x) bits_ |= 0x40;  // a NaN whose mantissa lay below would become infinite
  }
  [[gnu::always_inline]] operator float() const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits_) << 16);
  }

 private:
  std::uint16_t bits_ = 0;
};

}  // namespace core
