// Feeds the check of a blend: this frame's independent samples against the gathered history 0.
#include "svgf/svgf.h"

namespace svgf {
namespace {

using twohistory::Innovation;

/// Independent samples minus what history 0 was before this frame's value joined it, and how much that counts.
template <int K>
struct Innovations {
  const FilterState<K>& state;
  twohistory::Policy policy;  ///< of history 0
  PlanesView<const float> radiance;
  PlanesView<const float> check;

  /// A value of weight w joined a history of weight W - w: before = now + (now - x) w / (W - w).
  Innovation operator()(int x, int y) const {
    const float n = state.samples(x, y);
    const core::vec3 sample = (check.empty() ? radiance : check).load(x, y);
    if (!(n > 0) || !(sample.r >= 0)) return {};
    const Ledger<K> ledger = state.ledgerAt(x, y);
    const float fresh = twohistory::freshWeight(policy, n), kept = ledger.weight[0] - fresh;
    // A history that is nearly all fresh says nothing of what was before it.
    if (!(kept > 0.05f * ledger.weight[0])) return {};
    const core::vec3 shaded = radiance.load(x, y);
    const core::vec3 now = state.accumulated.base.view().load(x, y);
    const core::vec3 before = now + (now - shaded) * (fresh / kept);
    return {sample - before, n / (1 + n * ledger.covariance(0, 0))};
  }
};

}  // namespace

template <int K>
void checkBlend(const twohistory::ValidationParameters& parameters, const std::array<twohistory::Policy, K>& policies,
                In<Taps> taps, PlanesView<const float> radiance, PlanesView<const float> check, const FilterState<K>& s,
                twohistory::Validation& validation) {
  validation.fit(taps.width, taps.height, twohistory::UsualCount(policies));
  validation.update(parameters, taps, Innovations<K>{s, policies[0], radiance, check}, [&](std::ptrdiff_t i, int j) {
    if (j == 0) return s.history.base.view().at(i);
    return j < K ? s.history.difference[j - 1].view().at(i) : core::vec3(0);
  });
}

#define INSTANTIATE(K)                                                                                           \
  template void checkBlend<K>(const twohistory::ValidationParameters&, const std::array<twohistory::Policy, K>&, \
                              In<Taps>, PlanesView<const float>, PlanesView<const float>, const FilterState<K>&, \
                              twohistory::Validation&);
INSTANTIATE(1)
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace svgf
