// Counter-based random numbers: Philox 4x32-10, keyed by (seed, pass) and counted by (pixel, frame, sample, block).
// Source: Salmon et al., "Parallel Random Numbers: As Easy as 1, 2, 3" (SC 2011). No state is shared between threads,
// so output never depends on the order in which pixels are visited.
#pragma once

#include <array>
#include <cstdint>

#include "core/maths.h"

namespace core {

/// One block of four random words for a key and a counter.
inline std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = 0xD2511F53ull * counter[0], b = 0xCD9E8D57ull * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u, key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// Mixes 64 bits into 64 well-spread ones (splitmix64's finaliser).
inline std::uint64_t mixBits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// Uniform in [0, 1) from 32 uniform bits; the upper 24 count.
inline float unitFloat(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

/// Passes draw from streams of their own; the number is part of the key.
enum class Pass : std::uint32_t {
  candidates = 1,
  temporal,
  spatial,
  shade,
  reference,
  lab,
  gather,
  other,
  foveation,
  lightTiles
};

/// A stream of random numbers for one (seed, pass, pixel, frame, sample).
class Rng {
 public:
  Rng(std::uint64_t seed, Pass pass, std::uint32_t pixel, std::uint32_t frame, std::uint32_t sample = 0) {
    const std::uint64_t key = mixBits(seed * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(pass));
    key_ = {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)};
    counter_ = {0, pixel, frame, sample};
  }

  std::uint32_t bits() {
    if (next_ == 4) {
      block_ = philox(counter_, key_);
      ++counter_[0];
      next_ = 0;
    }
    return block_[next_++];
  }
  /// Uniform in [0, 1), 24 bits.
  float uniform() { return unitFloat(bits()); }
  vec2 uniform2() {
    const float x = uniform();
    return {x, uniform()};
  }
  vec3 uniform3() {
    const vec2 xy = uniform2();
    return {xy, uniform()};
  }
  /// Uniform integer in [0, n), bias below n / 2^32.
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((std::uint64_t{bits()} * n) >> 32); }

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  unsigned next_ = 4;
};

}  // namespace core
