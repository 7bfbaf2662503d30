// Three-dimensional points that fill the cube evenly: an additive recurrence, shifted at random. Every single point is
// uniform, so means over them stay unbiased; errors of smooth integrands fall much faster than with random points.
// Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences" (2018), the sequence R_3; Cranley and
// Patterson, "Randomization of Number Theoretic Methods for Multiple Integration" (1976), for the shift.
#pragma once

#include "core/random.h"

namespace core {

class Lattice3 {
 public:
  /// The shift is drawn from rng.
  explicit Lattice3(Rng& rng) : shift_{rng.bits(), rng.bits(), rng.bits()} {}

  /// 32 bits of each coordinate of point i.
  std::array<std::uint32_t, 3> bits(std::uint32_t i) const {
    return {shift_[0] + i * kStep[0], shift_[1] + i * kStep[1], shift_[2] + i * kStep[2]};
  }
  /// The same in [0, 1).
  static float uniform(std::uint32_t bits) { return unitFloat(bits); }

 private:
  // 2^32 / g^k for k = 1, 2, 3 with g^4 = g + 1, so g = 1.2207440846057596.
  static constexpr std::array<std::uint32_t, 3> kStep{3518319155u, 2882110345u, 2360945575u};
  std::array<std::uint32_t, 3> shift_;
};

}  // namespace core
