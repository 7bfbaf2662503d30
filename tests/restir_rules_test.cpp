// The rules that keep reuse unbiased, each broken on purpose in the tiny world beside its right form. Smallest bias
// detected half of the time: 1 %; every broken rule costs more.
#include "tests/tiny_world.h"

namespace {

using namespace tests::tiny;

const std::array kUnbiasedModes{Mis::contribution, Mis::balance, Mis::pairwise};

/// Pixel 0 in the mode that merges it with both neighbours; claimed: target that neighbour q is said to have.
template <class Claimed>
Reservoir withNeighbours(Mis mis, core::Rng& rng, Claimed&& claimed) {
  std::vector<Source> sources;
  for (int q = 0; q < kPixels; ++q) sources.push_back({fresh(kNow[q], 1 + q, rng), claimed(q)});
  return restir::mergeReservoirs<Table>(sources, mis, 0, rng);
}
Reservoir withNeighbours(Mis mis, core::Rng& rng) {
  return withNeighbours(mis, rng, [](int q) { return kNow[q]; });
}

TEST(RestirRules, EverySampleIsShadowTestedAtItsOwnPixel) {
  for (const Mis mis : kUnbiasedModes) {
    // tested by: whose shadow ray the pixel believes; nobody's is a world without occluders.
    const auto shaded = [&](const Table& testedBy) {
      return average([&, mis](core::Rng& rng) {
        const Reservoir r = withNeighbours(mis, rng);
        return r.unbiasedWeight > 0 ? kNow[0](r.sample) * testedBy(r.sample) * r.unbiasedWeight : 0.0f;
      });
    };
    expectUnbiased(shaded(kSees[0]), exact(0));
    expectBiased(shaded(Table{{1, 1, 1, 1}}), exact(0));  // skipped
    expectBiased(shaded(kSees[2]), exact(0));             // a neighbour's
  }
}

TEST(RestirRules, NeighboursAreMergedWithTheTargetsTheyHad) {
  for (const Mis mis : kUnbiasedModes) {
    const auto claiming = [&](auto&& claimed) {
      return average([&, mis](core::Rng& rng) { return shadePixel(0, withNeighbours(mis, rng, claimed)); });
    };
    expectUnbiased(claiming([](int q) { return kNow[q]; }), exact(0));
    expectBiased(claiming([](int) { return kNow[0]; }), exact(0));  // the centre's surface and viewer
  }
}

/// Temporal reuse of one of two taps; choose: which, of both taps' reservoirs and targets.
template <class Choose>
core::RunningMoments tapped(Mis mis, Choose&& choose) {
  return average([&, mis](core::Rng& rng) {
    const std::array<Source, 2> taps{
        {{fresh(kBefore[0], 2, rng), kBefore[0]}, {fresh(kBefore[1], 2, rng), kBefore[1]}}};
    const std::vector<Source> sources{{fresh(kNow[0], 1, rng), kNow[0]}, taps[choose(taps, rng)]};
    return shadePixel(0, restir::mergeReservoirs<Table>(sources, mis, 0, rng));
  });
}

TEST(RestirRules, TapsAreChosenWithoutLookingIntoTheirReservoirs) {
  const auto brightness = [](const Source& tap) {
    return tap.reservoir.unbiasedWeight > 0 ? tap.target(tap.reservoir.sample) * tap.reservoir.unbiasedWeight : 0;
  };
  for (const Mis mis : kUnbiasedModes) {
    expectUnbiased(tapped(mis, [](const auto&, core::Rng& rng) { return rng.below(2); }), exact(0));
    expectBiased(tapped(mis, [&](const auto& taps, core::Rng&) { return brightness(taps[1]) > brightness(taps[0]); }),
                 exact(0));
  }
}

/// Mean of four results that share a history; divisor: of how many, when `found` of them found something.
template <class Divisor>
core::RunningMoments meanOfFour(Divisor&& divisor) {
  return average([&](core::Rng& rng) {
    const Source history{fresh(kBefore[0], 1, rng), kBefore[0]};
    float sum = 0;
    int found = 0;
    for (int i = 0; i < 4; ++i) {
      const std::vector<Source> sources{{fresh(kNow[0], 1, rng), kNow[0]}, history};
      const Reservoir r = restir::mergeReservoirs<Table>(sources, Mis::balance, 0, rng);
      sum += shadePixel(0, r);
      found += r.unbiasedWeight > 0;
    }
    return found > 0 ? sum / static_cast<float>(divisor(found)) : 0.0f;
  });
}

TEST(RestirRules, TheMeanOfManyResultsCountsThoseThatFoundNothing) {
  expectUnbiased(meanOfFour([](int) { return 4; }), exact(0));
  expectBiased(meanOfFour([](int found) { return found; }), exact(0));
}

}  // namespace
