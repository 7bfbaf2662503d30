// One sequence: all frames of one scene with one seed, shaded once and filtered by every variant, measured on the way.
#pragma once

#include <functional>

#include "experiments/border.h"
#include "experiments/config.h"
#include "experiments/metrics.h"
#include "experiments/reference.h"
#include "experiments/regions.h"
#include "experiments/results.h"

namespace experiments {

/// One variant's image of one frame, handed to whoever writes pictures. Views last for the call only.
struct FrameImage {
  int frame;
  const std::string& variant;  ///< "raw" = unfiltered
  core::PlanesView<const float> image;
  const Comparison* comparison;  ///< against the reference; null in frames without one
  core::vec2 gaze;               ///< pixels
};

struct SequenceHooks {
  std::function<void(const FrameImage&)> image;  ///< called for the frames in config.output.frames; may be empty
  /// Called for the same frames where the configuration asks for diagnostics; may be empty.
  std::function<void(int frame, const restir::Diagnostics&)> diagnostics;
  std::function<void()> frameDone;  ///< for progress; may be empty
};

/// What a sequence measured. Series: relMSE, SSIM and energy ratio by frame, variant and region; rows: sums over all
/// frames that have no per-frame value (energy_over_raw, clamped_energy, bytes_per_pixel, border_step, border_noise).
/// The variant "raw" is the unfiltered frame.
struct SequenceResult {
  std::vector<Row> rows;
  std::vector<FrameValue> series;
  std::vector<BorderContrasts> borders;
  std::vector<PassTime> passes;  ///< mean milliseconds a frame, the first frame left out (it has no history)
  std::int64_t badPixels = 0;    ///< pixels whose radiance was not finite
};

SequenceResult runSequence(const Stage& stage, const Config& config, const std::vector<Variant>& variants,
                           const std::string& scene, std::uint64_t seed, References& references,
                           const SequenceHooks& hooks);

}  // namespace experiments
