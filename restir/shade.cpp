// Spatial reuse and shading: n results a pixel, each with neighbours and a shadow ray of its own, averaged.
#include "restir/direct.h"
#include "restir/kernel.h"
#include "restir/visibility.h"

namespace restir {
namespace {

/// A pixel that is shaded: its target and whatever its results share.
template <LightFeatures F, bool kVisibility>
struct Pixel {
  const RestirParameters& parameters;
  const Frame& frame;
  const RestirState& state;
  core::ivec2 at;
  const Surface& surface;
  Target<F, kVisibility> target;

  core::Rng rng(core::Pass pass, int result) const {
    return {frame.seed, pass, pixelIndex(frame, at.x, at.y), frame.now.frame, static_cast<std::uint32_t>(result)};
  }
};

/// known: the sample has passed a target that includes visibility, so its shadow ray need not be traced again.
template <LightFeatures F, bool kVisibility>
vec3 shadeSample(const Pixel<F, kVisibility>& pixel, const Reservoir& r, bool known = kVisibility) {
  if (!(r.unbiasedWeight > 0)) return vec3(0);
  const Incident in = pixel.target.incident(r.sample);
  const vec3 radiance = r.unbiasedWeight * pixel.target.radiance(in);
  if (!(core::maxComponent(radiance) > 0)) return vec3(0);
  return known || visible(*pixel.frame.now.tracer, pixel.surface, in) ? radiance : vec3(0);
}

/// Resampled importance sampling alone: one batch.
template <LightFeatures F, bool kVisibility>
Reservoir drawBatch(const Pixel<F, kVisibility>& pixel, int result) {
  const Candidates<F> candidates(pixel.target, pixel.surface, *pixel.frame.now.tracer, pixel.parameters.candidates, 1,
                                 pixel.state.lightTiles.of(pixel.at.x, pixel.at.y), pixel.state.lightChoice.get());
  const ReservoirBuilder builder = candidates.draw([&](int) { return pixel.rng(core::Pass::candidates, result); });
  return builder.finish(1, pixel.frame.now.frame);
}

template <class T>
using Sources = InlineVector<Source<T>, kMostNeighbours + 1>;

/// The pixel's reservoir and those of chosen neighbours, each with the target that it had.
template <LightFeatures F, bool kVisibility>
Sources<Target<F, kVisibility>> sourcesOf(const Pixel<F, kVisibility>& pixel, core::Rng& rng) {
  const RestirState& state = pixel.state;
  const Moment& now = pixel.frame.now;
  const Neighbours neighbours = chooseNeighbours(now, pixel.at, pixel.parameters.spatial, rng);
  Sources<Target<F, kVisibility>> sources;
  sources.add(state.now(pixel.at.x, pixel.at.y), pixel.target);
  for (int i = 0; i < neighbours.count; ++i) {
    const Reservoir& r = state.now.view().at(neighbours.pixel[i]);
    const TargetParts parts = partsOf(r, neighbours.pixel[i], now, state.waited.view(), state.past);
    sources.add(r, parts.template target<F, kVisibility>());
  }
  return sources;
}

/// One result of spatial reuse: the pixel's reservoir merged with those of neighbours, and shaded.
template <LightFeatures F, bool kVisibility>
vec3 shadeMerged(const Pixel<F, kVisibility>& pixel, int result) {
  using T = Target<F, kVisibility>;
  const RestirParameters& p = pixel.parameters;
  core::Rng rng = pixel.rng(core::Pass::spatial, result);
  const Sources<T> sources = sourcesOf(pixel, rng);
  const std::uint32_t now = pixel.frame.now.frame;
  if (p.shaded == Shaded::chosen) return shadeSample(pixel, mergeReservoirs<T>(sources, p.mis, now, rng));
  vec3 sum(0);
  forEachMerged<T>(sources, p.mis, [&](const LightSample& y, float weight) {
    sum += shadeSample(pixel, Reservoir{y, weight, 1, now});  // [merge 6]
  });
  return sum;
}

/// Mean of the results. One reservoir without neighbours gives one result, however many samples it stands for.
template <LightFeatures F, bool kVisibility>
vec3 shadePixel(const Pixel<F, kVisibility>& pixel, int batches) {
  const Reuse reuse = pixel.parameters.reuse;
  if (reuse == Reuse::temporal) return shadeSample(pixel, pixel.state.now(pixel.at.x, pixel.at.y));
  vec3 sum(0);
  for (int i = 0; i < batches; ++i)
    sum += reuse == Reuse::none ? shadeSample(pixel, drawBatch(pixel, i), false) : shadeMerged(pixel, i);
  return sum / static_cast<float>(batches);
}

/// A baseline: no reservoir takes part.
vec3 shadeByLights(const Frame& frame, const RestirState& state, const Surface& surface, int samples,
                   std::uint32_t pixel) {
  const core::Rng rng(frame.seed, core::Pass::shade, pixel, frame.now.frame);
  return meanDirect(frame.now, surface, *state.lightChoice, samples, rng);
}

/// [told] for a pixel that was shaded with n samples; 0 for one that was not.
void tellPixel(const RestirParameters& p, float n, RestirState& state, int x, int y) {
  const Ledger<1>& ledger = state.ledgerNow(x, y);
  const bool reuses = p.reuse != Reuse::none;
  const float rho = p.reuse == Reuse::temporal ? 1 : p.sharedVariance;  // temporal: one result, whatever n
  const float fresh = twohistory::freshWeight(p.temporal.policy, n);
  state.confidence(x, y) = n > 0 && reuses ? ledger.weight[0] : n;
  state.effective(x, y) = n > 0 && reuses ? effectiveCount(n, rho, ledger, fresh) : n;
}

/// Radiance of one pixel, and the samples that it stands for.
template <LightFeatures F, bool kVisibility>
void storePixel(const RestirParameters& p, const Frame& frame, RestirState& state, int x, int y,
                PlanesView<float> radiance) {
  const Surface& surface = frame.now.surfaces(x, y);
  const int batches = surface.hit() ? batchesOf(frame.samples(x, y)) : 0;
  vec3 colour(0);
  if (batches > 0) {
    colour = drawsLights(p)
                 ? shadeByLights(frame, state, surface, batches, pixelIndex(frame, x, y))
                 : shadePixel(
                       Pixel<F, kVisibility>{
                           p, frame, state, {x, y}, surface, partsOf(frame, x, y).template target<F, kVisibility>()},
                       batches);
    if (p.demodulate) colour /= core::demodulationAlbedo(surface);
  }
  const bool good = core::isFinite(colour);
  radiance.store(x, y, good ? colour : vec3(0));
  const float n = batches > 0 && good ? frame.samples(x, y) : 0.0f;
  state.shaded(x, y) = n;
  if (p.tellAll) tellPixel(p, n, state, x, y);
}

/// Mean of similar neighbours that have samples, 0 if there are none. Reads only pixels with samples, and is called for
/// those without.
vec3 fillPixel(const Frame& frame, In<float> shaded, PlanesView<const float> radiance, int x, int y) {
  constexpr int kReach = 3;
  const SpatialParameters likeness;
  vec3 sum(0);
  float count = 0;
  for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, shaded.height - 1); ++v)
    for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, shaded.width - 1); ++u) {
      if (!(shaded(u, v) > 0)) continue;
      if (!similar(frame.now.surfaces(x, y), frame.now.surfaces(u, v), frame.now.cameraPosition, likeness)) continue;
      sum += radiance.load(u, v);
      ++count;
    }
  return count > 0 ? sum / count : vec3(0);
}

