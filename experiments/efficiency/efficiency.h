// Error against time of methods that sample direct light, and the time that each needs for equal error.
#pragma once

#include <filesystem>

#include "experiments/efficiency/config.h"
#include "experiments/results.h"

namespace experiments::efficiency {

/// Measures every scene and seed (see measure.h), and writes results.json (with "points", "equal_error" and
/// "by_lights" beside the usual parts), results.csv and report.html into folder, created if need be. Sequences that an
/// interrupted run with the same settings and number of threads finished are not measured again. Throws core::Error.
Results runEfficiency(const EfficiencyConfig& config, const std::filesystem::path& folder);

}  // namespace experiments::efficiency
