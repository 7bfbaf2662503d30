// The parts of a report that are numbers: tables, error by frame, time by pass.
#pragma once

#include <string>
#include <vector>

#include "experiments/results.h"

namespace experiments {

/// The limit that reports show but never call best.
inline constexpr const char* kLimitVariant = "oracle";

/// Metrics of rows and series, those of namedMetrics() first.
std::vector<std::string> metricsOf(const Results& results);

/// All metrics of one scene, a table each: variants x regions, mean, interval, ratio to the baseline, best marked.
std::string htmlMetricTables(const Results& results, const std::string& scene);
/// Error by frame of one scene, mean over seeds: one plot a region, for every metric that `series` holds.
std::string htmlFramePlots(const Results& results, const std::string& scene);
/// Milliseconds by pass and variant of one scene: bars and a table.
std::string htmlPassTimes(const Results& results, const std::string& scene);
/// Every setting of the configuration, one a line.
std::string htmlSettings(const Json& config);

}  // namespace experiments
