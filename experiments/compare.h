// Compares two images on disk.
#pragma once

#include <string>

#include "experiments/metrics.h"
#include "experiments/settings.h"

namespace experiments {

/// Names and values of all metrics, as results and `twofold compare` spell them: relMSE, relMSE_trimmed, SSIM,
/// energy_ratio, MSE, bias, max_error.
std::vector<std::pair<std::string, double>> namedMetrics(const Metrics& metrics);

/// What a metric of namedMetrics is, one sentence for reports; empty for unknown names.
std::string metricMeaning(const std::string& name);

/// Full-frame metrics of two EXR files' colour (of a layer, if one is named) as JSON. Throws core::Error for files that
/// cannot be read, differ in size or hold values that are not finite.
Json compareFiles(const std::string& referenceFile, const std::string& testFile, const std::string& layer = "");

}  // namespace experiments
