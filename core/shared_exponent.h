// A colour, or a difference of two, in four bytes: one exponent and three signed mantissas of eight bits.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/image.h"

namespace core {

/// Every channel's rounding error is at most 2^-7 of the largest channel's magnitude; what lies below 2^-126 becomes 0.
/// Infinite channels become the largest finite number that fits. One NaN makes all channels NaN.
class SharedExponent {
 public:
  SharedExponent() = default;
  explicit SharedExponent(float x) : SharedExponent(vec3(x)) {}
  SharedExponent(const vec3& v) {
    const float sum = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
    if (sum != sum) {
      exponent_ = kNaN;  // 0 times infinity
      return;
    }
    const float most =
        std::min(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}), std::numeric_limits<float>::max());
    const auto exponent = static_cast<int>(std::bit_cast<std::uint32_t>(most) >> 23) - kMantissaBits + 1;
    if (exponent < 1) return;
    exponent_ = static_cast<std::uint8_t>(exponent);
    const float inverse = powerOfTwo(2 * kBias - exponent);
    for (int c = 0; c < 3; ++c) mantissa_[c] = rounded(v[c] * inverse);
  }
  [[gnu::always_inline]] operator vec3() const {
    const float step = exponent_ > 0 ? powerOfTwo(exponent_) : 0.0f;
    return step * vec3(mantissa_[0], mantissa_[1], mantissa_[2]);
  }

 private:
  static constexpr int kMantissaBits = 7, kBias = 127;
  static constexpr std::uint8_t kNaN = 255;

  /// 2^(biased - 127) for biased in [1, 254]; 255 gives infinity.
  static float powerOfTwo(int biased) { return std::bit_cast<float>(static_cast<std::uint32_t>(biased) << 23); }
  static std::int8_t rounded(float x) {
    return static_cast<std::int8_t>(std::clamp(x, -127.0f, 127.0f) + std::copysign(0.5f, x));
  }

  std::uint8_t exponent_ = 0;
  std::int8_t mantissa_[3]{};
};

template <>
inline constexpr int kChannels<SharedExponent> = 3;

}  // namespace core
