// One accumulate() carries colours, moments and reservoirs: the same properties hold for every remembered value.
#include "twohistory/history.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "restir/reservoir.h"
#include "svgf/moments.h"
#include "twohistory/mean.h"

namespace {

using core::Image;
using core::In;
using core::vec3;
using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::Step;
using twohistory::Taps;
using twohistory::Weighting;

/// Resampling for one target that all pixels share. restir's own merge needs a scene; restir_test and restir_world_test
/// carry it through the same accumulate().
struct SharedTargetMerge {
  restir::Reservoir gather(In<restir::Reservoir> before, const Step& step) const {
    if (!step.hasHistory()) return {};
    restir::Reservoir r = before.at(step.taps.pixel[0]);
    r.confidence = step.kept;
    return r;
  }
  restir::Reservoir merge(const restir::Reservoir& old, const restir::Reservoir& fresh, const Step& step) const {
    if (!(step.fresh > 0)) return old;
    core::Rng rng(1, core::Pass::temporal, static_cast<std::uint32_t>(step.pixel.x), 0);
    const float total = step.kept + step.fresh;
    restir::ReservoirBuilder builder;
    for (const auto& [r, share] : {std::pair{old, step.kept / total}, std::pair{fresh, step.fresh / total}})
      builder.add(r.sample, target(r), share * target(r) * r.unbiasedWeight, rng);
    return builder.finish(total, 0);
  }
  static float target(const restir::Reservoir& r) { return 1 + static_cast<float>(r.sample.light); }
};

// Each kind: the remembered type, its merge, a fresh value number i, and numbers to compare.
struct Colour {
  using Value = vec3;
  using Fresh = vec3;
  using Merge = twohistory::Mean<vec3>;
  static float firstNumber(const Fresh& x) { return x.x; }
  static Fresh fresh(int i) { return vec3(static_cast<float>(i), 2, 0.5f * static_cast<float>(i)); }
  static std::vector<float> numbers(const Value& v) { return {v.x, v.y, v.z}; }
};
struct Moments {
  using Value = svgf::Moments;
  using Fresh = float;
  using Merge = svgf::MomentsMerge;
  static float firstNumber(Fresh x) { return x; }
  static Fresh fresh(int i) { return 1 + static_cast<float>(i % 3); }
  static std::vector<float> numbers(const Value& v) { return {v.mean, v.sampleVariance, v.innovations}; }
};
struct Reservoir {
  using Value = restir::Reservoir;
  using Fresh = restir::Reservoir;
  using Merge = SharedTargetMerge;
  static float firstNumber(const Fresh& x) { return static_cast<float>(x.sample.light); }
  static Fresh fresh(int i) { return {{static_cast<std::uint32_t>(i), {0.5f, 0.5f}}, 1.0f / (1 + i), 1, 0}; }
  static std::vector<float> numbers(const Value& v) { return {static_cast<float>(v.sample.light), v.unbiasedWeight}; }
};

template <class Kind>
class History : public testing::Test {
 protected:
  using Value = typename Kind::Value;

  /// One pixel carried through frames of given counts; count < 0 = reset, then |count| samples.
  Value run(const std::vector<int>& counts, const Policy& policy, Ledger<1>* end = nullptr) {
    Image<Value> value(1, 1), next(1, 1);
    Image<Ledger<1>> ledger(1, 1), ledgerNext(1, 1);
    Image<Taps> taps(1, 1);
    Image<float> n(1, 1);
    Image<typename Kind::Fresh> fresh(1, 1);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      taps(0, 0) = i > 0 && counts[i] >= 0 ? twohistory::stillTap(0) : Taps{};
      n(0, 0) = static_cast<float>(std::abs(counts[i]));
      fresh(0, 0) = Kind::fresh(static_cast<int>(i % 5));
      twohistory::accumulate<1>(taps.view(), n.view(), {policy}, ledger.view(), ledgerNext.view(),
                                typename Kind::Merge{}, std::array<In<Value>, 1>{value}, fresh.view(),
                                std::array<core::ImageView<Value>, 1>{next});
      std::swap(value, next);
      std::swap(ledger, ledgerNext);
    }
    if (end) *end = ledger(0, 0);
    return value(0, 0);
  }
};

using Kinds = testing::Types<Colour, Moments, Reservoir>;
TYPED_TEST_SUITE(History, Kinds);

