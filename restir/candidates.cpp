// Fresh reservoirs of a whole frame, and the start of a frame for the state.
#include "restir/kernel.h"

namespace restir {
namespace {

bool anyWithoutSamples(In<float> samples) {
  return core::deterministicSum(samples.height, [&](std::int64_t y) {
           const float* row = samples.row(static_cast<int>(y));
           return std::any_of(row, row + samples.width, [](float n) { return !(n > 0); }) ? 1.0 : 0.0;
         }) > 0;
}

/// Older instants stay only while a reservoir may have waited since them.
void beginFrame(const Frame& frame, bool geometry, RestirState& state) {
  std::swap(state.before, state.now);
  std::swap(state.ledgerBefore, state.ledgerNow);
  std::swap(state.waitedBefore, state.waited);
  state.waitsBefore = state.waits;
  state.waits = anyWithoutSamples(frame.samples);
  if (state.waits && state.waited.empty())
    state.waited = state.waitedBefore = Image<Surface>(frame.samples.width, frame.samples.height);
  if (!state.waitsBefore) state.past.forgetBefore(frame.before.frame);
  state.past.remember(frame.now, geometry);
}

template <LightFeatures F>
Reservoir drawPixel(const RestirParameters& p, const Frame& frame, const RestirState& state, int x, int y) {
  const Surface& surface = frame.now.surfaces(x, y);
  const int batches = surface.hit() ? batchesOf(frame.samples(x, y)) : 0;
  ReservoirBuilder builder;
  if (batches > 0) {
    const Target<F> target = partsOf(frame, x, y).target<F>();
    const Candidates<F> candidates(target, surface, *frame.now.tracer, p.candidates, batches, state.lightTiles.of(x, y),
                                   state.lightChoice.get());
    builder = candidates.draw([&](int i) -> core::Rng {
      return {frame.seed, core::Pass::candidates, pixelIndex(frame, x, y), frame.now.frame,
              static_cast<std::uint32_t>(i)};
    });
  }
  const float confidence = twohistory::freshWeight(p.temporal.policy, frame.samples(x, y));
  Reservoir r = builder.finish(confidence, frame.now.frame);
  if (p.targetVisibility && r.unbiasedWeight > 0) {
    const auto in = frame.now.lights->template incident<F>(r.sample, surface.position);
    if (!visible(*frame.now.tracer, surface, in)) r.unbiasedWeight = 0;
  }
  return r;
}

core::LightSampler samplerOf(const RestirParameters& p) {
  if (!drawsLights(p) || p.withoutReuse == WithoutReuse::tree) return core::LightSampler::tree;
  return p.withoutReuse == WithoutReuse::uniform ? core::LightSampler::uniform : core::LightSampler::power;
}

void prepareLightChoice(const RestirParameters& p, const Frame& frame, RestirState& state) {
  if (state.lightChoice && state.drawnLights == frame.now.lights) return;
  state.drawnLights = frame.now.lights;
  state.lightChoice = std::make_shared<core::LightChoice>(*frame.now.lights, samplerOf(p));
}

}  // namespace

RestirState::RestirState(int width, int height)
    : fresh(width, height),
      before(width, height),
      now(width, height),
      ledgerBefore(width, height),
      ledgerNow(width, height),
      taps(width, height),
      shaded(width, height) {}

void shareCandidates(const RestirParameters& p, const Frame& frame, const RestirState& first, RestirState& state) {
  beginFrame(frame, p.targetVisibility, state);
  state.fresh = first.fresh;
}

void drawCandidates(const RestirParameters& p, const Frame& frame, RestirState& state) {
  beginFrame(frame, p.targetVisibility, state);
  if (drawsLights(p) || p.candidates.treeSamples > 0) prepareLightChoice(p, frame, state);
  if (drawsLights(p)) return;
  state.lightTiles.fill(p.candidates.lightTiles, *frame.now.lights, lightFeatures(p, frame),
                        std::int64_t{frame.samples.width} * frame.samples.height * p.candidates.lightSamples,
                        frame.seed, frame.now.frame);
  if (p.reuse == Reuse::none) return;  // shading draws its own, a result at a time
  withLightFeatures(p, frame, [&]<LightFeatures F>() {
    core::forEachPixel(
        frame.samples.width, frame.samples.height,
        [&](int x, int y) { state.fresh(x, y) = drawPixel<F>(p, frame, state, x, y); }, frame.tile);
  });
}

}  // namespace restir
