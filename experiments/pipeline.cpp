#include "experiments/pipeline.h"

#include "core/parallel.h"

namespace experiments {
namespace {

using core::In;
using core::Planes;
using core::PlanesView;
using core::vec3;

bool usesGradient(twohistory::BlendMode mode) {
  return mode == twohistory::BlendMode::seed || mode == twohistory::BlendMode::seedSlide;
}

twohistory::GradientParameters gradientParameters(const Variant& v) {
  if (v.blend.mode == twohistory::BlendMode::seed) return {};
  const auto decay = static_cast<float>(v.histories[v.blend.pair[0]].amount);
  return {twohistory::GradientSource::signal, 1 - decay, {}};
}

template <int K>
std::array<twohistory::Policy, K> policiesOf(const Variant& v) {
  std::array<twohistory::Policy, K> policies;
  std::copy_n(v.histories.begin(), K, policies.begin());
  return policies;
}

/// What blend() reads of a filter state. The gradient is empty for blends that have none.
template <int K>
twohistory::Histories<K> historiesOf(const svgf::FilterState<K>& s, const Planes& gradient,
                                     PlanesView<const float> target) {
  return {s.history.views(),  s.ledger[s.now], s.sampleVariance, s.samples,
          s.filteredVariance, gradient,        target,           s.twins.empty() ? nullptr : &s.twins};
}

}  // namespace

View::View(int width, int height) : taps_(width, height) {
  for (Instant& i : instants_) i.gbuffer = core::GBuffer(width, height);
}

void see(const Stage& stage, const ShadeParameters& p, std::uint32_t frame, View& v, PassTimes& t) {
  const Instant* past = v.frames_ > 0 ? &v.now() : nullptr;
  v.now_ = 1 - v.now_;
  ++v.frames_;
  Instant& now = v.instants_[v.now_];
  const Instant& before = v.before();
  timed(t, "pose scene", [&] { stage.pose(frame, past, now); });
  timed(t, "trace G-buffer", [&] { stage.trace(before.pose, p.features, p.tile, now); });
  timed(t, "reproject", [&] {
    if (past)
      twohistory::reproject(now.gbuffer.guide.view(), before.gbuffer.guide.view(), p.reprojection, v.taps_);
    else
      v.taps_.fill({});
  });
}

void shadeLights(const restir::RestirParameters& p, const restir::Frame& f, const Reservoirs& reservoirs,
                 PlanesView<float> check, PlanesView<float> radiance, PassTimes& t) {
  restir::RestirState& s = reservoirs.first;
  timed(t, "draw candidates", [&] { restir::drawCandidates(p, f, s); });
  if (!check.empty()) timed(t, "check samples", [&] { restir::shadeCheckSamples(p, f, s, check); });
  timed(t, "reuse temporally", [&] { restir::reuseTemporally(p, f, s); });
  timed(t, "reuse spatially, shade", [&] { restir::reuseSpatiallyAndShade(p, f, s, radiance); });
  if (reservoirs.second) timed(t, "second history", [&] { reservoirs.second->blendInto(p, f, s, radiance); });
}

void fillAlbedo(In<core::Surface> surfaces, PlanesView<float> out) {
  core::forEachPixel(surfaces.width, surfaces.height, [&](int x, int y) {
    const core::Surface& s = surfaces(x, y);
    out.store(x, y, s.hit() ? core::demodulationAlbedo(s) : vec3(1));
  });
}

ShadeState::ShadeState(const Stage& stage, const ShadeParameters& p, std::uint64_t seed, int width, int height)
    : seed_(seed),
      gaze_(p.gaze),
      foveation_(p.foveation),
      view_(width, height),
      samples_(width, height),
      fovea_(width, height),
      restir_(width, height),
      radiance_(width, height),
      albedo_(width, height),
      check_(p.checkSamples ? width : 0, p.checkSamples ? height : 0) {
  static_cast<void>(stage);
  if (p.restir.second.on) second_.emplace(width, height);
  if (p.diagnostics) diagnostics_.emplace(width, height);
}

Shaded shade(const Stage& stage, const ShadeParameters& p, std::uint32_t frame, ShadeState& s) {
  PassTimes& t = s.times_;
  const int width = s.samples_.width(), height = s.samples_.height();
  timed(t, "place samples", [&] {
    s.gazeNow_ = s.gaze_.at(frame / kFramesPerSecond, width, height);
    s.foveation_.place(s.gazeNow_, s.seed_, frame, s.samples_, s.fovea_);
  });
  see(stage, p, frame, s.view_, t);
  const Instant &now = s.now(), &before = s.before();

  const core::Moment momentNow = now.moment(), momentBefore = before.moment();
  const restir::Frame f{momentNow, momentBefore, s.samples_, s.view_.taps(), s.seed_, p.tile};
  const bool checks = p.checkSamples && p.restir.reuse != restir::Reuse::none;  // else radiance itself is independent
  const PlanesView<float> check = checks ? s.check_.view() : PlanesView<float>{};
  shadeLights(p.restir, f, {s.restir_, s.second_ ? &*s.second_ : nullptr}, check, s.radiance_, t);
  if (s.diagnostics_) timed(t, "diagnostics", [&] { s.diagnostics_->update(p.restir, f, s.restir_); });
  timed(t, "albedo", [&] { fillAlbedo(now.gbuffer.surfaces, s.albedo_); });

  return {s.radiance_,
          s.albedo_,
          now.gbuffer.emission,
          s.restir_.shaded,
          now.gbuffer.guide.view(),
          before.gbuffer.guide.view(),
          check,
          s.view_.taps(),
          s.restir_.confidence,
          s.restir_.effective};
}

namespace {

template <int K>
void filterFrame(const Shaded& frame, const Variant& v, PlanesView<const float> target, svgf::FilterState<K>& s,
                 twohistory::GradientState& gradient, twohistory::Validation& validation, svgf::LevelBuffers& levels,
                 core::ImageView<float> weight, PassTimes& t, PlanesView<float> out) {
  timed(t, "accumulate", [&] { svgf::accumulate<K>(v.filter, policiesOf<K>(v), frame.taps, frame.radiance, s); });
  if (usesGradient(v.blend.mode)) {
    timed(t, "gradient", [&] {
      gradient.fit(frame.guide.width(), frame.guide.height());
      const int first = v.blend.pair[0];
      twohistory::updateGradient<K>(gradientParameters(v), frame.guide, frame.taps, s.samples, s.ledger[1 - s.now],
                                    first, s.history.views()[first], frame.radiance, gradient);
    });
  }
  if (v.blend.validation.on)
    timed(t, "check", [&] {
      svgf::checkBlend<K>(v.blend.validation, policiesOf<K>(v), frame.taps, frame.radiance, frame.check, s, validation);
    });
  timed(t, "variance", [&] { svgf::estimateVariance(v.filter, frame.guide, s); });
  timed(t, "filter (first level)", [&] { svgf::filterHistories(v.filter, frame.guide, s); });
  timed(t, "blend", [&] {
    twohistory::blend<K>(historiesOf(s, gradient.gradient, target), frame.guide, v.blend, validation, levels.free(),
                         {levels.colour[0], levels.variance[0], weight});
  });
  timed(t, "filter (further levels)", [&] {
    const int last = svgf::filterFurther(v.filter, frame.guide, levels);
    remodulate(levels.colour[last], frame, out);
  });
}

std::variant<svgf::FilterState<1>, svgf::FilterState<2>, svgf::FilterState<3>> makeHistories(const Variant& v,
                                                                                             int width, int height) {
  requireConsistent(v);
  if (v.histories.size() == 3) return svgf::FilterState<3>(width, height);
  if (v.histories.size() == 2) return svgf::FilterState<2>(width, height);
  return svgf::FilterState<1>(width, height);
}

/// The counts that a variant is told; samples where a frame knows no others.
In<float> toldCounts(const Shaded& frame, restir::Told told) {
  const In<float> other = told == restir::Told::confidence ? frame.confidence : frame.effective;
  return told == restir::Told::samples || other.empty() ? frame.samples : other;
}

}  // namespace

FilterState::FilterState(const Variant& variant, int width, int height)
    : histories_(makeHistories(variant, width, height)), levels_(width, height), weight_(width, height) {}

std::size_t FilterState::bytes() const {
  const std::size_t histories = std::visit([](const auto& s) { return s.bytes(); }, histories_);
  return histories + gradient_.bytes() + validation_.bytes() + levels_.bytes() + weight_.bytes();
}

void filter(const Shaded& frame, const Variant& variant, PlanesView<const float> target, FilterState& state,
            PlanesView<float> out) {
  std::visit(
      [&](auto& s) {
        state.badPixels_ += svgf::dropBadSamples(frame.radiance, toldCounts(frame, variant.told), s.samples);
        s.swapFrames();
        Shaded input = frame;
        if (variant.filter.fireflyClamp > 0) {
          timed(state.times_, "clamp", [&] {
            state.clampedEnergy_ += svgf::clampFireflies(variant.filter, frame.taps, frame.radiance, frame.albedo, s);
          });
          input.radiance = s.clamped;
        }
        filterFrame(input, variant, target, s, state.gradient_, state.validation_, state.levels_, state.weight_,
                    state.times_, out);
      },
      state.histories_);
}

void remodulate(PlanesView<const float> radiance, const Shaded& frame, PlanesView<float> out) {
  core::forEachPixel(out.width(), out.height(), [&](int x, int y) {
    out.store(x, y, radiance.load(x, y) * frame.albedo.load(x, y) + frame.emission.load(x, y));
  });
}

void demodulate(PlanesView<const float> image, const Shaded& frame, PlanesView<float> out) {
  core::forEachPixel(out.width(), out.height(), [&](int x, int y) {
    const bool surface = frame.guide.id(x, y) != core::kNoId;
    out.store(x, y, surface ? (image.load(x, y) - frame.emission.load(x, y)) / frame.albedo.load(x, y) : vec3(0));
  });
}

}  // namespace experiments
