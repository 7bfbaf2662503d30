// How far a history is trusted: how it weights a fresh value, and how it forgets.
#pragma once

#include <algorithm>
#include <type_traits>

namespace twohistory {

/// weight(n) = n^e, 0 where n = 0. frames: e = 0 ("unweighted"), samples: e = 1 ("weighted"). custom: Policy::weight.
enum class Weighting { frames, samples, custom };

/// Weight of n > 0 samples, for weightings of one's own; positive and finite. It must not look at what was sampled.
using WeightFunction = double (*)(double n);

/// decay: weight times amount every frame. relativeCap: weight at most amount times the fresh weight (ReSTIR's 20 M).
/// absoluteCap: weight at most amount. none: everything is kept.
enum class Forgetting { decay, relativeCap, absoluteCap, none };

/// amount: decay in [0, 1], or a cap >= 0; unused by none.
struct Policy {
  Weighting weighting = Weighting::frames;
  Forgetting forgetting = Forgetting::decay;
  double amount = 0.95;
  WeightFunction weight = nullptr;  ///< of a custom weighting; only an extension can set it
};

template <class V>
void describe(V& v, Policy& p) {
  v.choice("weighting", p.weighting,
           {{"frames", Weighting::frames}, {"samples", Weighting::samples}, {"custom", Weighting::custom}},
           "weight of a fresh value: 1, its sample count, or what an extension says");
  v.choice("forgetting", p.forgetting,
           {{"decay", Forgetting::decay},
            {"relativeCap", Forgetting::relativeCap},
            {"absoluteCap", Forgetting::absoluteCap},
            {"none", Forgetting::none}},
           "how old values lose weight");
  v("amount", p.amount, "decay a frame in [0, 1], or the cap", 0.0, 1e9);
}

/// A history heavier than so many fresh weights would no longer feel the next (a float stalls at 2^24), so it forgets
/// the rest. A fresh weight below 1 counts as 1: one faint frame must not erase a history.
template <class Real>
inline constexpr Real kHeaviest = std::is_same_v<Real, float> ? Real(0x1p22) : Real(0x1p51);

/// Weight of a fresh value made of n samples, n >= 0.
template <class Real>
Real freshWeight(Weighting weighting, Real n) {
  if (!(n > 0)) return 0;
  return weighting == Weighting::samples ? n : Real(1);
}

template <class Real>
Real freshWeight(const Policy& policy, Real n) {
  if (policy.weighting != Weighting::custom) return freshWeight(policy.weighting, n);
  return n > 0 ? static_cast<Real>(policy.weight(static_cast<double>(n))) : Real(0);
}

/// Factor in [0, 1] by which a history of weight w shrinks before a fresh weight arrives. Caps do not act where
/// fresh = 0: Q times nothing would erase the history.
template <class Real>
Real forgetFactor(Forgetting forgetting, double amount, Real w, Real fresh) {
  const auto capAt = [w](Real cap) { return w > cap ? cap / w : Real(1); };
  Real factor = 1;
  if (forgetting == Forgetting::decay) factor = static_cast<Real>(amount);
  if (forgetting == Forgetting::relativeCap && fresh > 0) factor = capAt(static_cast<Real>(amount) * fresh);
  if (forgetting == Forgetting::absoluteCap && fresh > 0) factor = capAt(static_cast<Real>(amount));
  return fresh > 0 ? std::min(factor, capAt(kHeaviest<Real> * std::max(Real(1), fresh))) : factor;
}

}  // namespace twohistory
