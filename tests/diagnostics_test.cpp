// The pictures of reuse say what is so: ages against a replay by hand, duplicates against a count, and nothing changes
// for being looked at.
#include "restir/diagnostics.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "tests/restir_worlds.h"

namespace {

using restir::Diagnostics;
using restir::Reservoir;
using restir::RestirParameters;
using restir::RestirState;
using restir::Reuse;

constexpr int kFrames = 8;

RestirParameters told(Reuse reuse) {
  RestirParameters p;
  p.reuse = reuse, p.tellAll = true;
  return p;
}

using Key = std::tuple<std::uint32_t, float, float>;
Key keyOf(const Reservoir& r) { return {r.sample.light, r.sample.uv.x, r.sample.uv.y}; }
bool holds(const Reservoir& r) { return r.unbiasedWeight > 0; }

/// Calls body(frame number, state, diagnostics) after each frame of a world; counts(frame, x, y) gives n.
template <class Counts, class Body>
void watch(const tests::World& world, const RestirParameters& p, Counts counts, Body body) {
  RestirState state(world.width(), world.height());
  Diagnostics diagnostics(world.width(), world.height());
  core::Image<float> samples(world.width(), world.height());
  core::Planes out(world.width(), world.height());
  for (int f = 0; f < world.frames(); ++f) {
    for (int y = 0; y < world.height(); ++y)
      for (int x = 0; x < world.width(); ++x) samples(x, y) = counts(f, x, y);
    const restir::Frame frame = world.frame(f, samples, 5);
    drawCandidates(p, frame, state);
    reuseTemporally(p, frame, state);
    reuseSpatiallyAndShade(p, frame, state, out);
    diagnostics.update(p, frame, state);
    body(f, state, diagnostics);
  }
}

float once(int, int, int) { return 1; }
float sometimes(int f, int x, int y) { return static_cast<float>((f + x + 2 * y) % 3); }

/// The frame in which a sample was first seen anywhere tells its age, since no two draws are the same.
template <class Counts>
void expectAges(const tests::World& world, Counts counts) {
  std::map<Key, int> born;
  int oldest = 0;
  watch(world, told(Reuse::both), counts, [&](int f, const RestirState& state, const Diagnostics& d) {
    for (int y = 0; y < world.height(); ++y)
      for (int x = 0; x < world.width(); ++x) {
        if (holds(state.fresh(x, y))) born.try_emplace(keyOf(state.fresh(x, y)), f);
        const Reservoir& r = state.now(x, y);
        if (!holds(r)) {
          EXPECT_EQ(d.age()(x, y), -1);
          continue;
        }
        ASSERT_TRUE(born.count(keyOf(r)));
        EXPECT_EQ(d.age()(x, y), static_cast<float>(f - born[keyOf(r)])) << "frame " << f << " at " << x << ", " << y;
        oldest = std::max(oldest, f - born[keyOf(r)]);
      }
  });
  EXPECT_GT(oldest, 2);
}

TEST(Diagnostics, AgeIsTheTimeSinceASampleWasDrawn) { expectAges(tests::World(tests::makeWorld(), kFrames), once); }

TEST(Diagnostics, AgeGoesOnWhereNothingIsSampledAndUnderMotion) {
  tests::Motion motion;
  motion.camera = {0.03f, 0, 0.02f};
  expectAges(tests::World(tests::makeWorld(motion), kFrames), sometimes);
}

TEST(Diagnostics, DuplicatesAreCounted) {
  tests::Motion motion;
  motion.camera = {0.03f, 0, 0.02f};
  const tests::World world(tests::makeWorld(motion), kFrames);
  float most = 0;
  watch(world, told(Reuse::temporal), once, [&](int, const RestirState& state, const Diagnostics& d) {
    std::map<Key, std::vector<core::ivec2>> where;
    for (int y = 0; y < world.height(); ++y)
      for (int x = 0; x < world.width(); ++x)
        if (holds(state.now(x, y))) where[keyOf(state.now(x, y))].push_back({x, y});
    for (const auto& [key, pixels] : where)
      for (const core::ivec2 a : pixels) {
        const auto near = std::count_if(pixels.begin(), pixels.end(), [&](core::ivec2 b) {
          return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)) <= Diagnostics::kReach;
        });
        EXPECT_EQ(d.duplicates()(a.x, a.y), static_cast<float>(near - 1));
        most = std::max(most, d.duplicates()(a.x, a.y));
      }
  });
  EXPECT_GT(most, 0) << "stochastic taps under motion copy samples";
}

TEST(Diagnostics, ConfidenceAndWorthAreTheLedgers) {
  const tests::World world(tests::makeWorld(), kFrames);
  watch(world, told(Reuse::both), once, [&](int f, const RestirState& state, const Diagnostics& d) {
    for (int y = 0; y < world.height(); ++y)
      for (int x = 0; x < world.width(); ++x) {
        if (!world.moment(f).surfaces(x, y).hit()) continue;
        EXPECT_EQ(d.confidence()(x, y), static_cast<float>(f + 1));
        EXPECT_EQ(d.effective()(x, y), state.effective(x, y));
        EXPECT_LE(d.effective()(x, y), 1.0001f);
      }
  });
}

TEST(Diagnostics, WithoutReuseASampleIsWorthItself) {
  const tests::World world(tests::makeWorld(), 2);
  watch(world, told(Reuse::none), sometimes, [&](int f, const RestirState&, const Diagnostics& d) {
    for (int y = 0; y < world.height(); ++y)
      for (int x = 0; x < world.width(); ++x) {
        EXPECT_EQ(d.age()(x, y), -1);
        if (!world.moment(f).surfaces(x, y).hit()) continue;
        EXPECT_EQ(d.effective()(x, y), sometimes(f, x, y));
      }
  });
}

}  // namespace
