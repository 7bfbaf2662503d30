// Merging reservoirs: weights between techniques that can produce the same sample.
//
// Inputs i = 0..k-1 hold a sample y_i, its unbiased contribution weight W_i, a confidence c_i and the target p_i that
// they were resampled for. Input 0 is canonical: the result is resampled for its target.
//   [merge 1]  w_i = m_i(y_i) p_0(y_i) W_i,   y drawn in proportion to w,   W = sum w / p_0(y),   c = sum c_i
//   [merge 2]  constant:      m_i(y) = c_i / sum_j c_j        biased where p_i is 0 and another p_j is not
//   [merge 3]  balance:       m_i(y) = c_i p_i(y) / sum_j c_j p_j(y)                             k^2 targets
//   [merge 4]  contribution:  m_i(y) = c_i / sum_j c_j where p_i(y) > 2^-20 p_0(y), else 0, and then W times
//                             sum_j c_j / Z(y), Z = sum of those c_j
//   [merge 5]  pairwise, with C = sum_j c_j and N = C - c_0, i > 0:                              3 k targets
//                             m_i(y) = c_i / C  N p_i(y) / (c_0 p_0(y) + N p_i(y))
//                             m_0(y) = c_0 / C + sum_i c_i / C  c_0 p_0(y) / (c_0 p_0(y) + N p_i(y))
//   [merge 6]  no choice: sum_i g(y_i) m_i(y_i) W_i, in [merge 4] each term times its own factor: the mean of what
//              [merge 1] chooses from, one evaluation of g an input
// The factor of [merge 4] depends on the chosen sample alone, so E[W g(y)] = sum over y of g(y) sum_i c_i [i counts]
// / Z(y) = sum of g: W is an unbiased contribution weight like any other, and may be merged again. Each unbiased mode
// needs c_0 > 0. The summand c_0 / C makes [merge 5] defensive: the canonical input keeps that share wherever it is.
// Sources: Bitterli et al., "Spatiotemporal Reservoir Resampling" (2020), algorithms 4 and 6; Lin et al., "Generalized
// Resampled Importance Sampling" (2022), generalised balance heuristic and defensive pairwise MIS.
#pragma once

#include <span>

#include "restir/reservoir.h"

namespace restir {

enum class Mis { constant, contribution, balance, pairwise };

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

/// One pair of [merge 5]: the share of input i against the canonical one; others = N.
template <class T>
double pairShare(const Source<T>& canonicalSource, const Source<T>& other, double others, const LightSample& y,
                 float canonical) {
  const double mine = others * other.target(y), its = double{canonicalSource.reservoir.confidence} * canonical;
  return mine + its > 0 ? mine / (mine + its) : 0.0;
}

/// m_i(y) of input i; canonical = p_0(y) > 0.
template <class T>
double pairwiseWeight(std::span<const Source<T>> sources, std::size_t i, const LightSample& y, float canonical) {
  const double sum = sumConfidence(sources), others = sum - sources[0].reservoir.confidence;
  const auto shareOf = [&](const Source<T>& s) { return pairShare(sources[0], s, others, y, canonical); };
  if (i > 0) return sources[i].reservoir.confidence / sum * shareOf(sources[i]);  // [merge 5]
  double weight = sources[0].reservoir.confidence / sum;
  for (std::size_t j = 1; j < sources.size(); ++j)
    if (const double c = sources[j].reservoir.confidence; c > 0) weight += c / sum * (1 - shareOf(sources[j]));
  return weight;
}

/// Whether input i counts for y in [merge 4]. A surface in a lamp's plane has a target of 1e-16 there, by rounding:
/// that says that it can find y, and it never does. Who hardly can is left out, of Z and of the sum; both stay
/// consistent.
template <class T>
bool reaches(std::span<const Source<T>> sources, std::size_t i, const LightSample& y, float canonical) {
  constexpr float kLeast = 0x1p-20f;
  return i == 0 ? canonical > 0 : sources[i].target(y) > kLeast * canonical;  // [merge 4]
}

/// m_i(y); canonical = p_0(y).
template <class T>
double misWeight(Mis mis, std::span<const Source<T>> sources, std::size_t i, const LightSample& y, float canonical) {
  if (mis == Mis::balance) return balanceWeight(sources, i, y, canonical);
  if (mis == Mis::pairwise) return pairwiseWeight(sources, i, y, canonical);
  if (mis == Mis::contribution && !reaches(sources, i, y, canonical)) return 0;
  return sources[i].reservoir.confidence / sumConfidence(sources);  // [merge 2]
}

/// What W of the chosen sample y is multiplied by; canonical = p_0(y) > 0.
template <class T>
double normalisation(Mis mis, std::span<const Source<T>> sources, const LightSample& y, float canonical) {
  if (mis != Mis::contribution) return 1;
  double able = sources[0].reservoir.confidence;
  for (std::size_t j = 1; j < sources.size(); ++j)
    if (const double c = sources[j].reservoir.confidence; c > 0 && reaches(sources, j, y, canonical)) able += c;
  return able > 0 && canonical > 0 ? sumConfidence(sources) / able : 0.0;  // [merge 4]
}

/// Calls body(y_i, p_0(y_i), m_i(y_i) W_i) for every input whose sample the canonical target can use.
template <class T, class Body>
void forEachWeighted(std::span<const Source<T>> sources, Mis mis, Body&& body) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Reservoir& r = sources[i].reservoir;
    if (!(r.unbiasedWeight > 0 && r.confidence > 0)) continue;
    const float target = sources[0].target(r.sample);
    if (target > 0) body(r.sample, target, misWeight(mis, sources, i, r.sample, target) * r.unbiasedWeight);
  }
}

/// Resamples the inputs into one reservoir, stamped with `frame`. Null samples keep their confidence. Which inputs
/// there are, and their confidences, must not depend on their samples.
template <class T>
Reservoir mergeReservoirs(std::span<const Source<T>> sources, Mis mis, std::uint32_t frame, core::Rng& rng) {
  ReservoirBuilder builder;
  forEachWeighted<T>(sources, mis, [&](const LightSample& y, float target, double weight) {
    builder.add(y, target, target * weight, rng);  // [merge 1]
  });
  const double factor = builder.empty() ? 1 : normalisation(mis, sources, builder.sample(), builder.target());
  return builder.finish(sumConfidence(sources), frame, factor);
}

/// The sum of [merge 6] without a choice: calls body(y_i, its unbiased contribution weight) for every input that adds
/// to it. The same rules as for mergeReservoirs.
template <class T, class Body>
void forEachMerged(std::span<const Source<T>> sources, Mis mis, Body&& body) {
  forEachWeighted<T>(sources, mis, [&](const LightSample& y, float target, double weight) {
    const auto w = static_cast<float>(weight * normalisation(mis, sources, y, target));
    if (w > 0 && w < ReservoirBuilder::kLargest) body(y, w);
  });
}

}  // namespace restir
