// Runs an experiment: scenes x seeds x variants, into results, images and a report.
#pragma once

#include <filesystem>

#include "experiments/config.h"
#include "experiments/results.h"

namespace experiments {

/// Writes results.json, results.csv, report.html and images into folder (created if need be), and returns the results.
/// A sequence (one scene, one seed) that an earlier, interrupted run of the same configuration finished is not rendered
/// again: its part lies in folder/parts under a hash of configuration and scene. Throws core::Error.
Results runExperiment(const Config& config, const std::filesystem::path& folder);

}  // namespace experiments
