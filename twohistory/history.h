// The abstraction: every frame a history forgets a little, gathers what it knows at the reprojected position, and
// merges the fresh value. What is remembered (a colour, moments, a reservoir) is one type and one Merge; how far it is
// trusted is a Policy; the counts live in a Ledger. One accumulate() serves all.
//
//   w(t)     = forget(gather(w(t-1))) + weight(n(t))
//   value(t) = merge(gathered value, forgotten w, fresh value, weight(n))
#pragma once

#include <array>
#include <concepts>

#include "core/image.h"
#include "core/parallel.h"
#include "twohistory/ledger.h"

namespace twohistory {

using core::ImageView;
using core::In;

/// One pixel's step of one history: what a Merge may know besides the values.
struct Step {
  core::ivec2 pixel{0};
  Taps taps;                 ///< b premultiplied by the taps' weights and renormalised: values mix as means with these
  float kept = 0;            ///< weight of the history after forgetting
  float fresh = 0;           ///< weight(n) of the fresh value; 0 = nothing new, the value stays
  float samples = 0;         ///< n
  float varianceBefore = 0;  ///< predicted variance of the gathered value, in units of one sample's

  bool hasHistory() const { return taps.valid(); }
  /// Share of the fresh value in the merged one.
  float alpha() const { return kept + fresh > 0 ? fresh / (kept + fresh) : 0.0f; }
};

/// A remembered value: how taps are gathered and how a fresh value joins. Before is anything with at(index).
template <class M, class Before, class Value, class Fresh>
concept Merge = requires(const M& m, const Before& before, const Value& old, const Fresh& fresh, const Step& step) {
  { m.gather(before, step) } -> std::convertible_to<Value>;
  { m.merge(old, fresh, step) } -> std::convertible_to<Value>;
};

/// Premultiplied tap weights b_k W_k / sum b W: means whose weights differ mix in proportion to what they stand for.
/// Taps that are all empty keep their bilinear weights, so that a value outlives its weight.
template <int K>
Taps premultiplied(const Taps& taps, In<Ledger<K>> before, int j) {
  Taps result = taps;
  float sum = 0;
  for (int k = 0; k < 4; ++k)
    if (taps.b[k] > 0) sum += result.b[k] = taps.b[k] * before.at(taps.pixel[k]).weight[j];
  if (!(sum > 0)) return taps;
  for (float& b : result.b) b /= sum;
  return result;
}

/// All that one pixel's histories do in one frame, before any value is touched.
template <int K>
struct Recall {
  Ledger<K> gathered, now;
  Advance<K> change;

  Recall(const Taps& taps, In<Ledger<K>> before, const Policies<K>& policies, float n)
      : gathered(gather<K, float>(taps, before)), change(advanceOf(gathered, policies, n)) {
    now = advance(gathered, change, n);
  }
  Step step(int j, core::ivec2 pixel, const Taps& taps, In<Ledger<K>> before, float n) const {
    return {pixel, premultiplied(taps, before, j), change.factor[j] * gathered.weight[j], change.fresh[j],
            n,     gathered.covariance(j, j)};
  }
};

/// Carries K histories of one input through one frame.
///
/// taps: per pixel, into the previous frame. n: sample counts >= 0, 0 = nothing new. before / now: views of the K
/// remembered values (anything with at(index), and store(x, y, value)); fresh: anything with load(x, y). All images
/// have one size and no padding; before and now must not overlap.
template <int K, class M, class Before, class Fresh, class Now>
void accumulate(In<Taps> taps, In<float> n, const Policies<K>& policies, In<Ledger<K>> ledgerBefore,
                ImageView<Ledger<K>> ledgerNow, const M& merge, const std::array<Before, K>& before, const Fresh& fresh,
                const std::array<Now, K>& now, int tile = core::kDefaultTile) {
  CHECK_EQ(ledgerBefore.pitch, ledgerBefore.width);
  core::forEachPixel(
      n.width, n.height,
      [&](int x, int y) {
        const Taps& t = taps(x, y);
        const float samples = n(x, y);
        const Recall<K> recall(t, ledgerBefore, policies, samples);
        ledgerNow(x, y) = recall.now;
        for (int j = 0; j < K; ++j) {
          const Step step = recall.step(j, {x, y}, t, ledgerBefore, samples);
          now[j].store(x, y, merge.merge(merge.gather(before[j], step), fresh.load(x, y), step));
        }
      },
      tile);
}

}  // namespace twohistory
