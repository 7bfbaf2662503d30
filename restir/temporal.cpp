// Reservoirs as a history of twohistory: one tap is gathered, and merging is resampling.
#include "restir/kernel.h"
#include "twohistory/history.h"

namespace restir {
namespace {

using twohistory::Step;

/// The remembered value's Merge. Reads only what the previous frame left; writes only the pixel's own waiting surface.
template <LightFeatures F, bool kVisibility>
struct TemporalMerge {
  const RestirParameters& parameters;
  const Frame& frame;
  const RestirState& state;
  core::ImageView<Surface> waited;

  Reservoir gather(In<Reservoir> before, const Step& step) const {
    if (!step.hasHistory()) return {{}, 0, 0, frame.now.frame};
    Reservoir r = before.at(step.taps.pixel[0]);
    r.confidence = step.kept;
    return r;
  }

  Reservoir merge(const Reservoir& old, const Reservoir& fresh, const Step& step) const {
    if (!step.hasHistory()) return fresh;
    const TargetParts then = partsOf(old, step.taps.pixel[0], frame.before, state.waitedBefore.view(), state.past);
    if (!(step.fresh > 0)) {
      waited(step.pixel.x, step.pixel.y) = *then.surface;
      return old;
    }
    const TargetParts now = partsOf(frame, step.pixel.x, step.pixel.y);
    const std::array<Source<Target<F, kVisibility>>, 2> sources{
        {{fresh, now.template target<F, kVisibility>()}, {old, approximate(then, now)}}};
    core::Rng rng(frame.seed, core::Pass::temporal, pixelIndex(frame, step.pixel.x, step.pixel.y), frame.now.frame);
    return mergeReservoirs(std::span<const Source<Target<F, kVisibility>>>(sources), parameters.mis, frame.now.frame,
                           rng);
  }

  Target<F, kVisibility> approximate(TargetParts then, const TargetParts& now) const {
    const TemporalParameters& p = parameters.temporal;
    if (!p.previousSurface) then.surface = now.surface;
    if (!p.previousCamera) then.viewer = now.viewer;
    if (!p.previousLights) then.lights = now.lights;
    if (!p.previousGeometry) then.tracer = now.tracer;
    return then.template target<F, kVisibility>();
  }
};

/// One tap a pixel; none where its reservoir has waited longer than instants are remembered.
void chooseTaps(const TemporalParameters& p, const Frame& frame, RestirState& state) {
  core::forEachPixel(
      frame.samples.width, frame.samples.height,
      [&](int x, int y) {
        core::Rng rng(frame.seed, core::Pass::gather, pixelIndex(frame, x, y), frame.now.frame);
        Taps chosen = twohistory::chooseTap(frame.taps(x, y), p.tap, rng.uniform());
        if (chosen.valid()) {
          const std::uint32_t stamp = state.before.view().at(chosen.pixel[0]).frame;
          if (stamp != frame.before.frame && !state.past.find(stamp)) chosen = {};
        }
        state.taps(x, y) = chosen;
      },
      frame.tile);
}

}  // namespace

void reuseTemporally(const RestirParameters& p, const Frame& frame, RestirState& state) {
  if (p.reuse == Reuse::none) return;
  if (p.reuse == Reuse::spatial)
    state.taps.fill({});
  else
    chooseTaps(p.temporal, frame, state);
  withTargetFeatures(p, frame, [&]<LightFeatures F, bool kVisibility>() {
    const TemporalMerge<F, kVisibility> merge{p, frame, state, state.waited};
    const std::array<In<Reservoir>, 1> before{state.before};
    const std::array<core::ImageView<Reservoir>, 1> now{state.now};
    twohistory::accumulate<1>(state.taps, frame.samples, {p.temporal.policy}, state.ledgerBefore, state.ledgerNow,
                              merge, before, In<Reservoir>(state.fresh), now, frame.tile);
  });
}

}  // namespace restir
