// Where a pixel's history lies: up to four validated pixels of the previous frame.
#pragma once

#include <array>
#include <cstdint>

#include "core/maths.h"

namespace twohistory {

/// pixel: row-major indices into the previous frame. b: bilinear weights of the valid taps, renormalised to sum 1;
/// invalid taps have b = 0 and any valid index. All b = 0: no history (reset). carried: share of the history's weight
/// that comes along, in [0, 1]; below 1 where the image's edge forgets (reprojection.h).
struct Taps {
  std::array<std::int32_t, 4> pixel{};
  std::array<float, 4> b{};
  float carried = 1;

  bool valid() const { return b[0] + b[1] + b[2] + b[3] > 0; }
};

/// The one tap of a pixel that stays where it is.
inline Taps stillTap(std::int32_t pixel) { return {{pixel, pixel, pixel, pixel}, {1, 0, 0, 0}}; }

/// Index k of the tap with the largest b, the first of equals.
inline int strongest(const Taps& taps) {
  int best = 0;
  for (int k = 1; k < 4; ++k)
    if (taps.b[k] > taps.b[best]) best = k;
  return best;
}

/// Where the taps lie on average, in pixels of the previous frame, of that width. taps: valid.
inline core::vec2 meanPosition(const Taps& taps, int width) {
  core::vec2 position(0);
  for (int k = 0; k < 4; ++k) position += taps.b[k] * core::vec2(taps.pixel[k] % width, taps.pixel[k] / width);
  return position;
}

/// How values that cannot be mixed (reservoirs) choose one tap. Never looks at the values.
enum class Choice { best, stochastic };

/// One tap with b = 1. best: the largest b. stochastic: tap k with probability b_k, u uniform in [0, 1).
inline Taps chooseTap(const Taps& taps, Choice choice, float u) {
  if (!taps.valid()) return taps;
  int chosen = 0;
  if (choice == Choice::best) {
    chosen = strongest(taps);
  } else {
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
      if (taps.b[k] <= 0) continue;
      chosen = k;
      if (u < (sum += taps.b[k])) break;
    }
  }
  return stillTap(taps.pixel[chosen]);
}

}  // namespace twohistory
