// How much of a pixel's noise stems from the image's edge, where nothing steps in from beyond, and how alike that is.
// Of what reached the edge T frames ago (arrivals.h) and dies at the rate u = 1 / d^2 - 1
//
//   [ledger share]  E_x = d^2T_x C_still / C V_y at the left or right edge, where walks go up and down alone
//   [ledger still]  C_still = w / n W / (1 + d), the power sum of a history that has never stepped, of constant counts
//
// is left, V being what walking along the edge has made of it (walk_tiles.h). What lies in a row is then one value, in
// a column it is as alike as along the edge; and the same for the upper and lower edge. Derivation: docs/history.md.
#pragma once

#include "twohistory/arrivals.h"
#include "twohistory/mixing.h"

namespace twohistory {

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

/// A walk along an edge, where noise has come to stand still across it.
template <class Real>
struct EdgeWalk {
  Real noise = 0;  ///< V, over that of what never steps
  Real alike = 0;  ///< rho, of neighbours along the edge
};

/// Walks in x and in y alone.
template <class Real>
struct EdgeWalks {
  EdgeWalk<Real> row, column;
};

/// C_still. perWeight: w / n, or a multiple of it; death: u > 0.
template <class Real>
Real stillNoise(Real weight, Real perWeight, Real death) {
  return weight * perWeight / (1 + 1 / std::sqrt(1 + death));  // [ledger still]
}

/// What reached one edge after the other is a corner's since the later of the two. still: C_still / C.
template <class Real>
EdgeShares<Real> edgeShares(const Arrival& arrival, const EdgeWalks<Real>& walks, Real death, Real still) {
  if (arrival.isLongAgo()) return {};
  const Real x = survival(death, arrival.x), y = survival(death, arrival.y);
  const auto share = [&](Real survived, Real noise) { return still * std::max(Real(0), survived) * noise; };
  const Real corner = std::min(Real(1), share(std::min(x, y), Real(1)));  // [ledger share]
  const Real inX = std::min(1 - corner, share(x - y, walks.column.noise));
  return {corner, inX, std::min(1 - corner - inX, share(y - x, walks.row.noise))};
}

/// All of a pixel's edge noise. Parameters as of edgeShares.
template <class Real>
EdgeNoise<Real> edgeNoise(const TapPairs& p, const Arrival& arrival, const EdgeWalks<Real>& walks, Real death,
                          Real still) {
  const EdgeShares<Real> edge = edgeShares(arrival, walks, death, still);
  return {edge.all(), edge.corner * p.all() + edge.x * (p.row + (p.column + p.diagonal) * walks.column.alike) +
                          edge.y * (p.column + (p.row + p.diagonal) * walks.row.alike)};
}

}  // namespace twohistory
