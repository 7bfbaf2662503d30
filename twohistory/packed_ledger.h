// A ledger in 8, 16 or 26 bytes a pixel for K = 1, 2, 3 (12, 28, 48 as floats): history 0's weight as a float, and
// beside it, in two bytes each, what stays of one magnitude whatever the counts: W_j / W_0, mean ages, covariances.
//
// Two bytes stall: a recursion with decay d moves less than half a step once it is within half a step / (1 - d) of its
// limit, 0.5 % with 11 bits. So what is stored is rounded up or down at random, in proportion (a low-discrepancy
// sequence over frames); powers of two and small whole numbers have a code of their own and are never disturbed.
#pragma once

#include <bit>
#include <cstdint>

#include "core/check.h"
#include "twohistory/ledger.h"

namespace twohistory {

/// Positive numbers in [2^-41, 2^23) with 10 bits of mantissa, and 0. Codes order as the numbers do.
namespace small_float {

inline constexpr int kDropped = 13;                ///< bits of a float's mantissa
inline constexpr std::uint32_t kBase = 86u << 10;  ///< code 0 as the top bits of a float: 2^-41, taken for 0
inline constexpr std::uint16_t kMost = 0xfffe;     ///< 0xffff is free for marks
inline constexpr std::uint32_t kSnap = 8;          ///< floats within so many steps of a code are that code

/// x >= 0. dither in [0, 2^13): rounds up where it exceeds what is missing. Positive numbers stay positive.
inline std::uint16_t pack(float x, std::uint32_t dither) {
  if (!(x > 0)) return 0;
  constexpr std::uint32_t kLast = (1u << kDropped) - 1 - kSnap;
  const std::uint32_t moved = std::bit_cast<std::uint32_t>(x) + std::min(dither, kLast - kSnap) + kSnap;
  const std::uint32_t top = moved >> kDropped;
  return top <= kBase ? std::uint16_t{1} : static_cast<std::uint16_t>(std::min<std::uint32_t>(top - kBase, kMost));
}

inline float unpack(std::uint16_t code) { return code == 0 ? 0.0f : std::bit_cast<float>((code + kBase) << kDropped); }

inline bool isPowerOfTwo(std::uint16_t code) { return code != 0 && (code & 0x3ffu) == 0; }

}  // namespace small_float

/// Offset of a pixel's rounding in a frame, the same for all that the pixel stores, so that histories which are alike
/// stay alike.
inline std::uint32_t ditherOf(std::ptrdiff_t pixel, std::uint32_t frame) {
  return (static_cast<std::uint32_t>(pixel) * 0x9e3779b1u + frame * 0xb55a4f09u) >> (32 - small_float::kDropped);
}

/// Relative rounding error of a stored value below 2^-10, zero on average. Weights below 2^-41 of history 0's and ages
/// of more than 8 million frames saturate.
template <int K>
class PackedLedger {
 public:
  static constexpr bool kKnowsTwins = true;  ///< whether markTwin() and twin() mean anything

  PackedLedger() = default;
  PackedLedger(const Ledger<K>& l, std::uint32_t dither) {
    float reference = l.weight[0];
    if (!(reference > 0))  // relative to the heaviest; the sign says that history 0 is empty
      for (int j = 1; j < K; ++j) reference = std::max(reference, l.weight[j]);
    storeWeight(l.weight[0] > 0 ? reference : -reference);
    const float inverseReference = inverse(reference);
    std::array<float, K> inverses;
    for (int j = 0; j < K; ++j) inverses[j] = inverse(l.weight[j]);
    for (int j = 1; j < K; ++j) half_[kRatio + j - 1] = small_float::pack(l.weight[j] * inverseReference, dither);
    for (int j = 0; j < K; ++j) half_[kAge + j] = small_float::pack(l.ageSum[j] * inverses[j], dither);
    for (int i = 0, g = 0; g < K; ++g)
      for (int h = g; h < K; ++h, ++i)  // two steps: the product of two inverses could overflow
        half_[kCovariance + i] = small_float::pack(l.powerSums[i] * inverses[g] * inverses[h], dither);
  }

  operator Ledger<K>() const {
    Ledger<K> l;
    const float reference = weight();
    l.weight[0] = std::max(0.0f, reference);
    for (int j = 1; j < K; ++j) l.weight[j] = small_float::unpack(half_[kRatio + j - 1]) * std::abs(reference);
    for (int j = 0; j < K; ++j) l.ageSum[j] = small_float::unpack(half_[kAge + j]) * l.weight[j];
    for (int i = 0, g = 0; g < K; ++g)
      for (int h = g; h < K; ++h, ++i)
        l.powerSums[i] =
            small_float::unpack(half_[isTwin() ? kCovariance : kCovariance + i]) * l.weight[g] * l.weight[h];
    return l;
  }

