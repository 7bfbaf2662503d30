// Merging reservoirs: weights between techniques that can produce the same sample.
//
// Inputs i = 0..k-1 hold a sample y_i, its unbiased contribution weight W_i, a confidence c_i and the target p_i that
// they were resampled for. Input 0 is canonical: the result is resampled for its target.
//   [merge 1]  w_i = m_i(y_i) p_0(y_i) W_i,   y drawn in proportion to w,   W = sum w / p_0(y),   c = sum c_i
//   [merge 2]  constant:  m_i(y) = c_i / sum_j c_j            biased where p_i is 0 and another p_j is not
//   [merge 3]  balance:   m_i(y) = c_i p_i(y) / sum_j c_j p_j(y)
// Sources: Bitterli et al., "Spatiotemporal Reservoir Resampling" (2020), algorithm 4; Lin et al., "Generalized
// Resampled Importance Sampling" (2022), generalised balance heuristic.
#pragma once

#include <span>

#include "restir/reservoir.h"

namespace restir {

enum class Mis { constant, balance };

/// An input of a merge. target: what its reservoir was resampled for; callable with a LightSample.
template <class T>
struct Source {
  Reservoir reservoir;
  T target;
};

template <class T>
float sumConfidence(std::span<const Source<T>> sources) {
  float sum = 0;
  for (const Source<T>& s : sources) sum += s.reservoir.confidence;
  return sum;
}

/// m_i(y) of input i; canonical = p_0(y). Over the inputs whose target can produce y they sum to 1.
template <class T>
float balanceWeight(std::span<const Source<T>> sources, std::size_t i, const LightSample& y, float canonical) {
  float own = 0, sum = 0;
  for (std::size_t j = 0; j < sources.size(); ++j) {
    const float c = sources[j].reservoir.confidence;
    const float term = c > 0 ? c * (j == 0 ? canonical : sources[j].target(y)) : 0.0f;
    sum += term;
    if (i == j) own = term;
  }
  return sum > 0 ? own / sum : 0.0f;  // [merge 3]
}

template <class T>
float misWeight(Mis mis, std::span<const Source<T>> sources, std::size_t i, const LightSample& y, float canonical) {
  if (mis == Mis::balance) return balanceWeight(sources, i, y, canonical);
  return sources[i].reservoir.confidence / sumConfidence(sources);  // [merge 2]
}

/// Resamples the inputs into one reservoir, stamped with `frame`. Null samples keep their confidence. Which inputs
/// there are, and their confidences, must not depend on their samples.
template <class T>
Reservoir mergeReservoirs(std::span<const Source<T>> sources, Mis mis, std::uint32_t frame, core::Rng& rng) {
  ReservoirBuilder builder;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Reservoir& r = sources[i].reservoir;
    if (!(r.unbiasedWeight > 0 && r.confidence > 0)) continue;
    const float target = sources[0].target(r.sample);
    if (!(target > 0)) continue;
    const double m = misWeight(mis, sources, i, r.sample, target);
    builder.add(r.sample, target, m * target * r.unbiasedWeight, rng);  // [merge 1]
  }
  return builder.finish(sumConfidence(sources), frame);
}

}  // namespace restir
