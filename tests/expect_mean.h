// Means of many trials against what is known exactly. Significance 1e-6.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "core/statistics.h"

namespace tests {

inline constexpr double kLeastBias = 0.01;  ///< that tests of means detect, and that their controls have; relative
inline const double kLargestZ = core::sidakBound(1, 1e-6);

/// Difference from what is expected that chance makes once in a million times.
inline double largestChance(const core::RunningMoments& m) { return kLargestZ * std::sqrt(m.meanVariance()); }

/// Unbiased, by a test that notices a bias of kLeastBias half of the time.
inline void expectUnbiased(const core::RunningMoments& m, double expected) {
  EXPECT_LT(std::abs(m.mean() - expected), largestChance(m)) << m.mean() << " instead of " << expected;
  EXPECT_LT(largestChance(m), kLeastBias * expected);
}
/// Biased by more than kLeastBias, whatever chance added.
inline void expectBiased(const core::RunningMoments& m, double truth) {
  EXPECT_GT(std::abs(m.mean() - truth), kLeastBias * truth + largestChance(m))
      << m.mean() << " is as good as " << truth;
}

}  // namespace tests
