// Where counts have been constant since the reset, a history that weights samples is the one that weights frames: their
// weights differ by a power of two, and every bit of both is the same. Such pixels are twins. They are recognised by
// what is stored, cost what one history costs, and mark their tiles, whose second history filters and blends skip.
#pragma once

#include "twohistory/history.h"
#include "twohistory/history_view.h"
#include "twohistory/packed_ledger.h"
#include "twohistory/walk_memory.h"

namespace twohistory {

/// One flag a tile: every pixel's second history is its first.
class TwinTiles {
 public:
  static constexpr int kSide = 16;  ///< pixels

  TwinTiles() = default;
  TwinTiles(int width, int height) : tiles_((width + kSide - 1) / kSide, (height + kSide - 1) / kSide, 0) {}

  bool empty() const { return tiles_.empty(); }
  std::size_t bytes() const { return tiles_.bytes(); }
  std::uint8_t& of(int x, int y) { return tiles_(x / kSide, y / kSide); }
  bool at(int x, int y) const { return tiles_(x / kSide, y / kSide) != 0; }
  /// Whether all of [x0, x1) x [y0, y1), as far as it lies within the image, are twins.
  bool all(int x0, int y0, int x1, int y1) const {
    for (int j = std::max(y0, 0) / kSide; j <= std::min((y1 - 1) / kSide, tiles_.height() - 1); ++j)
      for (int i = std::max(x0, 0) / kSide; i <= std::min((x1 - 1) / kSide, tiles_.width() - 1); ++i)
        if (!tiles_(i, j)) return false;
    return true;
  }
  /// Narrows [x0, x1) of row y to what is not twins within `reach` pixels; empty (x0 >= x1) where nothing is left.
  void narrow(int y, int reach, int& x0, int& x1) const {
    const int step = kSide;
    while (x0 < x1 && all(x0 - reach, y - reach, std::min(nextTile(x0, step), x1) + reach, y + reach + 1))
      x0 = std::min(nextTile(x0, step), x1);
    while (x0 < x1 && all(lastTile(x1, step) - reach, y - reach, x1 + reach, y + reach + 1))
      x1 = std::max(lastTile(x1, step), x0);
  }

 private:
  static int nextTile(int x, int step) { return (x / step + 1) * step; }
  static int lastTile(int x, int step) { return (x - 1) / step * step; }
  core::Image<std::uint8_t> tiles_;
};

/// Whether the pair can have twins: frames and samples, with one decay that keeps weights far from kHeaviest, in a
/// layout that can mark them.
inline bool canBeTwins(const Policies<2>& p) {
  const auto decays = [](const Policy& q) { return q.forgetting == Forgetting::decay && q.amount <= 0.999; };
  return StoredLedger<2>::kKnowsTwins && p[0].weighting == Weighting::frames && p[1].weighting == Weighting::samples &&
         decays(p[0]) && decays(p[1]) && p[0].amount == p[1].amount;
}

inline constexpr std::uint16_t kNoTwin = 0xffff;  ///< in place of a ratio W_1 / W_0

/// The common ratio of twins under all taps with b > 0, or kNoTwin.
inline std::uint16_t commonRatio(const Taps& taps, In<StoredLedger<2>> before) {
  std::uint16_t ratio = kNoTwin;
  for (int k = 0; k < 4; ++k) {
    if (!(taps.b[k] > 0)) continue;
    const StoredLedger<2>& tap = before.at(taps.pixel[k]);
    if (!tap.isTwin() || (ratio != kNoTwin && tap.ratioCode() != ratio)) return kNoTwin;
    ratio = tap.ratioCode();
  }
  return ratio;
}

/// The same at once where taps without weight agree, too, as they nearly always do.
inline std::uint16_t ratioBefore(const Taps& taps, In<StoredLedger<2>> before) {
  const StoredLedger<2>&a = before.at(taps.pixel[0]), &b = before.at(taps.pixel[1]);
  const StoredLedger<2>&c = before.at(taps.pixel[2]), &d = before.at(taps.pixel[3]);
  const bool alike = a.isTwin() & b.isTwin() & c.isTwin() & d.isTwin() & (a.ratioCode() == b.ratioCode()) &
                     (a.ratioCode() == c.ratioCode()) & (a.ratioCode() == d.ratioCode());
  return alike ? a.ratioCode() : commonRatio(taps, before);
}

/// The ratio of a pixel that stays a twin for certain, or begins as one; else kNoTwin. 0: both histories are empty.
inline std::uint16_t twinRatio(const Taps& taps, In<StoredLedger<2>> before, float n) {
  const std::uint16_t ratio = taps.valid() ? ratioBefore(taps, before) : small_float::pack(n, 0);
  if (ratio == 0 && n == 0) return 0;
  constexpr float kMost = 4096;  // as many as twins were tested with
  const bool stays =
      small_float::isPowerOfTwo(ratio) && ((n == 0) | ((small_float::unpack(ratio) == n) & (n <= kMost)));
  return stays ? ratio : kNoTwin;
}

/// accumulateInto for the slides' pair, with the second history skipped where it is the first.
template <class M, class Fresh>
class TwinAccumulation {
 public:
  In<Taps> taps;
  In<float> n;
  const Policies<2>& policies;
  LedgerView<2> before;
  LedgerSink<2> now;
  const M& merge;
  std::array<HistoryView, 2> valueBefore;
  const Fresh& fresh;
  std::array<HistorySink, 2> valueNow;
  const WalkMemory& walks;

