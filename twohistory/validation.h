// Checks a blend against samples that it has not seen, and takes back what it does not keep.
//
// Last frame's blend moved away from history 0 by the sum of shifts delta_j: lambda_j (X_j - X_0) for each further
// history, and a correction q X_0 of the lag that is left, all RGB. Let x be a sample of this frame that is independent
// of all histories, and r = x - gathered X_0. The expected squared error of X_0 + sum theta_j delta_j, but for x's own
// variance, is then the mean of |r - sum theta_j delta_j|^2: its minimum with all theta in [0, 1] needs no truth,
// and no model of noise or drift. With w = n / (1 + n V_0) the precision of r in units of 1 / s2,
//
//   [check theta]  (Q + R) theta = P + R theta_0,   Q_jk = sum w delta_j . delta_k,   P_j = sum w delta_j . r
//
// (dot products as means over channels, so that a change of hue counts) over a tile, its neighbours and recent frames.
// R_jj = (mean of w |r|^2) / tau_j^2 says how firmly theta_0 is believed before there was a check: 1 for histories, 0
// for the correction, which amplifies noise where it is wrong. Sums are kept apart by count regime: where the fovea
// arrives, where it left, and elsewhere.
//
//   [check proven]  theta_0 of a regime's correction = theta_q^4 of all regimes together, tau = agreement
//
// so that a correction that is certain elsewhere makes no step where evidence of a regime is scarce. Histories of which
// none weighs samples do not know what count is usual; all their pixels are of one regime, whose evidence then
// counts twice.
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "core/image.h"
#include "core/parallel.h"
#include "twohistory/ledger.h"

namespace twohistory {

struct ValidationParameters {
  bool on = false;
  float decay = 0.9f;       ///< of the sums, a frame
  float trust = 1;          ///< tau: standard deviation of theta around 1 before any check
  float proof = 0.25f;      ///< tau_c of the correction's theta of all regimes, around 0: it must be proven first
  float agreement = 0.25f;  ///< tau_c of a regime's correction, around what all regimes have proven
  float shared = 1;         ///< how many tiles the whole frame's evidence counts for beside a tile and its neighbours
};

template <class V>
void describe(V& v, ValidationParameters& p) {
  v("on", p.on, "draw the blend back to history 0 where samples that it has not seen contradict it");
  v("decay", p.decay, "of the evidence, a frame", 0.0, 1.0);
  v("trust", p.trust, "standard deviation of the factor around 1 before any evidence", 1e-3, 1e3);
  v("proof", p.proof, "standard deviation of the correction's factor of all regimes around 0 before any evidence", 1e-3,
    1e3);
  v("agreement", p.agreement, "standard deviation of a regime's factor of the correction around what all have proven",
    1e-3, 1e3);
  v("shared", p.shared, "tiles that the whole frame's evidence counts for beside a tile and its neighbours", 0.0, 1e6);
}

/// How a pixel's count compares with those its history was made of: fewer samples, as many, or more.
enum class Regime : std::uint8_t { fewer, equal, more };
inline constexpr int kRegimes = 3;
/// n: this frame's count; usual: the mean count of history.
inline Regime regimeOf(float n, float usual) {
  return n > 1.3f * usual ? Regime::more : (1.3f * n < usual ? Regime::fewer : Regime::equal);
}

/// Mean count that a pixel's histories remember, from one that weighs samples and one that weighs frames.
class UsualCount {
 public:
  UsualCount() = default;
  explicit UsualCount(std::span<const Policy> policies);
  /// n where the histories cannot tell.
  template <int K>
  float operator()(const Ledger<K>& ledger, float n) const {
    const bool known = frames_ >= 0 && samples_ >= 0 && ledger.weight[frames_] > 0;
    return known ? scale_ * ledger.weight[samples_] / ledger.weight[frames_] : n;
  }

 private:
  int frames_ = -1, samples_ = -1;
  float scale_ = 1;  ///< of steady weights 1 / (1 - decay), where the two decay differently
};

/// What one pixel's independent sample says, RGB. weight 0 = nothing.
struct Innovation {
  core::vec3 value{0};
  float weight = 0;
};

inline constexpr int kShifts = 3;                ///< those of histories 1 and 2, then the correction
inline constexpr int kCorrection = kShifts - 1;  ///< index of the latter
inline constexpr int kCompared = kCorrection;    ///< histories beyond the first, at most
using Shifts = std::array<float, kShifts>;
using ColourShifts = std::array<core::vec3, kShifts>;

/// Sums of one tile and regime.
struct Evidence {
  static constexpr int kSquares = kShifts * (kShifts + 1) / 2;
  static constexpr int kSums = kShifts + kSquares + 2;
  using Stored = std::array<float, kSums>;

  std::array<double, kSums> sum{};  ///< P_j; Q_jk for k <= j, row by row; of w |r|^2; of how many

  void add(const Innovation& r, const ColourShifts& shift);
  void accumulate(const Stored& other, double factor);
  Stored stored() const;
  /// [check theta] of all regimes, whose correction must be proven.
  Shifts solve(const ValidationParameters& p) const { return solveWith(p, {0, p.proof}); }
  /// The same of one regime. proven: theta_0 of its correction ([check proven]).
  Shifts solve(const ValidationParameters& p, float proven) const { return solveWith(p, {proven, p.agreement}); }

