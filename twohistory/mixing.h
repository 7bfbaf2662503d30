// How alike the noise of neighbouring pixels is. Taps of one resampled image share samples, so the noise of their mix
// lies between that of independent taps (sum b^2 C) and of one value (sum b C); where, depends on how often what is
// remembered has been resampled.
//
// Let every frame move an image by a fraction f of a pixel and forget it to the factor d. The covariance R_n of pixels
// n apart follows R_n <- d^2 (s/2 R_(n-1) + (1 - s) R_n + s/2 R_(n+1)) + what is fresh at n = 0, with s = 2 f (1 - f):
// a random walk that dies at the rate u = 1 / d^2 - 1. Of its noise the share O is older than a frame, and of that taps
// have q in common. Who remembers the walk knows both (walk_tiles.h). Where it has settled R_n = rho^|n| R_0, and
//
//   [ledger walk]   rho + 1 / rho = 2 + 2 u / s
//   [ledger plane]  u -> (u + l) / (1 - l), l = s (1 - rho) of the other axis: leaving a row is like dying there
//   [ledger settled]  O = (1 - S (1 - rho)) / (1 + u),  q = rho / O,  S = 1 - sum b^2
//   [ledger guess]  s -> s + 0.9 s / (s + 0.05) (1/3 - s), for who has no better knowledge of past steps
//
// In a pixel whose counts are not its neighbours' the share F of the last frame's samples is another than 1 - O, and
// what is older than the rest is a little more alike:
//
//   [ledger alike]  r = min(1 - F, q min(3 O, o + 0.1 max(0, o - O)) + edge),  o = 1 - F - E
//
// E: the share that walked in from the image's edge, of which taps have "edge" in common (edge_noise.h).
// Derivation, and how exact this is: docs/history.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "twohistory/policy.h"
#include "twohistory/taps.h"

namespace twohistory {

/// Sums of b_k b_l over pairs of different taps (each pair twice), by how the two lie to each other; with the sum of
/// b^2 they make 1.
struct TapPairs {
  float row = 0;       ///< side by side
  float column = 0;    ///< one above the other
  float diagonal = 0;  ///< neither

