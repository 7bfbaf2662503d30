// What a window says of a linear drift, and how far that is believed where all histories are old.
#include "twohistory/lag.h"

#include <gtest/gtest.h>

#include <memory>

namespace {

using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::Weighting;

constexpr float kDrift = 0.03f;  // a frame, in units of the square root of s2

/// The histories of lag-debiased after 200 frames of 1 and 8 samples and `empty` frames without any.
Ledger<3> ledgerAfter(int empty) {
  const std::array<Policy, 3> policies{Policy{Weighting::frames, Forgetting::decay, 0.95},
                                       Policy{Weighting::samples, Forgetting::decay, 0.98},
                                       Policy{Weighting::samples, Forgetting::decay, 0.6}};
  Ledger<3> l;
  for (int i = 0; i < 200; ++i) l = advance(l, policies, i % 50 < 10 ? 8.0f : 1.0f);
  for (int i = 0; i < empty; ++i) l = advance(l, policies, 0.0f);
  return l;
}

/// A window without noise in which every history lags by kDrift times its mean age.
std::unique_ptr<twohistory::DriftRow> windowOf(const Ledger<3>& l, const twohistory::Against<3>& a, float s2) {
  auto row = std::make_unique<twohistory::DriftRow>();
  row->weight[0] = row->weightSquared[0] = 1;
  row->sampleVariance[0] = s2;
  for (int k = 0; k < 2; ++k) {
    const float d = -kDrift * std::sqrt(s2) * (l.age(a.of[k]) - l.age(a.reference));
    row->of[k].difference[0] = d, row->of[k].squared[0] = d * d;
  }
  return row;
}

TEST(Lag, OfALinearDriftIsFoundExactly) {
  const twohistory::Against<3> against(2);
  const Ledger<3> l = ledgerAfter(0);
  ASSERT_LT(l.age(2), 0.5f * std::max(l.age(0), l.age(1)) - 0.5f * l.age(2));  // within reach
  const auto e = windowEvidence(l, against, *windowOf(l, against, 0.25f), 0, false);
  EXPECT_EQ(e.fresh, 1);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(e.bias[j], -kDrift * l.age(j), 1e-5f) << j;
}

TEST(Lag, IsBelievedLessTheLongerNoSampleArrives) {
  const twohistory::Against<3> against(2);
  float fresh = 1.001f, share = 1.001f;
  for (const int empty : {0, 60, 90, 120}) {
    const Ledger<3> l = ledgerAfter(empty);
    const auto e = windowEvidence(l, against, *windowOf(l, against, 0.25f), 0, false);
    const float extrapolated = -e.bias[2] / (kDrift * l.age(2));  // 1 = as if the drift had gone on all the while
    EXPECT_LT(e.fresh, fresh);
    EXPECT_LT(extrapolated, share);
    fresh = std::min(fresh, e.fresh), share = extrapolated;
  }
  EXPECT_LT(fresh, 0.5f);
  EXPECT_LT(share, 0.15f);
}

// Where nothing takes lag away, weights trade it for noise; where something will, they may look at noise alone.
TEST(Lag, ThatIsTakenAwayAfterwardsDoesNotCountForWeights) {
  const twohistory::Against<3> against(2);
  const Ledger<3> l = ledgerAfter(0);
  auto e = windowEvidence(l, against, *windowOf(l, against, 0.25f), 0, false);
  for (float& b : e.bias) b *= 0.1f;
  const auto variance = [&](float rho) {
    return twohistory::varianceOf<3, float>(covarianceOf(l), lagWeights(l, against, e, rho, -0.5f));
  };
  const auto least = twohistory::leastVarianceWeights<3, float>(covarianceOf(l));
  EXPECT_LT(1.5f * variance(0.25f), variance(1));
  EXPECT_LE(variance(0), variance(0.25f));
  const float limit = twohistory::varianceOf<3, float>(covarianceOf(l), least);
  EXPECT_LE(variance(0), limit * 1.0001f);
}

}  // namespace
