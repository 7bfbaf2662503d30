// Checks a blend against samples that it has not seen, and takes back what it does not keep.
//
// Last frame's blend moved away from history 0 by the sum of shifts delta_j = lambda_j lum(X_j - X_0). Let x be a
// sample of this frame that is independent of all histories, and r = x - lum(gathered X_0). The expected squared error
// of X_0 + sum theta_j delta_j, but for x's own variance, is then the mean of (r - sum theta_j delta_j)^2: its minimum
// needs no truth, and no model of noise or drift. With w = n / (1 + n V_0) the precision of r in units of 1 / s2,
//
//   [check theta]  (Q + R) theta = P + R 1,   Q_jk = sum w delta_j delta_k,   P_j = sum w delta_j r
//
// over a tile, its neighbours and recent frames. R = (mean of w r^2) / tau^2 says how firmly the blend is believed
// before it was checked. Sums are kept apart by count regime: where the fovea arrives, where it left, and elsewhere.
#pragma once

#include <array>
#include <cmath>

#include "core/image.h"
#include "core/parallel.h"
#include "twohistory/ledger.h"

namespace twohistory {

struct ValidationParameters {
  bool on = false;
  float decay = 0.9f;   ///< of the sums, a frame
  float trust = 1;      ///< tau: standard deviation of theta around 1 before any check
  float shared = 0.1f;  ///< weight of the whole frame's evidence beside a tile's
};

template <class V>
void describe(V& v, ValidationParameters& p) {
  v("on", p.on, "draw the blend back to history 0 where samples that it has not seen contradict it");
  v("decay", p.decay, "of the evidence, a frame", 0.0, 1.0);
  v("trust", p.trust, "standard deviation of the factor around 1 before any evidence", 1e-3, 1e3);
  v("shared", p.shared, "weight of the whole frame's evidence beside a tile's own", 0.0, 1e6);
}

/// How a pixel's count compares with those its history was made of: fewer samples, as many, or more.
enum class Regime : std::uint8_t { fewer, equal, more };
inline constexpr int kRegimes = 3;
/// n: this frame's count; usual: the mean count of history.
inline Regime regimeOf(float n, float usual) {
  return n > 1.3f * usual ? Regime::more : (1.3f * n < usual ? Regime::fewer : Regime::equal);
}

/// Mean count that a pixel's histories remember, from one that weighs samples and one that weighs frames.
template <int K>
class UsualCount {
 public:
  explicit UsualCount(const Policies<K>& policies);
  /// n where the histories cannot tell.
  float operator()(const Ledger<K>& ledger, float n) const {
    const bool known = frames_ >= 0 && samples_ >= 0 && ledger.weight[frames_] > 0;
    return known ? scale_ * ledger.weight[samples_] / ledger.weight[frames_] : n;
  }

 private:
  int frames_ = -1, samples_ = -1;
  float scale_ = 1;  ///< of steady weights 1 / (1 - decay), where the two decay differently
};

/// What one pixel's independent sample says. weight 0 = nothing.
struct Innovation {
  float value = 0, weight = 0;
};

inline constexpr int kShifts = 2;  ///< histories beyond the first, at most
using Shifts = std::array<float, kShifts>;

/// Sums of one tile and regime.
struct Evidence {
  std::array<double, kShifts> product{};  ///< P
  std::array<double, 3> square{};         ///< Q_00, Q_01, Q_11
  double residual = 0, count = 0;         ///< sum w r^2, and of how many

  void add(const Innovation& r, const Shifts& shift);
  void accumulate(const Evidence& other, double factor = 1);
  /// [check theta]
  Shifts solve(const ValidationParameters& p) const;
};

class Validation {
 public:
  static constexpr int kTile = 16;  ///< pixels on a side

  std::size_t bytes() const { return share_.bytes() + regime_.bytes() + evidence_.bytes() + keep_.bytes(); }
  /// Makes room; forgets everything if the size is new.
  void fit(int width, int height);
  /// Reads this frame's independent samples against the last blend's shifts. innovation(x, y); regime(x, y).
  /// difference(i, j): lum(X_j - X_0), j >= 1, at index i of the frame before, as the last blend saw it.
  template <class InnovationAt, class RegimeAt, class DifferenceAt>
  void update(const ValidationParameters& p, core::In<Taps> taps, const InnovationAt& innovation,
              const RegimeAt& regime, const DifferenceAt& difference);
  Regime regime(int x, int y) const { return regime_(x, y); }
  /// Shares of the shifts to keep at a pixel.
  Shifts keep(int x, int y, Regime regime) const;
  /// lambda_j of this frame's blend for j >= 1, before it is drawn back; kept to 1 / 64 within [-4, 4].
  void storeShares(int x, int y, const Shifts& lambda) {
    for (int j = 0; j < kShifts; ++j) share_(x, y)[j] = packShare(lambda[j]);
  }

 private:
  using TileEvidence = std::array<Evidence, kRegimes>;
  using Shares = std::array<std::int8_t, kShifts>;
  static constexpr float kShareSteps = 32;
  static std::int8_t packShare(float lambda) {
    return static_cast<std::int8_t>(std::lround(std::clamp(lambda * kShareSteps, -127.0f, 127.0f)));
  }
  template <class DifferenceAt>
  Shifts gathered(const Taps& t, const DifferenceAt& difference) const;
  void solve(const ValidationParameters& p);

  core::Image<Shares> share_;
  core::Image<Regime> regime_;
  core::Image<TileEvidence> evidence_;
  core::Image<std::array<Shifts, kRegimes>> keep_;
};

template <int K>
UsualCount<K>::UsualCount(const Policies<K>& policies) {
  for (int j = 0; j < K; ++j) {
    if (policies[j].forgetting != Forgetting::decay || !(policies[j].amount < 1)) continue;
    int& slot = policies[j].weighting == Weighting::frames ? frames_ : samples_;
    if (slot < 0) slot = j;
  }
  if (frames_ >= 0 && samples_ >= 0)
    scale_ = static_cast<float>((1 - policies[samples_].amount) / (1 - policies[frames_].amount));
}

template <class DifferenceAt>
Shifts Validation::gathered(const Taps& t, const DifferenceAt& difference) const {
  Shifts delta{};
  for (int k = 0; k < 4; ++k) {
    if (!(t.b[k] > 0)) continue;
    const Shares& share = share_.data()[t.pixel[k]];
    for (int j = 0; j < kShifts; ++j)
      if (share[j] != 0) delta[j] += t.b[k] * (share[j] / kShareSteps) * difference(t.pixel[k], j + 1);
  }
  return delta;
}

template <class InnovationAt, class RegimeAt, class DifferenceAt>
void Validation::update(const ValidationParameters& p, core::In<Taps> taps, const InnovationAt& innovation,
                        const RegimeAt& regime, const DifferenceAt& difference) {
  core::forEachTile(
      taps.width, taps.height,
      [&](int x0, int y0, int x1, int y1) {
        TileEvidence fresh;
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) {
            regime_(x, y) = regime(x, y);
            const Innovation r = innovation(x, y);
            if (r.weight > 0 && taps(x, y).valid())
              fresh[static_cast<std::size_t>(regime_(x, y))].add(r, gathered(taps(x, y), difference));
          }
        TileEvidence& kept = evidence_(x0 / kTile, y0 / kTile);
        for (int c = 0; c < kRegimes; ++c) {
          fresh[c].accumulate(kept[c], static_cast<double>(p.decay));
          kept[c] = fresh[c];
        }
      },
      kTile);
  solve(p);
}

}  // namespace twohistory
