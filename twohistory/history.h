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
/// Taps that are all empty keep their bilinear weights, so that a value outlives its weight. weightOf(k): W at tap k.
template <class WeightOf>
Taps premultipliedBy(const Taps& taps, const WeightOf& weightOf) {
  const auto product = [&](int k) { return taps.b[k] > 0 ? taps.b[k] * weightOf(k) : 0.0f; };
  const float b0 = product(0), b1 = product(1), b2 = product(2), b3 = product(3), sum = b0 + b1 + b2 + b3;
  if (!(sum > 0)) return taps;
  return {taps.pixel, {b0 / sum, b1 / sum, b2 / sum, b3 / sum}, taps.carried};
}

template <int K, class Ledgers>
Taps premultiplied(const Taps& taps, const Ledgers& before, int j) {
  return premultipliedBy(taps, [&](int k) { return Ledger<K>(before.at(taps.pixel[k])).weight[j]; });
}

/// All that one pixel's histories do in one frame, before any value is touched.
template <int K>
struct Recall {
  Taps taps;
  float samples;
  std::array<Ledger<K>, 4> tap;  ///< what the taps know, read once; only where b > 0
  Ledger<K> gathered, now;
  Advance<K> change;

  /// before: anything whose at(index) is or becomes a Ledger<K>; width: of its image; steps: as for mix (ledger.h).
  template <class Ledgers, class Steps = LikelySteps<float>>
  Recall(const Taps& t, const Ledgers& before, int width, const Policies<K>& policies, float n, const Steps& steps = {})
      : taps(t), samples(n), tap{read(before, 0), read(before, 1), read(before, 2), read(before, 3)} {
    const auto sums = sumTaps<K, float>(Taps{{0, 1, 2, 3}, t.b}, In<Ledger<K>>{tap.data(), 4, 1, 4});
    change = advanceOf(sums.ledger, policies, n, t.carried);
    gathered = mix(sums, t, width, steps, policies, change, n);
    now = advance(gathered, change, n);
  }
  /// In place: a ledger that is unpacked field by field and then copied waits for its stores.
  template <class Ledgers>
  Ledger<K> read(const Ledgers& before, int k) const {
    if (taps.b[k] > 0) return before.at(taps.pixel[k]);
    return {};
  }
  Step step(int j, core::ivec2 pixel) const {
    return {pixel,
            premultipliedBy(taps, [&](int k) { return tap[k].weight[j]; }),
            change.factor[j] * gathered.weight[j],
            change.fresh[j],
            samples,
            gathered.covariance(j, j)};
  }
};

/// Carries K histories of one input through one frame.
///
/// taps: per pixel, into the previous frame. n: sample counts >= 0, 0 = nothing new. before / now: views of the K
/// remembered values (anything with at(index), and store(x, y, value)); fresh: anything with load(x, y). Ledgers
/// likewise: at(index) gives what becomes a Ledger<K>, store(x, y, ledger) takes one. All images have one size and no
/// padding; before and now must not overlap. steps: what past frames' taps were like: a guess, or WalkMemory
/// (walk_memory.h), which makes predicted variances right when motion begins, keeps to a fraction of a pixel, or brings
/// image in.
template <int K, class LedgersBefore, class LedgersNow, class M, class Before, class Fresh, class Now,
          class Steps = LikelySteps<float>>
void accumulateInto(In<Taps> taps, In<float> n, const Policies<K>& policies, const LedgersBefore& ledgersBefore,
                    const LedgersNow& ledgersNow, const M& merge, const std::array<Before, K>& before,
                    const Fresh& fresh, const std::array<Now, K>& now, int tile = core::kDefaultTile,
                    const Steps& steps = {}) {
  core::forEachPixel(
      n.width, n.height,
      [&](int x, int y) {
        const Recall<K> recall(taps(x, y), ledgersBefore, n.width, policies, n(x, y), steps);
        ledgersNow.store(x, y, recall.now);
        for (int j = 0; j < K; ++j) {
          const Step step = recall.step(j, {x, y});
          now[j].store(x, y, merge.merge(merge.gather(before[j], step), fresh.load(x, y), step));
        }
      },
      tile);
}

/// The same with ledgers as they are.
template <int K, class M, class Before, class Fresh, class Now, class Steps = LikelySteps<float>>
void accumulate(In<Taps> taps, In<float> n, const Policies<K>& policies, In<Ledger<K>> ledgerBefore,
                ImageView<Ledger<K>> ledgerNow, const M& merge, const std::array<Before, K>& before, const Fresh& fresh,
                const std::array<Now, K>& now, int tile = core::kDefaultTile, const Steps& steps = {}) {
  CHECK_EQ(ledgerBefore.pitch, ledgerBefore.width);
  accumulateInto<K>(taps, n, policies, ledgerBefore, ledgerNow, merge, before, fresh, now, tile, steps);
}

}  // namespace twohistory