  /// History 0 alone.
  Ledger<1> first() const {
    const float w = std::max(0.0f, weight());
    return {{w}, {small_float::unpack(half_[kAge]) * w}, {small_float::unpack(half_[kCovariance]) * w * w}};
  }

  // Twins: history 1 is history 0 in everything but weight. The mark takes the place of C_11, which is C_00 then.
  bool isTwin() const { return K == 2 && half_[kLast] == kTwin; }
  std::uint16_t ratioCode() const requires(K == 2) { return half_[kRatio]; }
  /// Whether both histories' ages and variances have the same codes, and weights differ by a power of two or are 0.
  bool couldBeTwin() const requires(K == 2) {
    const std::uint16_t v = half_[kCovariance];
    if (half_[kLast] == kTwin) return true;
    if (weight() == 0) return true;
    return weight() > 0 && small_float::isPowerOfTwo(ratioCode()) && half_[kAge] == half_[kAge + 1] &&
           half_[kCovariance + 1] == v && half_[kLast] == v;
  }
  void markTwin() requires(K == 2) { half_[kLast] = kTwin; }
  void unmarkTwin() requires(K == 2) {
    if (isTwin()) half_[kLast] = half_[kCovariance];
  }
  /// A twin from history 0 alone.
  static PackedLedger twin(const Ledger<1>& first, std::uint16_t ratio, std::uint32_t dither) requires(K == 2) {
    PackedLedger p;
    p.storeWeight(first.weight[0]);
    p.half_[kRatio] = ratio;
    const float scale = inverse(first.weight[0]);
    p.half_[kAge] = p.half_[kAge + 1] = small_float::pack(first.ageSum[0] * scale, dither);
    p.half_[kCovariance] = p.half_[kCovariance + 1] = small_float::pack(first.powerSums[0] * scale * scale, dither);
    p.markTwin();
    return p;
  }

 private:
  static constexpr int kPairs = Ledger<K>::kPairs;
  static constexpr int kRatio = 2, kAge = kRatio + K - 1, kCovariance = kAge + K, kLast = kCovariance + kPairs - 1;
  static constexpr std::uint16_t kTwin = 0xffff;

  static float inverse(float w) { return w > 0 ? 1 / w : 0.0f; }
  void storeWeight(float w) {
    const auto bits = std::bit_cast<std::uint32_t>(w);
    half_[0] = static_cast<std::uint16_t>(bits), half_[1] = static_cast<std::uint16_t>(bits >> 16);
  }
  float weight() const { return std::bit_cast<float>(std::uint32_t{half_[0]} | std::uint32_t{half_[1]} << 16); }

  std::array<std::uint16_t, kLast + 1> half_{};
};

/// A ledger as it is, to compare layouts with (core/stored.h). It knows no twins.
template <int K>
class PlainLedger {
 public:
  static constexpr bool kKnowsTwins = false;

  PlainLedger() = default;
  PlainLedger(const Ledger<K>& l, std::uint32_t) : ledger_(l) {}
  operator Ledger<K>() const { return ledger_; }
  Ledger<1> first() const { return {{ledger_.weight[0]}, {ledger_.ageSum[0]}, {ledger_.powerSums[0]}}; }
  bool isTwin() const { return false; }
  bool couldBeTwin() const { return false; }
  std::uint16_t ratioCode() const { return 0; }
  void markTwin() {}
  void unmarkTwin() {}
  static PlainLedger twin(const Ledger<1>&, std::uint16_t, std::uint32_t) {
    CHECK(kKnowsTwins);
    return {};
  }

 private:
  Ledger<K> ledger_;
};

#ifdef TWOFOLD_FLOAT_LEDGERS
template <int K>
using StoredLedger = PlainLedger<K>;
#else
template <int K>
using StoredLedger = PackedLedger<K>;
#endif

/// Reads stored ledgers as ledgers.
template <int K>
struct LedgerView {
  core::In<StoredLedger<K>> packed;

  LedgerView() = default;
  LedgerView(core::In<StoredLedger<K>> image) : packed(image) {}
  LedgerView(const core::Image<StoredLedger<K>>& image) : packed(image) {}

  Ledger<K> operator()(int x, int y) const { return packed(x, y); }
  Ledger<K> at(std::ptrdiff_t i) const { return packed.at(i); }
  int width() const { return packed.width; }
  int height() const { return packed.height; }
};

/// Writes ledgers as they are stored. frame: for the rounding.
template <int K>
struct LedgerSink {
  core::ImageView<StoredLedger<K>> packed;
  std::uint32_t frame = 0;

  std::uint32_t dither(int x, int y) const { return ditherOf(y * packed.pitch + x, frame); }
  void store(int x, int y, const Ledger<K>& l) const { packed(x, y) = StoredLedger<K>(l, dither(x, y)); }
};

}  // namespace twohistory