  /// twins: on entry what the planes of valueNow still hold from the last frame, on return what they hold now.
  void run(TwinTiles& twins) const {
    core::forEachTile(
        n.width, n.height,
        [&](int x0, int y0, int x1, int y1) {
          std::uint8_t& flag = twins.of(x0, y0);
          const bool isZero = flag != 0;  // then the differences need no writing
          bool all = true;
          for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) {
              const Taps& t = taps(x, y);
              const float count = n(x, y);
              const std::uint16_t ratio = twinRatio(t, before.packed, count);
              if (ratio == kNoTwin)
                all &= stepBoth(x, y);
              else
                stepTwin(x, y, t, count, ratio, isZero);
            }
          flag = all;
        },
        TwinTiles::kSide);
  }

 private:
  /// History 0 as if it were alone.
  struct First {
    In<StoredLedger<2>> packed;
    Ledger<1> at(std::ptrdiff_t i) const { return packed.at(i).first(); }
  };

  [[gnu::always_inline]] void stepTwin(int x, int y, const Taps& t, float count, std::uint16_t ratio,
                                       bool isZero) const {
    const First first{before.packed};
    const Recall<1> recall(t, first, n.width, {policies[0]}, count, walks);
    now.packed(x, y) = StoredLedger<2>::twin(recall.now, ratio, now.dither(x, y));
    const Step step = recall.step(0, {x, y});
    valueNow[0].store(x, y, merge.merge(merge.gather(valueBefore[0], step), fresh.load(x, y), step));
    if (!isZero) valueNow[1].difference.store(x, y, core::vec3(0));
  }

  /// Returns whether the pixel has become a twin.
  [[gnu::noinline]] bool stepBoth(int x, int y) const {
    const Recall<2> recall(taps(x, y), before, n.width, policies, n(x, y), walks);
    for (int j = 0; j < 2; ++j) {
      const Step step = recall.step(j, {x, y});
      valueNow[j].store(x, y, merge.merge(merge.gather(valueBefore[j], step), fresh.load(x, y), step));
    }
    now.store(x, y, recall.now);
    StoredLedger<2>& ledger = now.packed(x, y);
    const core::vec3 d = valueNow[1].difference.load(x, y);
    const bool twin = d == core::vec3(0) && ledger.couldBeTwin();
    if (twin) ledger.markTwin();
    return twin;
  }
};

}  // namespace twohistory
