// Times and errors of all methods on one scene with one seed.
#pragma once

#include <functional>

#include "experiments/efficiency/config.h"
#include "experiments/reference.h"
#include "experiments/sequence.h"

namespace experiments::efficiency {

/// Names of the rows' metrics: wall-clock time a frame of the passes that sample light (median over the frames that
/// count), and errors of the unfiltered image in the full frame (mean over those of them that have a reference).
inline constexpr const char* kTime = "milliseconds";
inline constexpr const char* kErrors[] = {"relMSE_trimmed", "relMSE"};

/// Renders every frame with every method at every count in turn, so that a noisy machine hits all alike. What all
/// share (poses, surfaces, reprojection) is done once a frame and timed under "shared"; the first frame's pose, which
/// builds the structures of lights, under a pass of its own. Methods without memory leave out the warm-up. All methods'
/// reservoirs are in memory together: about 150 bytes a pixel for each method and count.
///
/// Rows: kTime, kErrors and energy_ratio, region "full", the variant named by labelOf. passes: medians of milliseconds.
/// advanced: called with the samples a pixel that were shaded since the last call; may be empty.
SequenceResult measure(const Stage& stage, const EfficiencyConfig& config, const std::string& scene, std::uint64_t seed,
                       References& references, const std::function<void(std::int64_t)>& advanced);

/// Samples a pixel that measure() shades.
std::int64_t workOf(const EfficiencyConfig& config);

}  // namespace experiments::efficiency
