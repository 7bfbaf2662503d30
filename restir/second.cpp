// Running the second history of reservoirs, and weighing it against the first.
#include "restir/second.h"

#include "restir/kernel.h"
#include "twohistory/combination.h"

namespace restir {
namespace {

constexpr std::uint64_t kOwnNumbers = 0x3c79ac492ba7b653ull;  // any constant: the second history's random numbers
constexpr int kWindow = 3;                                    // pixels on each side that variances are measured in

/// Sample variances and covariance of two images' luminance over similar surfaces around a pixel, itself left out.
twohistory::PairCovariance<float> measure(const Frame& frame, PlanesView<const float> first,
                                          PlanesView<const float> second, int x, int y) {
  const SpatialParameters likeness;
  const Surface& here = frame.now.surfaces(x, y);
  float count = 0, sum1 = 0, sum2 = 0, sum11 = 0, sum22 = 0, sum12 = 0;
  const float centre1 = core::luminance(first.load(x, y)), centre2 = core::luminance(second.load(x, y));
  for (int v = std::max(y - kWindow, 0); v <= std::min(y + kWindow, first.height() - 1); ++v)
    for (int u = std::max(x - kWindow, 0); u <= std::min(x + kWindow, first.width() - 1); ++u) {
      if ((u == x && v == y) || !(frame.samples(u, v) > 0)) continue;
      if (!similar(here, frame.now.surfaces(u, v), frame.now.cameraPosition, likeness)) continue;
      const float a = core::luminance(first.load(u, v)) - centre1, b = core::luminance(second.load(u, v)) - centre2;
      count += 1, sum1 += a, sum2 += b, sum11 += a * a, sum22 += b * b, sum12 += a * b;
    }
  if (count < 2) return {1, 1, 0};
  return {sum11 - sum1 * sum1 / count, sum22 - sum2 * sum2 / count, sum12 - sum1 * sum2 / count};
}

}  // namespace

SecondHistory::SecondHistory(int width, int height)
    : state_(width, height), weight_(width, height, 1), radiance_(width, height) {}

void SecondHistory::blendInto(const RestirParameters& parameters, const Frame& frame, const RestirState& first,
                              PlanesView<float> radiance) {
  RestirParameters mine = parameters;
  mine.temporal.policy = parameters.second.policy;
  mine.tellAll = false;
  Frame own = frame;
  own.seed = core::mixBits(frame.seed ^ kOwnNumbers);
  shareCandidates(mine, own, first, state_);
  reuseTemporally(mine, own, state_);
  reuseSpatiallyAndShade(mine, own, state_, radiance_);
  if (parameters.second.blend == SecondBlend::counts) weighByCounts(parameters, frame, first);
  if (parameters.second.blend == SecondBlend::measured) weighByMeasurement(frame, radiance);
  if (parameters.second.blend == SecondBlend::mean) weight_.fill(0.5f);
  core::forEachPixel(
      weight_.width(), weight_.height(),
      [&](int x, int y) {
        radiance.store(x, y, core::lerp(radiance_.view().load(x, y), radiance.load(x, y), weight_(x, y)));
      },
      frame.tile);
}

void SecondHistory::weighByCounts(const RestirParameters& p, const Frame& frame, const RestirState& first) {
  if (ledger_.empty()) ledger_ = ledgerBefore_ = Image<Ledger<2>>(weight_.width(), weight_.height());
  std::swap(ledger_, ledgerBefore_);
  const twohistory::Policies<2> policies{p.temporal.policy, p.second.policy};
  core::forEachPixel(
      weight_.width(), weight_.height(),
      [&](int x, int y) {
        const Ledger<2> old =
            twohistory::gather<2, float>(first.taps(x, y), ledgerBefore_, policies, frame.samples(x, y));
        ledger_(x, y) = twohistory::advance(old, policies, frame.samples(x, y));
        weight_(x, y) = twohistory::leastVarianceWeight(twohistory::pairOf(ledger_(x, y), 0, 1));  // [blend opt]
      },
      frame.tile);
}

void SecondHistory::weighByMeasurement(const Frame& frame, PlanesView<const float> first) {
  core::forEachPixel(
      weight_.width(), weight_.height(),
      [&](int x, int y) {
        if (frame.now.surfaces(x, y).hit())
          weight_(x, y) = twohistory::leastVarianceWeight(measure(frame, first, radiance_, x, y));  // [blend opt]
      },
      frame.tile);
}

}  // namespace restir
