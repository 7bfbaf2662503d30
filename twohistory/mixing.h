// How alike the noise of neighbouring pixels is. Taps of one resampled image share samples, so the noise of their mix
// lies between that of independent taps (sum b^2 C) and of one value (sum b C); where, depends on how often what is
// remembered has been resampled.
//
// Let every frame move an image by a fraction f of a pixel and forget it to the factor d. The covariance R_n of pixels
// n apart follows R_n <- d^2 (s/2 R_(n-1) + (1 - s) R_n + s/2 R_(n+1)) + what is fresh at n = 0, with s = 2 f (1 - f):
// a random walk that dies at the rate u = 1 / d^2 - 1. Where it has settled R_n = rho^|n| R_0, and
//
//   [ledger walk]   rho + 1 / rho = 2 + 2 u / s
//   [ledger plane]  u -> (u + l) / (1 - l), l = s (1 - rho) of the other axis: leaving a row is like dying there
//   [ledger alike]  r = min(1, rho min(3, o + 0.2 max(0, o - 1)) + edge), o = (1 - F - E) / O,
//                   O = (1 - S (1 - rho)) / (1 + u), S = 1 - sum b^2
//   [ledger guess]  s -> s + 0.9 s / (s + 0.05) (1/3 - s), for who has no better knowledge of past steps (steps.h)
//
// F is the share of the noise that a frame's fresh samples have, O what a settled walk has older than a frame, E the
// share that walked in from the image's edge, where nothing steps in from beyond (arrivals.h): T frames ago,
//
//   [ledger share]  E_x = d^2T_x C_still / C u / (u + l_y) at the left or right edge, where walks go up and down alone
//   [ledger still]  C_still = w / n W / (1 + d), the power sum of a history that has never stepped
//
// of which "edge" is the part that taps have in common: what lies in a row is one value, in a column it is as alike as
// along the edge; and the same for the upper and lower edge.
// Derivation, and how exact this is: docs/history.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "twohistory/arrivals.h"
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

/// What a pixel's noise has walked through before a frame.
template <class Real>
struct Walk {
  WalkSteps<Real> steps;
  Arrival arrival;  ///< over the image's edge

  /// Implicit: who remembers steps alone takes it that nothing came in.
  Walk(const WalkSteps<Real>& s, const Arrival& a = {}) : steps(s), arrival(a) {}
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

/// d^2T of a history that dies at the rate u > 0: exact for whole T >= 0, linear between, 0 from kLongAgo on.
template <class Real>
Real survival(Real death, float frames) {
  if (frames >= Arrival::kLongAgo) return 0;
  const int whole = static_cast<int>(frames);
  const Real kept = 1 / (1 + death);
  Real result = 1 - (frames - whole) * (1 - kept), power = kept;
  for (int bits = whole; bits > 0; bits /= 2, power *= power)
    if (bits % 2) result *= power;
  return result;
}

/// Shares of a pixel's noise that stem from the image's edge.
template <class Real>
struct EdgeShares {
  Real corner = 0;    ///< a corner, where nothing steps: one value
  Real x = 0, y = 0;  ///< the left or right edge, where steps are up and down; the upper or lower one

  Real all() const { return corner + x + y; }
};

/// What reached one edge after the other is a corner's since the later of the two. lost: l of both axes; still: C_still
/// over the pixel's power sum.
template <class Real>
EdgeShares<Real> edgeShares(const Arrival& arrival, const WalkSteps<Real>& lost, Real death, Real still) {
  if (arrival.isLongAgo()) return {};
  const Real x = survival(death, arrival.x), y = survival(death, arrival.y);
  const auto share = [&](Real survived, Real l) { return still * std::max(Real(0), survived) * death / (death + l); };
  const Real corner = std::min(Real(1), share(std::min(x, y), Real(0)));  // [ledger share]
  const Real inX = std::min(1 - corner, share(x - y, lost.y));
  return {corner, inX, std::min(1 - corner - inX, share(y - x, lost.x))};
}

/// C_still. weight: w / n W; death: u > 0.
template <class Real>
Real stillNoise(Real weight, Real death) {
  return weight / (1 + 1 / std::sqrt(1 + death));  // [ledger still]
}

/// Correlation of the noise of a pixel's taps, in [0, 1]. p: not all zero; walk: of the frames before; death: u > 0;
/// freshShare: F in [0, 1]; still: C_still over the taps' power sum.
template <class Real>
Real tapLikeness(const TapPairs& p, const Walk<Real>& walk, Real death, Real freshShare, Real still) {
  const Real sx = walk.steps.x, sy = walk.steps.y, all = p.all();
  const Real aloneX = walkCorrelation(death, sx), aloneY = walkCorrelation(death, sy);
  const WalkSteps<Real> lost{sx * (1 - aloneX), sy * (1 - aloneY)};
  const Real x = walkCorrelation(death + lost.y, sx * (1 - lost.y));  // [ledger plane], both divided by 1 - l
  const Real y = walkCorrelation(death + lost.x, sy * (1 - lost.x));
  const Real common = p.row * x + p.column * y + p.diagonal * x * y;
  const EdgeShares<Real> edge = edgeShares(walk.arrival, lost, death, still);
  const Real older = std::max(Real(0), 1 - freshShare - edge.all()) * (1 + death) / (1 - all + common);  // o
  const Real alike = std::min(Real(3), older + Real(0.2) * std::max(Real(0), older - 1));
  const Real onEdge = edge.corner * all + edge.x * (p.row + (p.column + p.diagonal) * aloneY) +
                      edge.y * (p.column + (p.row + p.diagonal) * aloneX);
  return std::min(Real(1), (common * alike + onEdge) / all);  // [ledger alike]
}

/// u of a history that keeps d of its weight a frame and has the age sum A and weight W: mostly its decay's, and its
/// age's while it still grows and remembers less than its decay lets it. In [1e-12, 1e6].
template <class Real>
Real deathRate(Real ageSum, Real weight, Real factor) {
  const auto rate = [](Real inverseSurvival) { return inverseSurvival * inverseSurvival - 1; };
  const Real byAge = ageSum > 0 ? rate((ageSum + weight) / ageSum) : Real(1e7);
  const Real byDecay = factor > 0 ? rate(1 / factor) : Real(1e7);
  return std::clamp(Real(0.4) * byAge + Real(0.6) * byDecay, Real(1e-12), Real(1e6));  // [ledger death]
}

}  // namespace twohistory
