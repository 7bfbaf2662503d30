// What the denoiser is told that a frame's radiance stands for. From counts alone, never from samples.
//
// Reuse makes samples share what they found. A result that is shaded after spatial reuse owes a part rho of its
// variance to its pixel's reservoir, which all n results of the frame share, and the rest to neighbours of its own. A
// reservoir that forgets to weight `kept` and gains `fresh` keeps its sample with probability r = kept / (kept +
// fresh), so its part of the variance correlates by r from frame to frame, by r^k after k frames (an AR(1) process).
// The mean of many frames then has the variance of as many independent frames of
//   [told] n_eff = 1 / (rho (1 + 2 kept / fresh) + (1 - rho) / n)
// samples. Without spatial reuse rho = 1, and a relative cap Q repeats itself for 2 Q + 1 frames; without any reuse
// rho = 0 and n_eff = n. tests/statistical/effective_count_test.cpp calibrates rho and holds the formula to chains.
#pragma once

#include "twohistory/ledger.h"

namespace restir {

/// samples: n. confidence: of the reservoir that is shaded, in what its policy weighs. effective: [told].
enum class Told { samples, confidence, effective };

/// [told] ledger: the reservoir's after this frame; fresh: what the frame added to it; rho in [0, 1]. 0 where n = 0.
inline float effectiveCount(float n, float rho, const twohistory::Ledger<1>& ledger, float fresh) {
  if (!(n > 0 && fresh > 0)) return 0;
  const float kept = std::max(0.0f, ledger.weight[0] - fresh);
  return 1 / (rho * (1 + 2 * kept / fresh) + (1 - rho) / n);  // [told]
}

}  // namespace restir