std::int64_t countBad(const Frame& frame, In<float> shaded) {
  return std::llround(core::deterministicSum(shaded.height, [&](std::int64_t row) {
    const int y = static_cast<int>(row);
    int bad = 0;
    for (int x = 0; x < shaded.width; ++x)
      bad += frame.now.surfaces(x, y).hit() && frame.samples(x, y) > 0 && !(shaded(x, y) > 0);
    return static_cast<double>(bad);
  }));
}

}  // namespace

void shadeCheckSamples(const RestirParameters& p, const Frame& frame, const RestirState& state,
                       PlanesView<float> radiance) {
  const std::uint32_t phase = core::Rng(frame.seed, core::Pass::other, 0, frame.now.frame).below(4);
  withTargetFeatures(p, frame, [&]<LightFeatures F, bool kVisibility>() {
    core::forEachPixel(
        radiance.width(), radiance.height(),
        [&](int x, int y) {
          radiance.store(x, y, vec3(-1));
          const Surface& surface = frame.now.surfaces(x, y);
          if (static_cast<std::uint32_t>((x & 1) + 2 * (y & 1)) != phase || !surface.hit() ||
              !(frame.samples(x, y) > 0))
            return;
          const Pixel<F, kVisibility> pixel{p,      frame,   state,
                                            {x, y}, surface, partsOf(frame, x, y).template target<F, kVisibility>()};
          vec3 colour = shadeSample(pixel, state.fresh(x, y));
          if (p.demodulate) colour /= core::demodulationAlbedo(surface);
          if (core::isFinite(colour)) radiance.store(x, y, colour);
        },
        frame.tile);
  });
}

void reuseSpatiallyAndShade(const RestirParameters& p, const Frame& frame, RestirState& state,
                            PlanesView<float> radiance) {
  if (p.tellAll && state.effective.empty())
    state.confidence = state.effective = Image<float>(radiance.width(), radiance.height());
  withTargetFeatures(p, frame, [&]<LightFeatures F, bool kVisibility>() {
    core::forEachPixel(
        radiance.width(), radiance.height(),
        [&](int x, int y) { storePixel<F, kVisibility>(p, frame, state, x, y, radiance); }, frame.tile);
  });
  core::forEachPixel(
      radiance.width(), radiance.height(),
      [&](int x, int y) {
        if (frame.now.surfaces(x, y).hit() && !(state.shaded(x, y) > 0))
          radiance.store(x, y, fillPixel(frame, state.shaded, radiance, x, y));
      },
      frame.tile);
  state.bad += countBad(frame, state.shaded);
}

}  // namespace restir
