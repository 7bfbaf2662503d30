// Luminance mean and per-sample variance as one more remembered value.
//
// The variance comes from innovations, never from E[x^2] - E[x]^2 (which loses everything at small noise in float):
//   [moments] d = x - m_prev,  s2 <- s2 + a (d^2 / (1/n + V_prev) - s2),  a = 1 / number of innovations, >= 0.05
// V_prev is the predicted variance of the gathered mean in units of s2 ([ledger 4]).
#pragma once

#include "twohistory/history.h"

namespace svgf {

struct Moments {
  float mean = 0;            ///< luminance
  float sampleVariance = 0;  ///< s2: luminance variance of one sample
  float innovations = 0;     ///< how many differences s2 has seen, at most 1 / 0.05
};

/// The Merge of moments. Fresh values are luminances.
struct MomentsMerge {
  static constexpr float kMostInnovations = 20;  ///< 1 / 0.05

  template <class Before>
  Moments gather(const Before& before, const twohistory::Step& step) const {
    Moments sum;
    for (int k = 0; k < 4; ++k) {
      const float b = step.taps.b[k];
      if (!(b > 0)) continue;
      const Moments& tap = before.at(step.taps.pixel[k]);
      sum.mean += b * tap.mean;
      sum.sampleVariance += b * tap.innovations * tap.sampleVariance;  // as a sum: what has seen none says nothing
      sum.innovations += b * tap.innovations;
    }
    sum.sampleVariance = sum.innovations > 0 ? sum.sampleVariance / sum.innovations : 0;
    return sum;
  }

  Moments merge(const Moments& old, float x, const twohistory::Step& step) const {
    if (!(step.fresh > 0)) return old;
    if (!(step.kept > 0)) return {x, old.sampleVariance, old.innovations};
    const float d = x - old.mean;
    const float count = std::min(old.innovations + 1, kMostInnovations);
    const float sample = d * d / (1 / step.samples + step.varianceBefore);  // [moments]
    return {old.mean + step.alpha() * d, old.sampleVariance + (sample - old.sampleVariance) / count, count};
  }
};

}  // namespace svgf
