// What the denoiser is told that a frame's radiance stands for. From counts alone, never from samples.
//
// Reuse makes frames repeat each other. A reservoir that forgets to `kept` and gains `fresh` keeps its old sample with
// probability r = kept / (kept + fresh), so neighbouring frames correlate by r, and many frames of steady r hold as
// much as (1 - r) / (1 + r) of them would if they were independent (an AR(1) process):
//   [told 1]  frames: N_eff / N = (1 - r) / (1 + r), which is 1 / (2 Q + 1) under a relative cap Q
// n results that share a part rho of their variance hold less than n:
//   [told 2]  results: n_eff = 1 / (rho + (1 - rho) / n)
// rho is calibrated by tests/statistical/effective_count_test.cpp.
#pragma once

#include "twohistory/ledger.h"

namespace restir {

/// samples: n. confidence: of the reservoir that is shaded, in samples or frames as its policy weighs them. effective:
/// n_eff of independent results, times the share of them that earlier frames did not have.
enum class Told { samples, confidence, effective };

/// [told 1] share of a frame that is new; ledger: the reservoir's after this frame, fresh: what the frame added to it.
inline float newShare(const twohistory::Ledger<1>& ledger, float fresh) {
  const float kept = std::max(0.0f, ledger.weight[0] - fresh), sum = kept + fresh;
  return sum > 0 ? fresh / (2 * kept + fresh) : 1.0f;  // (1 - r) / (1 + r)
}

/// [told 2] n >= 1 results whose errors correlate by rho in [0, 1].
inline float effectiveResults(float n, float rho) { return n > 0 ? 1 / (rho + (1 - rho) / n) : 0.0f; }

}  // namespace restir