 private:
  /// theta_0 and tau_c of the correction.
  struct Prior {
    float mean, deviation;
  };
  Shifts solveWith(const ValidationParameters& p, const Prior& correction) const;
};

/// What a blend shifted a pixel by, and in which regime: lambda_j within [-4, 4] and the correction q, in units of X_0,
/// within [-8, 8], as signed squares of 7 and 8 bits, so that small ones are fine: 1 is off by at most 0.032.
class Booked {
 public:
  Booked() = default;
  Booked(Regime regime, const Shifts& shares) {
    for (int j = 0; j < kCompared; ++j) {
      const unsigned bit = static_cast<unsigned>(regime) >> j & 1u;
      code_[j] = static_cast<std::uint8_t>(encode(shares[j], kMostShare, 63) << 1 | bit);
    }
    code_[kCorrection] = static_cast<std::uint8_t>(encode(shares[kCorrection], kMostCorrection, 127));
  }
  Regime regime() const { return static_cast<Regime>((code_[0] & 1u) | (code_[1] & 1u) << 1); }
  /// Both 0 exactly where they were.
  float lambda(int j) const { return decode(static_cast<std::int8_t>(code_[j]) >> 1, kMostShare, 63); }
  float correction() const { return decode(static_cast<std::int8_t>(code_[kCorrection]), kMostCorrection, 127); }

 private:
  static constexpr float kMostShare = 4, kMostCorrection = 8;
  static unsigned encode(float v, float most, float steps) {
    const float root = std::sqrt(std::min(std::abs(v) / most, 1.0f));
    return static_cast<unsigned>(std::lround(std::copysign(steps * root, v)));
  }
  static float decode(int code, float most, float steps) {
    const float root = static_cast<float>(code) / steps;
    return most * root * std::abs(root);
  }

  std::array<std::uint8_t, kShifts> code_{};
};

class Validation {
 public:
  static constexpr int kTile = 16;  ///< pixels on a side

  std::size_t bytes() const { return booked_.bytes() + evidence_.bytes() + keep_.bytes(); }
  /// Makes room; forgets everything if the size is new.
  void fit(int width, int height, const UsualCount& usual);
  /// Reads this frame's independent samples against the last blend's shifts. innovation(x, y).
  /// difference(i, j): X_j - X_0, or X_0 for j = 0, at index i of the frame before, as the last blend saw it.
  template <class InnovationAt, class DifferenceAt>
  void update(const ValidationParameters& p, core::In<Taps> taps, const InnovationAt& innovation,
              const DifferenceAt& difference);
  template <int K>
  Regime regime(const Ledger<K>& ledger, float n) const {
    return regimeOf(n, usual_(ledger, n));
  }
  /// Shares of the shifts to keep at a pixel.
  Shifts keep(int x, int y, Regime regime) const;
  /// Notes what this frame's blend would shift by, before it is drawn back.
  void book(int x, int y, Regime regime, const Shifts& shares) { booked_(x, y) = Booked(regime, shares); }

 private:
  using TileEvidence = std::array<Evidence::Stored, kRegimes>;
  template <class DifferenceAt>
  ColourShifts gathered(const Taps& t, const DifferenceAt& difference) const;
  void solve(const ValidationParameters& p);

  UsualCount usual_;
  core::Image<Booked> booked_;
  core::Image<TileEvidence> evidence_;
  core::Image<std::array<Shifts, kRegimes>> keep_;
};

template <class DifferenceAt>
ColourShifts Validation::gathered(const Taps& t, const DifferenceAt& difference) const {
  ColourShifts delta{};
  for (int k = 0; k < 4; ++k) {
    if (!(t.b[k] > 0)) continue;
    const Booked& booked = booked_.data()[t.pixel[k]];
    for (int j = 0; j < kCompared; ++j)
      if (const float lambda = booked.lambda(j); lambda != 0)
        delta[j] += t.b[k] * lambda * difference(t.pixel[k], j + 1);
    if (const float q = booked.correction(); q != 0) delta[kCorrection] += t.b[k] * q * difference(t.pixel[k], 0);
  }
  return delta;
}

template <class InnovationAt, class DifferenceAt>
void Validation::update(const ValidationParameters& p, core::In<Taps> taps, const InnovationAt& innovation,
                        const DifferenceAt& difference) {
  core::forEachTile(
      taps.width, taps.height,
      [&](int x0, int y0, int x1, int y1) {
        std::array<Evidence, kRegimes> fresh;
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) {
            const Innovation r = innovation(x, y);
            const Taps& t = taps(x, y);
            if (!(r.weight > 0) || !t.valid()) continue;
            const auto c = static_cast<std::size_t>(booked_.data()[t.pixel[strongest(t)]].regime());
            fresh[c].add(r, gathered(t, difference));
          }
        TileEvidence& kept = evidence_(x0 / kTile, y0 / kTile);
        for (int c = 0; c < kRegimes; ++c) {
          fresh[c].accumulate(kept[c], static_cast<double>(p.decay));
          kept[c] = fresh[c].stored();
        }
      },
      kTile);
  solve(p);
}

}  // namespace twohistory
