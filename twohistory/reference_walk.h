// What a reference history knows of the noise of neighbours (walk_tiles.h), as a pixel's own history needs it.
//
//   [ledger older]    O = 1 - f / R_00,  q_ij = R_ij / (R_00 - f)
//   [ledger between]  t = (1 - F - O_f) / (O_s - O_f), or at the image's edge (A/W - a_f) / (a_s - a_f), in [0, 1]
//   [ledger young]    u <- u + rate(A/W) - rate(a),  rate(x) = (1 + 1/x)^2 - 1,  a = min(a_f, a_s)
//   [ledger regime]   f_i - f = (f_old - f) D_i^K for two rates i: f_old until K frames ago, f since then
//   [ledger reached]  C_still -> C_still f_T / f_W,  f_T = f + (f_old - f) D^max(0, K - T)
//
// The first: what is older than a frame, and how alike it is. Where counts have changed, the reference that weighs
// frames and that which weighs samples differ, and a history lies between them: by the share F of its noise that is
// fresh, or, where the edge's noise is part of that, by its mean age. The third: a pixel that is younger than its tile,
// of the mean age a, has a shorter walk. The last two: how noisy samples were when they reached the image's edge T
// frames ago or earlier (edge_noise.h), as if counts had jumped once; f_i are means over the past that die at the rate
// i, and f_W is what the history's weight is taken for: f by frames, by samples the mean n, which is f_0 of d for D.
#pragma once

#include "twohistory/edge_noise.h"
#include "twohistory/mixing.h"

namespace twohistory {

/// Death rates u = 1, 1/4, 1/16, 1/64, 1/256 of references: decays of .71, .89, .97, .992 and .998. Others lie between,
/// or are the nearest.
inline constexpr int kReferenceRates = 5;
float referenceRate(int place);

/// References beside a tile: their fresh values weigh 1 (Weighting::frames), or as much as they have samples.
inline constexpr int kReferences = 2;
template <class T>
using OfReferences = std::array<T, kReferences>;

/// What a reference that dies at one rate knows of pixels that lie next to each other.
struct ReferenceNoise {
  /// R_00, R_00 - f; R_10, R_01, R_11. Eight, so that they mix as vectors.
  enum Covariance { kHere, kOlder, kRow, kColumn, kDiagonal, kCovariances = 8 };
  std::array<float, kCovariances> r{};
  float loss = 0;                             ///< R_00 / S
  float meanAge = 0;                          ///< a, in frames
  EdgeWalk<float> alongRow{}, alongColumn{};  ///< of a walk in x or y alone
};

/// The tile's mean noise w^2 / n of a frame's samples, if it has changed once.
struct NoiseRegime {
  float now = 0, old = 0;  ///< f, f_old
  float frames = 0;        ///< K

  /// now: of the last frame; faster, slower: means over a past that dies at two rates D.
  static NoiseRegime of(float now, float faster, float slower, float fasterKept, float slowerKept);
  /// f_T of what is `age` frames old or older and dies to the factor `kept` a frame.
  float meanBefore(float age, float kept) const;
};

/// What lies beside a tile.
struct TileNoise {
  std::array<OfReferences<ReferenceNoise>, kReferenceRates> references{};
  OfReferences<NoiseRegime> regimes{};
};

/// References at a pixel, between the middles of four tiles. Points into WalkTiles until its next update.
class ReferenceWalk {
 public:
  std::array<const TileNoise*, 4> tile;
  std::array<float, 4> part;  ///< of a tile, with sum 1

  /// As of SettledWalk (mixing.h).
  OlderNoise<float> older(const TapPairs& pairs, const Remembered<float>& history, float freshShare) const;
  /// perNoise: w / (n C) of the last frame, 0 where n = 0.
  EdgeNoise<float> edge(const TapPairs& pairs, const Arrival& arrival, const Remembered<float>& history,
                        float perNoise) const;

 private:
  template <class Add>
  void between(float place, const Add& add) const;
  /// Where a history's noise lies on the ladder, in [0, kReferenceRates - 1], and by its age between both references.
  struct Place {
    float rate = 0, samples = 0.5f;
  };
  Place placeOf(const Remembered<float>& history) const;
  NoiseRegime regimeOf(int reference) const;
  OfReferences<float> reachedShare(const Remembered<float>& history, float death, float frames, float perNoise) const;
};

}  // namespace twohistory
