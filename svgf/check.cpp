// Feeds the check of a blend: this frame's independent samples against the gathered history 0.
#include "svgf/svgf.h"

namespace svgf {
namespace {

using twohistory::Innovation;

/// What history 0 was before this frame's value joined it, in luminance, and how much that counts.
template <int K>
struct Innovations {
  const FilterState<K>& state;
  twohistory::Policy policy;  ///< of history 0
  PlanesView<const float> radiance;
  In<float> check;

  /// A value of weight w joined a history of weight W - w: before = now + (now - x) w / (W - w).
  Innovation operator()(int x, int y) const {
    const float n = state.samples(x, y);
    const Ledger<K> ledger = state.ledgerAt(x, y);
    const float fresh = twohistory::freshWeight(policy, n), kept = ledger.weight[0] - fresh;
    const float sample = check.empty() ? core::luminance(radiance.load(x, y)) : check(x, y);
    // A history that is nearly all fresh says nothing of what was before it.
    if (!(n > 0) || !(sample >= 0) || !(kept > 0.05f * ledger.weight[0])) return {};
    const float now = core::luminance(state.accumulated.base.view().load(x, y));
    const float before = now + (now - core::luminance(radiance.load(x, y))) * fresh / kept;
    return {sample - before, n / (1 + n * ledger.covariance(0, 0))};
  }
};

}  // namespace

template <int K>
void checkBlend(const twohistory::ValidationParameters& parameters, const std::array<twohistory::Policy, K>& policies,
                In<Taps> taps, PlanesView<const float> radiance, In<float> check, const FilterState<K>& s,
                twohistory::Validation& validation) {
  validation.fit(taps.width, taps.height, twohistory::UsualCount(policies));
  validation.update(parameters, taps, Innovations<K>{s, policies[0], radiance, check}, [&](std::ptrdiff_t i, int j) {
    if (j == 0) return core::luminance(s.history.base.view().at(i));
    return j < K ? core::luminance(s.history.difference[j - 1].view().at(i)) : 0.0f;
  });
}

#define INSTANTIATE(K)                                                                                           \
  template void checkBlend<K>(const twohistory::ValidationParameters&, const std::array<twohistory::Policy, K>&, \
                              In<Taps>, PlanesView<const float>, In<float>, const FilterState<K>&,               \
                              twohistory::Validation&);
INSTANTIATE(1)
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace svgf