  float all() const { return row + column + diagonal; }
  float alongRow() const { return row + diagonal; }        ///< s of the step in x: 2 f (1 - f)
  float alongColumn() const { return column + diagonal; }  ///< and in y
};

/// width: of the image that the taps point into, pixels. Does not depend on the taps' order.
inline TapPairs pairsOf(const Taps& t, int width) {
  const std::array<std::int32_t, 4> step{0, 1, width, width + 1};
  const int first = t.b[0] > 0 ? 0 : t.b[1] > 0 ? 1 : t.b[2] > 0 ? 2 : 3, corner = t.pixel[first] - step[first];
  const auto inPlace = [&](int k) { return (t.b[k] == 0) | (t.pixel[k] == corner + step[k]); };
  if (inPlace(0) & inPlace(1) & inPlace(2) & inPlace(3))  // as reprojection orders them
    return {2 * (t.b[0] * t.b[1] + t.b[2] * t.b[3]), 2 * (t.b[0] * t.b[2] + t.b[1] * t.b[3]),
            2 * (t.b[0] * t.b[3] + t.b[1] * t.b[2])};
  TapPairs p;
  for (int k = 0; k < 4; ++k)
    for (int l = k + 1; l < 4; ++l) {
      const bool inRow = t.pixel[k] / width == t.pixel[l] / width, inColumn = t.pixel[k] % width == t.pixel[l] % width;
      (inRow ? p.row : inColumn ? p.column : p.diagonal) += 2 * t.b[k] * t.b[l];
    }
  return p;
}

/// rho of neighbours along an axis, in [0, 1). death: u > 0; step: s >= 0.
template <class Real>
Real walkCorrelation(Real death, Real step) {
  return step / (step + death + std::sqrt(death * (death + 2 * step)));  // [ledger walk], without cancelling terms
}

/// Steps of the walk along a row and a column, each in [0, 1/2].
template <class Real>
struct WalkSteps {
  Real x, y;
};

/// What past frames' steps were likely like, if this frame's is all that is known: between it and the mean of a
/// fraction of a pixel that is anything, 1/3. An axis along which nothing moves stays so.
template <class Real>
struct LikelySteps {
  WalkSteps<Real> operator()(const Taps&, const TapPairs& p) const {
    const auto likely = [](Real s) { return s + Real(0.9) * s / (s + Real(0.05)) * (Real(1) / 3 - s); };
    return {likely(p.alongRow()), likely(p.alongColumn())};  // [ledger guess]
  }
};

/// What a history of a pixel remembers.
template <class Real>
struct Remembered {
  Real weight, ageSum;  ///< W, A
  Real factor;          ///< d of the frame that comes
};

/// u of what dies to the factor d a frame, in [1e-12, 1e6].
template <class Real>
Real deathRate(Real factor) {
  return factor > 0 ? std::clamp(1 / (factor * factor) - 1, Real(1e-12), Real(1e6)) : Real(1e6);
}

/// u of a history that has settled at its mean age, in [1e-12, 1e6].
template <class Real>
Real deathRateOfAge(Real meanAge) {
  return meanAge > 0 ? deathRate(meanAge / (meanAge + 1)) : Real(1e6);
}

/// u of a history of which nothing is known but its age: mostly its decay's, and its age's while it still grows and
/// remembers less than its decay lets it.
template <class Real>
Real deathRate(const Remembered<Real>& h) {
  const Real byAge = h.weight > 0 ? deathRateOfAge(h.ageSum / h.weight) : Real(1e6);
  return Real(0.4) * byAge + Real(0.6) * deathRate(h.factor);  // [ledger death]
}

/// What of a history's noise is older than a frame, had every pixel as many samples in every frame.
template <class Real>
struct OlderNoise {
  Real share = 0;   ///< O in [0, 1)
  Real common = 0;  ///< q S: of that, sum of b_k b_l times the correlations of different taps
};

/// Noise of a pixel's taps that stems from the image's edge, as shares of all of it.
template <class Real>
struct EdgeNoise {
  Real share = 0;   ///< E
  Real common = 0;  ///< of that, sum of b_k b_l times the correlations of different taps
};

/// Of a walk that has made these steps for ever.
template <class Real>
OlderNoise<Real> settledNoise(const TapPairs& p, const WalkSteps<Real>& s, Real death) {
  const Real lostX = s.x * (1 - walkCorrelation(death, s.x)), lostY = s.y * (1 - walkCorrelation(death, s.y));
  const Real x = walkCorrelation(death + lostY, s.x * (1 - lostY));  // [ledger plane], both divided by 1 - l
  const Real y = walkCorrelation(death + lostX, s.y * (1 - lostX));
  const Real common = p.row * x + p.column * y + p.diagonal * x * y;
  const Real share = (1 - p.all() + common) / (1 + death);  // [ledger settled]
  return {share, common / share};
}

/// Correlation of the noise of a pixel's taps, in [0, 1 - F]. p: not all zero; reference: of uniform counts;
/// freshShare: F in [0, 1].
template <class Real>
Real tapLikeness(const TapPairs& p, const OlderNoise<Real>& reference, Real freshShare, const EdgeNoise<Real>& edge) {
  const Real left = 1 - freshShare, older = std::max(Real(0), left - edge.share);  // o
  const Real counted = std::min(3 * reference.share, older + Real(0.1) * std::max(Real(0), older - reference.share));
  return std::min(left, (reference.common * counted + edge.common) / p.all());  // [ledger alike]
}

/// w^2 / n of a frame of n samples; 0 where it has none.
template <class Real>
Real freshNoise(const Policy& policy, Real n) {
  const Real w = freshWeight(policy, n);
  return n > 0 ? w * w / n : Real(0);
}

/// What a pixel's noise has walked through, from its steps alone: they are taken for those of all frames, this frame's
/// samples for the last one's, and nothing came in over an edge. Also what any knowledge of past walks must answer.
template <class Real>
struct SettledWalk {
  WalkSteps<Real> steps;

  /// w^2 / n of the last frame. n: of the frame that comes.
  Real freshNoise(const Policy& policy, Real n) const { return twohistory::freshNoise(policy, n); }
  /// freshShare: F, in [0, 1].
  OlderNoise<Real> older(const TapPairs& p, const Remembered<Real>& h, Real /*freshShare*/) const {
    return settledNoise(p, steps, deathRate(h));
  }
  /// noise: C.
  EdgeNoise<Real> edge(const TapPairs&, const Policy&, const Remembered<Real>&, Real /*noise*/) const { return {}; }
};

template <class Real>
SettledWalk<Real> walkOf(const WalkSteps<Real>& steps) {
  return {steps};
}
template <class Walk>
const Walk& walkOf(const Walk& walk) {
  return walk;
}

}  // namespace twohistory
