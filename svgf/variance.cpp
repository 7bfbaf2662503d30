// How noisy history 0 is: from innovations over time or, where they are few, from the neighbourhood.
#include <atomic>

#include "svgf/svgf.h"

namespace svgf {
namespace {

using core::ivec2;
using core::vec3;

/// Calls body(q, weight) for every pixel of the window around p that lies on the same surface.
template <class Body>
void forEachNeighbour(const FilterParameters& parameters, const Guide& guide, ivec2 p, Body&& body) {
  const int r = parameters.spatialRadius;
  for (int y = std::max(0, p.y - r); y <= std::min(p.y + r, guide.height() - 1); ++y) {
    for (int x = std::max(0, p.x - r); x <= std::min(p.x + r, guide.width() - 1); ++x) {
      const float w = core::edgeWeight(guide, parameters.edges, p, {x, y});
      if (w > 0) body(ivec2(x, y), w);
    }
  }
}

/// s2 from the spread of the neighbours' means: each has variance s2 V, so E sum o (m - mean)^2 / V = s2 sum o less the
/// degree of freedom that the mean takes. 0 where there is only one.
template <int K>
float spatialSampleVariance(const FilterParameters& parameters, const Guide& guide, const FilterState<K>& s, ivec2 p) {
  const auto relativeVariance = [&](ivec2 q) { return Ledger<1>(s.momentsLedger[s.now](q.x, q.y)).covariance(0, 0); };
  float total = 0, totalSquared = 0, mean = 0;
  forEachNeighbour(parameters, guide, p, [&](ivec2 q, float w) {
    const float v = relativeVariance(q);
    if (!(v > 0)) return;
    total += w / v;
    totalSquared += (w / v) * (w / v);
    mean += w / v * s.moments[s.now](q.x, q.y).mean;
  });
  if (!(total > 0)) return 0;
  mean /= total;
  const float count = total * total / totalSquared;
  if (!(count > 1.5f)) return 0;
  float spread = 0, weight = 0;
  forEachNeighbour(parameters, guide, p, [&](ivec2 q, float w) {
    const float v = relativeVariance(q);
    if (!(v > 0)) return;
    const float d = s.moments[s.now](q.x, q.y).mean - mean;
    spread += w * d * d / v;
    weight += w;
  });
  return spread / weight * count / (count - 1);
}

/// The moments outlive any colour policy (decay 0 forgets its weight, not its value), so they know who ever saw a
/// sample.
template <int K>
bool hasSeenSamples(const FilterState<K>& s, ivec2 p) {
  return Ledger<1>(s.momentsLedger[s.now](p.x, p.y)).weight[0] > 0;
}

/// A filled pixel's histories may differ. Pixels of one tile may be filled at a time.
void markFilled(std::uint8_t& flag) { std::atomic_ref(flag).store(0, std::memory_order_relaxed); }

/// Gives a pixel that never saw a sample its neighbours' colours. Reads only pixels that have seen one.
template <int K>
void fillFromNeighbours(const FilterParameters& parameters, const Guide& guide, FilterState<K>& s, ivec2 p) {
  const auto views = s.accumulated.views();
  std::array<vec3, K> sum;
  sum.fill(vec3(0));
  float total = 0;
  forEachNeighbour(parameters, guide, p, [&](ivec2 q, float w) {
    if (!hasSeenSamples(s, q)) return;
    for (int j = 0; j < K; ++j) sum[j] += w * views[j].load(q.x, q.y);
    total += w;
  });
  if (!(total > 0)) return;
  const auto sinks = s.accumulated.sinks();
  for (int j = 0; j < K; ++j) sinks[j].store(p.x, p.y, sum[j] / total);
  if (!s.accumulatedTwins.empty()) markFilled(s.accumulatedTwins.of(p.x, p.y));
}

}  // namespace

template <int K>
void estimateVariance(const FilterParameters& parameters, const Guide& guide, FilterState<K>& s) {
  core::forEachPixel(guide.width(), guide.height(), [&](int x, int y) {
    const Moments& m = s.moments[s.now](x, y);
    const Ledger<1> ledger = s.ledger[s.now](x, y).first();
    if (guide.id(x, y) == core::kNoId) {
      s.sampleVariance(x, y) = s.variance(x, y) = 0;
      return;
    }
    const bool few = m.innovations < parameters.spatialBelow;
    const float s2 = few ? spatialSampleVariance(parameters, guide, s, {x, y}) : m.sampleVariance;
    s.sampleVariance(x, y) = s2;
    s.variance(x, y) = s2 * (ledger.weight[0] > 0 ? ledger.covariance(0, 0) : 1.0f);  // [ledger 4]
    if (!hasSeenSamples(s, {x, y})) fillFromNeighbours(parameters, guide, s, {x, y});
  });
}

template void estimateVariance(const FilterParameters&, const Guide&, FilterState<1>&);
template void estimateVariance(const FilterParameters&, const Guide&, FilterState<2>&);
template void estimateVariance(const FilterParameters&, const Guide&, FilterState<3>&);

}  // namespace svgf
