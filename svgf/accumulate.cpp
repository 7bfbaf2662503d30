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

template <int K>
void accumulateColour(const FilterParameters& parameters, const std::array<twohistory::Policy, K>& policies,
                      In<Taps> taps, PlanesView<const float> radiance, FilterState<K>& s) {
  const twohistory::Mean<vec3> mean;
  const LedgerView<K> before = s.ledger[1 - s.now];
  const twohistory::LedgerSink<K> now{s.ledger[s.now], s.frame};
  if constexpr (K == 2) {
    if (parameters.skipTwins && twohistory::canBeTwins(policies)) {
      if (s.twins.empty()) s.twins = s.accumulatedTwins = twohistory::TwinTiles(taps.width, taps.height);
      return twohistory::TwinAccumulation<twohistory::Mean<vec3>, PlanesView<const float>>{
          taps, s.samples, policies, before, now, mean, s.history.views(), radiance, s.accumulated.sinks(), s.walks}
          .run(s.accumulatedTwins);
    }
  }
  twohistory::accumulateInto<K>(taps, s.samples, policies, before, now, mean, s.history.views(), radiance,
                                s.accumulated.sinks(), core::kDefaultTile, s.walks);
}

}  // namespace

template <int K>
FilterState<K>::FilterState(int width, int height)
    : walks(width, height),
      samples(width, height),
      sampleVariance(width, height),
      variance(width, height),
      filteredVariance(width, height),
      luminance(width, height),
      tolerance(width, height) {
  for (auto& image : ledger) image = Image<StoredLedger<K>>(width, height);
  for (auto& image : momentsLedger) image = Image<StoredLedger<1>>(width, height);
  for (auto& image : moments) image = Image<Moments>(width, height);
  history = accumulated = HistoryColours<K>(width, height);
}

template <int K>
std::size_t FilterState<K>::bytes() const {
  std::size_t sum = history.bytes() + accumulated.bytes() + twins.bytes() + accumulatedTwins.bytes();
  for (int i = 0; i < 2; ++i) sum += ledger[i].bytes() + momentsLedger[i].bytes() + moments[i].bytes();
  sum += clamped.bytes() + walks.bytes();
  for (const Image<float>* image : {&samples, &sampleVariance, &variance, &filteredVariance, &luminance, &tolerance})
    sum += image->bytes();
  return sum;
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
double clampFireflies(const FilterParameters& parameters, In<Taps> taps, PlanesView<const float> radiance,
                      PlanesView<const float> albedo, FilterState<K>& s) {
  if (s.clamped.empty()) s.clamped = Planes(taps.width, taps.height);
  const PlanesView<float> out = s.clamped;
  const LedgerView<1> ledgers = s.momentsLedger[1 - s.now];
  const In<Moments> before = s.moments[1 - s.now];
  const twohistory::Policy keep{twohistory::Weighting::frames, twohistory::Forgetting::none, 0};
  const std::int64_t width = taps.width;
  return core::deterministicSum(width * taps.height, [&](std::int64_t i) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    const vec3 colour = radiance.load(x, y);
    const float n = s.samples(x, y), luminance = core::luminance(colour);
    out.store(x, y, colour);
    if (!(n > 0) || !(luminance > 0)) return 0.0;
    const twohistory::Recall<1> recall(taps(x, y), ledgers, taps.width, {keep}, n, s.walks);
    const Moments m = MomentsMerge{}.gather(before, recall.step(0, {x, y}));
    if (m.innovations < parameters.spatialBelow) return 0.0;
    const float deviation = std::sqrt(m.sampleVariance * (1 / n + recall.gathered.covariance(0, 0)));
    const float limit = m.mean + parameters.fireflyClamp * deviation;  // [clamp]
    if (!(luminance > limit)) return 0.0;
    const vec3 kept = limit / luminance * colour;
    out.store(x, y, kept);
    return static_cast<double>(core::luminance((colour - kept) * albedo.load(x, y)));
  });
}

template <int K>
void accumulate(const FilterParameters& parameters, const std::array<twohistory::Policy, K>& policies, In<Taps> taps,
                PlanesView<const float> radiance, FilterState<K>& s) {
  accumulateColour<K>(parameters, policies, taps, radiance, s);
  const twohistory::Policy frames{twohistory::Weighting::frames, twohistory::Forgetting::decay,
                                  parameters.momentsDecay};
  twohistory::accumulateInto<1>(taps, s.samples, {frames}, LedgerView<1>(s.momentsLedger[1 - s.now]),
                                twohistory::LedgerSink<1>{s.momentsLedger[s.now], s.frame}, MomentsMerge{},
                                std::array<In<Moments>, 1>{s.moments[1 - s.now]}, LuminanceOf{radiance},
                                std::array<ImageView<Moments>, 1>{s.moments[s.now]}, core::kDefaultTile, s.walks);
  s.walks.update(taps, s.samples);
}

#define INSTANTIATE(K)                                                                                     \
  template struct FilterState<K>;                                                                          \
  template void accumulate<K>(const FilterParameters&, const std::array<twohistory::Policy, K>&, In<Taps>, \
                              PlanesView<const float>, FilterState<K>&);                                   \
  template double clampFireflies<K>(const FilterParameters&, In<Taps>, PlanesView<const float>,            \
                                    PlanesView<const float>, FilterState<K>&);
INSTANTIATE(1)
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace svgf
