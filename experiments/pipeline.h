// One frame, in the order of the paper: shaded once a seed, filtered once a variant.
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "core/foveation.h"
#include "core/gaze.h"
#include "experiments/stage.h"
#include "experiments/stopwatch.h"
#include "experiments/variant.h"
#include "restir/diagnostics.h"
#include "restir/restir.h"
#include "restir/second.h"
#include "twohistory/gradient.h"
#include "twohistory/reprojection.h"

namespace experiments {

struct ShadeParameters {
  core::GazeParameters gaze;
  core::FoveationParameters foveation;
  twohistory::ReprojectionParameters reprojection;
  restir::RestirParameters restir;
  int tile = core::kDefaultTile;  ///< pixels on a side; results do not depend on it
  Features features = Features::automatic;
  bool diagnostics = false;   ///< keep ShadeState::diagnostics(); needs restir.tellAll
  bool checkSamples = false;  ///< shade independent samples too, for variants that check their blend
};

/// What the filter gets to know of a frame; frames that another renderer wrote can fill one too. Views only.
struct Shaded {
  core::PlanesView<const float> radiance;  ///< demodulated: without emission, divided by albedo
  core::PlanesView<const float> albedo, emission;
  core::In<float> samples;  ///< n that the radiance stands for, 0 = nothing new in this pixel
  core::Guide guide, guideBefore;
  core::PlanesView<const float> check;        ///< independent results, negative where there is none; may be empty
  core::In<twohistory::Taps> taps;            ///< where each pixel was in the frame before; none in the first frame
  core::In<float> confidence{}, effective{};  ///< for variants that are told so instead of samples; may be empty
};

/// What is seen of a frame and of the one before, before any light is sampled: poses, surfaces, and where they were.
class View {
 public:
  View(int width, int height);

  const Instant& now() const { return instants_[now_]; }
  /// Equal to now() in the first frame.
  const Instant& before() const { return instants_[frames_ > 1 ? 1 - now_ : now_]; }
  core::In<twohistory::Taps> taps() const { return taps_; }

 private:
  friend void see(const Stage& stage, const ShadeParameters& parameters, std::uint32_t frame, View& view,
                  PassTimes& times);
  int now_ = 0;
  std::int64_t frames_ = 0;
  std::array<Instant, 2> instants_;
  core::Image<twohistory::Taps> taps_;
};

/// Goes on to frame `frame`; frames must come in order, from any first one.
void see(const Stage& stage, const ShadeParameters& parameters, std::uint32_t frame, View& view, PassTimes& times);

/// What sampling light keeps from frame to frame. second: null where there is one history.
struct Reservoirs {
  restir::RestirState& first;
  restir::SecondHistory* second = nullptr;
};

/// The passes that sample light: candidates, reuse, shading. check: gets independent results (see
/// restir::shadeCheckSamples); empty = none are wanted.
void shadeLights(const restir::RestirParameters& parameters, const restir::Frame& frame, const Reservoirs& reservoirs,
                 core::PlanesView<float> check, core::PlanesView<float> radiance, PassTimes& times);

/// Albedo that radiance of a surface is divided by; 1 where there is none.
void fillAlbedo(core::In<core::Surface> surfaces, core::PlanesView<float> out);

/// What shading keeps from frame to frame, for one seed.
class ShadeState {
 public:
  ShadeState(const Stage& stage, const ShadeParameters& parameters, std::uint64_t seed, int width, int height);

  const Instant& now() const { return view_.now(); }
  const Instant& before() const { return view_.before(); }
  core::vec2 gaze() const { return gazeNow_; }
  core::In<std::uint8_t> fovea() const { return fovea_; }
  PassTimes& times() { return times_; }
  std::int64_t badPixels() const { return restir_.badPixels() + (second_ ? second_->badPixels() : 0); }
  /// Null unless asked for.
  const restir::Diagnostics* diagnostics() const { return diagnostics_ ? &*diagnostics_ : nullptr; }

 private:
  friend Shaded shade(const Stage& stage, const ShadeParameters& parameters, std::uint32_t frame, ShadeState& state);
  std::uint64_t seed_;
  core::Gaze gaze_;
  core::Foveation foveation_;
  core::vec2 gazeNow_{0};
  View view_;
  core::Image<float> samples_;
  core::Image<std::uint8_t> fovea_;
  restir::RestirState restir_;
  std::optional<restir::SecondHistory> second_;
  std::optional<restir::Diagnostics> diagnostics_;
  core::Planes radiance_, albedo_, check_;
  PassTimes times_;
};

/// Renders frame `frame`; frames must be shaded in order, from any first one. The views stay valid until the next call.
Shaded shade(const Stage& stage, const ShadeParameters& parameters, std::uint32_t frame, ShadeState& state);

/// Everything that one variant keeps from frame to frame.
class FilterState {
 public:
  FilterState(const Variant& variant, int width, int height);

  PassTimes& times() { return times_; }
  std::int64_t badPixels() const { return badPixels_; }
  /// Weight of the blend's first history in the last frame.
  core::In<float> blendWeight() const { return weight_; }
  /// Luminance that the firefly clamp took away, summed over pixels and frames.
  double clampedEnergy() const { return clampedEnergy_; }
  /// Of everything that is kept or reused between frames.
  std::size_t bytes() const;

 private:
  friend void filter(const Shaded& frame, const Variant& variant, core::PlanesView<const float> target,
                     FilterState& state, core::PlanesView<float> out);
  std::variant<svgf::FilterState<1>, svgf::FilterState<2>, svgf::FilterState<3>> histories_;
  twohistory::GradientState gradient_;
  twohistory::Validation validation_;
  svgf::LevelBuffers levels_;
  core::Image<float> weight_;
  std::int64_t badPixels_ = 0;
  double clampedEnergy_ = 0;
  PassTimes times_;
};

/// Filters one frame into an HDR image. target: demodulated truth for the oracle in frames that have one, else empty.
void filter(const Shaded& frame, const Variant& variant, core::PlanesView<const float> target, FilterState& state,
            core::PlanesView<float> out);

/// out = radiance * albedo + emission.
void remodulate(core::PlanesView<const float> radiance, const Shaded& frame, core::PlanesView<float> out);
/// The inverse, for references: out = (image - emission) / albedo, 0 where there is no surface.
void demodulate(core::PlanesView<const float> image, const Shaded& frame, core::PlanesView<float> out);

}  // namespace experiments
