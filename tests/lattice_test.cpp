// The lattice's points are uniform one by one and even together.
#include "core/lattice.h"

#include <gtest/gtest.h>

namespace {

using core::Lattice3;

/// Mean of f(u, v, w) = u v + w^2 over n points, minus its integral 1/4 + 1/3.
double errorOf(std::uint32_t seed, std::uint32_t n, bool lattice) {
  core::Rng rng(21, core::Pass::other, seed, 0);
  const Lattice3 points(rng);
  double sum = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto b = points.bits(i);
    const double u = lattice ? Lattice3::uniform(b[0]) : rng.uniform(),
                 v = lattice ? Lattice3::uniform(b[1]) : rng.uniform(),
                 w = lattice ? Lattice3::uniform(b[2]) : rng.uniform();
    sum += u * v + w * w;
  }
  return sum / n - (1.0 / 4 + 1.0 / 3);
}

TEST(Lattice, EverySinglePointIsUniform) {
  // Mean over 20,000 shifts of point 37's coordinates: 5.3 standard errors (1e-7) around 1/2.
  double sum[3] = {};
  constexpr int kShifts = 20'000;
  for (std::uint32_t seed = 0; seed < kShifts; ++seed) {
    core::Rng rng(20, core::Pass::other, seed, 0);
    const auto b = Lattice3(rng).bits(37);
    for (int d = 0; d < 3; ++d) sum[d] += Lattice3::uniform(b[d]);
  }
  for (const double s : sum) EXPECT_NEAR(s / kShifts, 0.5, 5.3 * std::sqrt(1.0 / 12 / kShifts));
}

TEST(Lattice, MeansAreUnbiasedAndMuchBetterThanWithRandomPoints) {
  double mean = 0, lattice2 = 0, random2 = 0;
  constexpr int kShifts = 2000;
  for (std::uint32_t seed = 0; seed < kShifts; ++seed) {
    const double e = errorOf(seed, 256, true), r = errorOf(seed, 256, false);
    mean += e / kShifts, lattice2 += e * e / kShifts, random2 += r * r / kShifts;
  }
  EXPECT_NEAR(mean, 0, 5.3 * std::sqrt(lattice2 / kShifts));
  EXPECT_LT(lattice2, 0.1 * random2);
}

}  // namespace