const Policy kDecay{Weighting::samples, Forgetting::decay, 0.95};

TYPED_TEST(History, FramesWithoutSamplesKeepTheValueAndDecayItsWeight) {
  Ledger<1> before, after;
  const auto a = this->run({1, 4, 2}, kDecay, &before);
  const auto b = this->run({1, 4, 2, 0, 0, 0}, kDecay, &after);
  EXPECT_EQ(TypeParam::numbers(a), TypeParam::numbers(b));
  EXPECT_FLOAT_EQ(after.weight[0], before.weight[0] * 0.95f * 0.95f * 0.95f);
}

TYPED_TEST(History, AResetIsAFreshStart) {
  // Frame 5 of five-periodic fresh values is fresh value 0 again.
  Ledger<1> reset, start;
  const auto a = this->run({1, 4, 2, 8, 8, -3}, kDecay, &reset);
  const auto b = this->run({3}, kDecay, &start);
  EXPECT_EQ(TypeParam::numbers(a), TypeParam::numbers(b));
  EXPECT_EQ(reset.weight, start.weight);
  EXPECT_EQ(reset.powerSums, start.powerSums);
}

TYPED_TEST(History, ConstantPowerOfTwoCountsMakeBothWeightingsTheSameBits) {
  const Policy frames{Weighting::frames, Forgetting::decay, 0.95};
  for (const int n : {1, 2, 8, 64}) {
    const std::vector<int> counts(40, n);
    EXPECT_EQ(TypeParam::numbers(this->run(counts, kDecay)), TypeParam::numbers(this->run(counts, frames))) << n;
  }
}

TYPED_TEST(History, ControlVaryingCountsMakeTheWeightingsDiffer) {
  const Policy frames{Weighting::frames, Forgetting::decay, 0.95};
  const std::vector<int> counts{1, 8, 1, 64, 1, 1, 8, 8, 1, 2, 1, 1, 16, 1};
  Ledger<1> a, b;
  this->run(counts, kDecay, &a);
  this->run(counts, frames, &b);
  EXPECT_NE(a.covariance(0, 0), b.covariance(0, 0));
}

TYPED_TEST(History, DecayZeroRemembersOnlyTheLastSample) {
  const Policy none{Weighting::frames, Forgetting::decay, 0};
  Ledger<1> end;
  const auto value = this->run({1, 1, 1, 1, 7}, none, &end);
  EXPECT_EQ(TypeParam::numbers(value)[0], TypeParam::firstNumber(TypeParam::fresh(4)));
  EXPECT_EQ(end.weight[0], 1);
  EXPECT_FLOAT_EQ(end.covariance(0, 0), 1.0f / 7);
}

TEST(Mean, TapsOfUnequalWeightMixInProportionToWhatTheyStandFor) {
  Image<Ledger<1>> ledger(2, 1);
  Image<vec3> value(2, 1);
  ledger(0, 0).weight[0] = 1, value(0, 0) = vec3(0);
  ledger(1, 0).weight[0] = 160, value(1, 0) = vec3(1);
  const Taps half{{0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
  Step step;
  step.taps = twohistory::premultiplied<1>(half, ledger.view(), 0);
  const vec3 mixed = twohistory::Mean<vec3>{}.gather(In<vec3>(value), step);
  EXPECT_FLOAT_EQ(mixed.x, 160.0f / 161);
}

TEST(Moments, ATapWithoutInnovationsDoesNotDiluteTheVariance) {
  Image<svgf::Moments> before(2, 1);
  before(0, 0) = {1, 0.25f, 1};
  before(1, 0) = {2, 0, 0};
  Step step;
  step.taps = {{0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
  const svgf::Moments m = svgf::MomentsMerge{}.gather(In<svgf::Moments>(before), step);
  EXPECT_FLOAT_EQ(m.mean, 1.5f);
  EXPECT_FLOAT_EQ(m.sampleVariance, 0.25f);
  EXPECT_FLOAT_EQ(m.innovations, 0.5f);
}

TEST(Mean, AFreshValueOfWeightZeroIsNeverRead) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Step step;
  step.kept = 3;
  EXPECT_EQ(twohistory::Mean<vec3>{}.merge(vec3(2), vec3(nan), step), vec3(2));
}

}  // namespace
