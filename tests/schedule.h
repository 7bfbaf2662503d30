// Random schedules of sample counts, and what a history is by its definition: a sum over the whole sequence.
#pragma once

#include <vector>

#include "core/random.h"
#include "twohistory/ledger.h"

namespace tests {

/// Sample counts 0 .. most, zeros frequent, in runs as a moving fovea makes them.
inline std::vector<int> randomCounts(core::Rng& rng, int length, int most) {
  std::vector<int> counts;
  while (static_cast<int>(counts.size()) < length) {
    const int n = rng.uniform() < 0.2f ? 0 : static_cast<int>(rng.below(static_cast<std::uint32_t>(most) + 1));
    const int run = rng.uniform() < 0.5f ? 1 : 1 + static_cast<int>(rng.below(12));
    counts.insert(counts.end(), run, n);
  }
  counts.resize(length);
  return counts;
}

/// One of the decays that break things, or any in between.
inline double randomDecay(core::Rng& rng) {
  constexpr double kHard[] = {0, 0.5, 0.8, 0.95, 0.98, 0.999, 1};
  return rng.uniform() < 0.6f ? kHard[rng.below(std::size(kHard))] : static_cast<double>(rng.uniform());
}

/// x^k for whole k, 0^0 = 1.
inline long double power(long double x, int k) {
  long double result = 1;
  for (; k > 0; k >>= 1, x *= x)
    if (k & 1) result *= x;
  return result;
}

/// Weights, age sums and power sums of histories g and h by definition, over all frames at once.
struct BruteForce {
  long double weightG = 0, weightH = 0, ageSumG = 0, cross = 0;

  BruteForce(const std::vector<int>& counts, double decayG, twohistory::Weighting g, double decayH,
             twohistory::Weighting h) {
    const int last = static_cast<int>(counts.size()) - 1;
    for (int i = 0; i <= last; ++i) {
      const long double n = counts[i], age = last - i;
      const long double wg = power(decayG, last - i) * twohistory::freshWeight<long double>(g, n);
      const long double wh = power(decayH, last - i) * twohistory::freshWeight<long double>(h, n);
      weightG += wg;
      weightH += wh;
      ageSumG += age * wg;
      if (n > 0) cross += wg * wh / n;
    }
  }
};

}  // namespace tests
