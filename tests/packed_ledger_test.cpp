// The stored form of histories: what packing rounds, that it neither stalls nor drifts, and what it costs in bytes.
#include "twohistory/packed_ledger.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/bfloat16.h"
#include "core/half.h"
#include "core/shared_exponent.h"
#include "tests/schedule.h"
#include "tests/synthetic.h"
#include "twohistory/combination.h"

namespace {

using core::Bfloat16;
using core::Half;
using core::SharedExponent;
using core::vec3;
using twohistory::ditherOf;
using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::PackedLedger;
using twohistory::Policy;
using twohistory::Weighting;
namespace small_float = twohistory::small_float;

const Policy kU{Weighting::frames, Forgetting::decay, 0.95}, kW{Weighting::samples, Forgetting::decay, 0.95},
    kF{Weighting::samples, Forgetting::decay, 0.8};

TEST(SmallFloat, EveryCodeReturnsWhateverTheRounding) {
  for (std::uint32_t code = 0; code <= small_float::kMost; ++code)
    for (const std::uint32_t dither : {0u, 1u, 4096u, 8191u})
      ASSERT_EQ(small_float::pack(small_float::unpack(static_cast<std::uint16_t>(code)), dither), code);
}

TEST(SmallFloat, RoundsUpInProportionToWhatIsMissing) {
  for (const float x : {1.0001f, 0.33333f, 1234.5678f, 3e-7f}) {
    double sum = 0;
    for (std::uint32_t dither = 0; dither < 8192; ++dither) sum += small_float::unpack(small_float::pack(x, dither));
    EXPECT_NEAR(sum / 8192 / x, 1, 3e-6) << x;
  }
  EXPECT_GT(std::abs(small_float::unpack(small_float::pack(0.33333f, 0)) / 0.33333f - 1), 3e-6);  // control: one alone
}

TEST(SmallFloat, SaturatesAndNeverLosesAPositiveNumber) {
  EXPECT_EQ(small_float::pack(0, 8191), 0);
  EXPECT_EQ(small_float::pack(1e-45f, 0), 1);
  EXPECT_EQ(small_float::pack(1e30f, 8191), small_float::kMost);
  EXPECT_EQ(small_float::pack(core::kInfinity, 8191), small_float::kMost);
}

TEST(Bfloat16, RoundsToNearestAndStaysFinite) {
  for (const float x : {0.0f, -0.0f, 1.0f, -1.5f, 0x1p-126f, 0x1p100f}) EXPECT_EQ(Bfloat16(x), x);
  core::Rng rng(1, core::Pass::other, 0, 0);
  for (int i = 0; i < 100'000; ++i) {
    const float x = std::ldexp(rng.uniform() - 0.5f, static_cast<int>(rng.below(200)) - 100);
    ASSERT_LE(std::abs(Bfloat16(x) - x), std::abs(x) * 0x1p-8f);
  }
  const float most = std::numeric_limits<float>::max();
  EXPECT_TRUE(std::isfinite(Bfloat16(most)));
  EXPECT_TRUE(std::isfinite(Bfloat16(-most)));
  EXPECT_TRUE(std::isnan(Bfloat16(std::bit_cast<float>(0x7f800001u))));
}

TEST(Half, RoundsToNearestBetweenItsLimitsAndStaysFinite) {
  for (const float x : {0.0f, -0.0f, 1.0f, -1.5f, 65504.0f, 0x1p-14f, -0x1p-24f}) EXPECT_EQ(Half(x), x);
  EXPECT_TRUE(std::signbit(float(Half(-0.0f))));
  core::Rng rng(1, core::Pass::other, 1, 0);
  for (int i = 0; i < 100'000; ++i) {
    const float x = std::ldexp(rng.uniform() - 0.5f, static_cast<int>(rng.below(46)) - 29);  // 2^-30 .. 2^15
    ASSERT_LE(std::abs(Half(x) - x), std::max(std::abs(x) * 0x1p-11f, 0x1p-25f)) << x;
    ASSERT_EQ(Half(Half(x)), Half(x));
  }
  EXPECT_EQ(Half(1 + 0x1p-11f), 1);                                 // ties to even
  EXPECT_EQ(Half(1 + 0x3p-11f), 1 + 0x1p-9f);                       // upwards
  EXPECT_EQ(Half(0x1p-26f), 0);                                     // denormals end here
  EXPECT_EQ(Half(std::numeric_limits<float>::denorm_min()), 0);     // a float's, too
  for (const float tooLarge : {65520.0f, 1e6f, core::kInfinity}) {  // the range's trouble: radiance goes up to 1e6
    EXPECT_EQ(Half(tooLarge), 65504);
    EXPECT_EQ(Half(-tooLarge), -65504);
  }
  EXPECT_TRUE(std::isnan(Half(std::numeric_limits<float>::quiet_NaN())));
}

float largestOf(const vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

TEST(SharedExponent, ErrsByAShareOfTheLargestChannel) {
  core::Rng rng(1, core::Pass::other, 2, 0);
  double worst = 0;
  for (int i = 0; i < 100'000; ++i) {
    // Signed, channels of unequal size, 2^-100 .. 2^100 (radiance 1e-4 .. 1e6 is 2^-13 .. 2^20).
    const float scale = std::ldexp(1.0f, static_cast<int>(rng.below(200)) - 100);
    const vec3 v = scale * (rng.uniform3() - 0.5f) * vec3(1, 1, rng.uniform() < 0.5f ? 1e-3f : 1);
    const vec3 back = SharedExponent(v);
    worst = std::max<double>(worst, largestOf(back - v) / largestOf(v));
    ASSERT_EQ(vec3(SharedExponent(back)), back);  // storing again changes nothing
  }
  EXPECT_LE(worst, 0x1p-7);
  EXPECT_GT(worst, 0x1p-8);  // control: no bit fewer would do
}

TEST(SharedExponent, KeepsSignsZeroAndTheEndsOfItsRange) {
  EXPECT_EQ(vec3(SharedExponent(vec3(0))), vec3(0));
  EXPECT_EQ(vec3(SharedExponent()), vec3(0));
  for (const float x : {1e-4f, 1.0f, 1e6f, 0x1p-110f, 0x1p120f}) {
    const vec3 v = SharedExponent(vec3(x, -x, 0));
    EXPECT_NEAR(v.x / x, 1, 0x1p-7);
    EXPECT_EQ(v.y, -v.x);
    EXPECT_EQ(v.z, 0);
  }
  EXPECT_EQ(vec3(SharedExponent(vec3(std::numeric_limits<float>::denorm_min()))), vec3(0));
  EXPECT_EQ(sizeof(SharedExponent), 4u);
}

TEST(SharedExponent, StaysFiniteUnlessItIsNotANumber) {
  const float most = std::numeric_limits<float>::max(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const vec3& v : {vec3(most, -most, 0), vec3(core::kInfinity, 1, -core::kInfinity)}) {
    const vec3 back = SharedExponent(v);
    EXPECT_TRUE(core::isFinite(back));
    EXPECT_GT(largestOf(back), 0.98f * most);
  }
  const vec3 bad = SharedExponent(vec3(1, nan, 0));
  EXPECT_TRUE(std::isnan(bad.x) && std::isnan(bad.y) && std::isnan(bad.z));
}

/// Runs packed and float ledgers side by side; `dithered` as stored, else always rounded to nearest.
template <int K>
struct SideBySide {
  Ledger<K> exact, packed;
  void step(const twohistory::Policies<K>& p, float n, std::uint32_t frame, bool dithered = true) {
    exact = advance(exact, p, n);
    packed = PackedLedger<K>(advance(packed, p, n), dithered ? ditherOf(7, frame) : 4096);
  }
};

TEST(PackedLedger, StaysWithinItsRoundingOverRandomSchedules) {
  core::Rng rng(2, core::Pass::other, 0, 0);
  SideBySide<3> s;
  double worst = 0, sum = 0;
  constexpr std::uint32_t kFrames = 100'000;
  int count = 8;
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    if (rng.below(20) == 0) count = std::array{0, 1, 8, 64, 4096, 3}[rng.below(6)];
    s.step({kU, kW, kF}, static_cast<float>(count), i);
    if (s.exact.weight[2] < 0x1p-40f * s.exact.weight[0]) continue;  // saturates, as documented
    for (int g = 0; g < 3; ++g) {
      worst = std::max<double>(worst, std::abs(s.packed.weight[g] / s.exact.weight[g] - 1));
      for (int h = g; h < 3; ++h) {
        const double error = s.packed.covariance(g, h) / s.exact.covariance(g, h) - 1;
        worst = std::max(worst, std::abs(error)), sum += error;
      }
    }
  }
  EXPECT_LT(worst, 0.015);  // a step rounds by 2^-10 at most; recursions add some up
  EXPECT_LT(std::abs(sum / kFrames / 6), 2e-4);
}

// Packed in every frame, as images are, p is worth a little less than history_properties_test says of float ledgers.
TEST(PackedLedger, LeavesTheLeastVarianceWeightInRangeWithLittleRegret) {
  double worst = 0, sum = 0;
  constexpr std::uint32_t kSchedules = 100'000;
  for (std::uint32_t i = 0; i < kSchedules; ++i) {
    core::Rng rng(3, core::Pass::other, i, 0);
    auto counts = tests::randomCounts(rng, 1 + static_cast<int>(rng.below(60)), rng.uniform() < 0.2f ? 4096 : 64);
    counts.push_back(1 + static_cast<int>(rng.below(8)));
    const double decay = tests::randomDecay(rng);
    const Policy u{Weighting::frames, Forgetting::decay, decay}, w{Weighting::samples, Forgetting::decay, decay};
    Ledger<2> packed;
    Ledger<2, double> exact;
    for (std::uint32_t f = 0; f < counts.size(); ++f) {
      packed = PackedLedger<2>(advance(packed, {u, w}, static_cast<float>(counts[f])), ditherOf(i, f));
      exact = advance(exact, {u, w}, static_cast<double>(counts[f]));
    }
    const float p = leastVarianceWeight(twohistory::pairOf(packed, 0, 1));
    ASSERT_TRUE(p >= 0 && p <= 1) << "schedule " << i;
    const auto c = twohistory::pairOf(exact, 0, 1);
    const double regret = c.blend(p) / c.blend(leastVarianceWeight(c)) - 1;
    worst = std::max(worst, regret), sum += regret;
    ASSERT_LE(c.blend(p), std::min(c.first, c.second) * (1 + 2e-3)) << "schedule " << i;
  }
  EXPECT_LE(worst, 2e-3);
  EXPECT_LE(sum / kSchedules, 1e-5);
  EXPECT_GT(worst, 1e-5);  // what floats keep to
}

TEST(PackedLedger, ArrivesWhereRoundingToNearestStalls) {
  for (const bool dithered : {true, false}) {
    SideBySide<2> s;
    const Policy slow{Weighting::frames, Forgetting::decay, 0.98}, other{Weighting::samples, Forgetting::decay, 0.9};
    double sum = 0;
    for (std::uint32_t i = 0; i < 10'000; ++i) {
      s.step({slow, other}, i < 500 ? 8.0f : 1.0f, i, dithered);
      if (i >= 2000) sum += s.packed.weight[1] / s.exact.weight[1] - 1;
    }
    if (dithered)
      EXPECT_LT(std::abs(sum / 8000), 3e-4);
    else
      EXPECT_GT(std::abs(sum / 8000), 1e-3);  // control
  }
}

TEST(PackedLedger, EmptyHistoriesStayEmpty) {
  Ledger<2> l;
  EXPECT_EQ(Ledger<2>(PackedLedger<2>(l, 5)).weight[0], 0);
  l = advance(l, {Policy{Weighting::frames, Forgetting::decay, 0}, kW}, 4.0f);
  l = advance(l, {Policy{Weighting::frames, Forgetting::decay, 0}, kW}, 0.0f);  // history 0 forgets all, 1 does not
  const Ledger<2> back = PackedLedger<2>(l, 5);
  EXPECT_EQ(back.weight[0], 0);
  EXPECT_NEAR(back.weight[1], l.weight[1], 2e-3f * l.weight[1]);
  EXPECT_NEAR(back.covariance(1, 1), l.covariance(1, 1), 2e-3f * l.covariance(1, 1));
}

TEST(PackedLedger, HasNoSpareBytes) {
  EXPECT_EQ(sizeof(PackedLedger<1>), 8u);
  EXPECT_EQ(sizeof(PackedLedger<2>), 16u);
  EXPECT_EQ(sizeof(PackedLedger<3>), 26u);
}

/// What a slow history in `Stored` is after a step up of all channels, kept as its difference from a fast one in float,
/// or (control) as it is.
template <class Stored>
vec3 slowAfterStep(bool asDifference) {
  const vec3 truth(1, 0.4f, 0.1f);
  const auto read = [](const Stored& s) {
    vec3 v(0);
    for (int c = 0; c < core::kChannels<Stored>; ++c) v[c] = core::channelOf(s, c);
    return v;
  };
  vec3 fast(0);
  Stored stored(0.0f);
  for (int i = 0; i < 10'000; ++i) {
    const vec3 base = asDifference ? fast : vec3(0), slow = base + read(stored);
    fast += 0.2f * (truth - fast);
    const vec3 next = slow + 0.05f * (truth - slow), kept = next - (asDifference ? fast : vec3(0));
    if constexpr (core::kChannels<Stored> == 3)
      stored = Stored(kept);
    else
      stored = Stored(kept.x);
  }
  return (asDifference ? fast : vec3(0)) + read(stored);
}

TEST(Differences, OfHistoriesDoNotStall) {
  // The slow history follows the fast one; their stored difference must vanish with it.
  EXPECT_NEAR(slowAfterStep<Bfloat16>(true).x, 1, 1e-5f);
  EXPECT_NEAR(slowAfterStep<Half>(true).x, 1, 1e-5f);
  EXPECT_NEAR(slowAfterStep<SharedExponent>(true).x, 1, 1e-5f);
  EXPECT_GT(std::abs(slowAfterStep<Bfloat16>(false).x - 1), 0.01f);  // control: the history itself in two bytes
  EXPECT_GT(std::abs(slowAfterStep<Half>(false).x - 1), 2e-3f);
  EXPECT_GT(std::abs(slowAfterStep<SharedExponent>(false).x - 1), 0.01f);
}

/// Bytes a pixel that a variant keeps beyond one history, after some frames.
double extraBytes(const char* name) {
  constexpr int kSide = 256;
  const auto bytes = [](const char* which) {
    const experiments::Variant v = experiments::variantByName(which);
    tests::Synthetic input(
        kSide, kSide, 1, [](int, int, int) { return core::vec3(1); }, [](int x, int, int) { return x < 90 ? 8 : 1; });
    experiments::FilterState state(v, kSide, kSide);
    core::Planes out(kSide, kSide);
    for (int i = 0; i < 2; ++i) filter(input.frame(i), v, {}, state, out);
    return static_cast<double>(state.bytes());
  };
  return (bytes(name) - bytes("unweighted")) / (kSide * kSide);
}

TEST(Memory, OfMoreHistoriesStaysWithinItsBudget) {
  for (const char* pair : {"optimal", "consistent", "lag-uw"}) EXPECT_LE(extraBytes(pair), 32) << pair;
  EXPECT_LE(extraBytes("lag-wf"), 48);
  for (const char* three : {"lag-checked", "lag-debiased", "lag-even"}) EXPECT_LE(extraBytes(three), 64) << three;
  EXPECT_GT(extraBytes("seed"), 48);  // control: its gradient alone is 36
}

}  // namespace
