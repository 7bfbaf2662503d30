// The temporal filter: colour histories and moments are carried by the same accumulate() of twohistory.
#include "svgf/svgf.h"
#include "twohistory/mean.h"

namespace svgf {
namespace {

using core::vec3;

/// Luminance of planes, as the moments' fresh value.
struct LuminanceOf {
  PlanesView<const float> planes;
  float load(int x, int y) const { return core::luminance(planes.load(x, y)); }
};

}  // namespace

template <int K>
FilterState<K>::FilterState(int width, int height)
    : samples(width, height),
      sampleVariance(width, height),
      variance(width, height),
      filteredVariance(width, height),
      luminance(width, height),
      tolerance(width, height) {
  for (auto& image : ledger) image = Image<Ledger<K>>(width, height);
  for (auto& image : momentsLedger) image = Image<Ledger<1>>(width, height);
  for (auto& image : moments) image = Image<Moments>(width, height);
  for (int j = 0; j < K; ++j) history[j] = accumulated[j] = Planes(width, height);
}

template <int K>
std::array<PlanesView<const float>, K> FilterState<K>::historyViews() const {
  std::array<PlanesView<const float>, K> views;
  for (int j = 0; j < K; ++j) views[j] = history[j];
  return views;
}

std::int64_t dropBadSamples(PlanesView<const float> radiance, In<float> n, ImageView<float> out) {
  const std::int64_t width = n.width;
  return static_cast<std::int64_t>(core::deterministicSum(width * n.height, [&](std::int64_t i) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    const float count = n(x, y);
    const bool good = std::isfinite(count) && count >= 0 && core::isFinite(radiance.load(x, y));
    out(x, y) = good ? count : 0.0f;
    return good ? 0.0 : 1.0;
  }));
}

template <int K>
void accumulate(const FilterParameters& parameters, const std::array<twohistory::Policy, K>& policies, In<Taps> taps,
                PlanesView<const float> radiance, FilterState<K>& s) {
  std::array<PlanesView<float>, K> now;
  for (int j = 0; j < K; ++j) now[j] = s.accumulated[j];
  twohistory::accumulate<K>(taps, s.samples, policies, s.ledger[1 - s.now], s.ledger[s.now], twohistory::Mean<vec3>{},
                            s.historyViews(), radiance, now);

  const twohistory::Policy frames{twohistory::Weighting::frames, twohistory::Forgetting::decay,
                                  parameters.momentsDecay};
  twohistory::accumulate<1>(taps, s.samples, {frames}, s.momentsLedger[1 - s.now], s.momentsLedger[s.now],
                            MomentsMerge{}, std::array<In<Moments>, 1>{s.moments[1 - s.now]}, LuminanceOf{radiance},
                            std::array<ImageView<Moments>, 1>{s.moments[s.now]});
}

#define INSTANTIATE(K)                                                                                     \
  template struct FilterState<K>;                                                                          \
  template void accumulate<K>(const FilterParameters&, const std::array<twohistory::Policy, K>&, In<Taps>, \
                              PlanesView<const float>, FilterState<K>&);
INSTANTIATE(1)
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace svgf
