// Findings for people: tables on a terminal, plots and tables in the report.
#pragma once

#include <string>

#include "experiments/efficiency/analysis.h"

namespace experiments::efficiency {

/// Terminal tables: by scene and error, when each method has the target's error; then by number of lights.
std::string overviewText(const EfficiencyConfig& config, const Results& results);
/// The same as HTML, with plots of error against time.
std::string overviewHtml(const EfficiencyConfig& config, const Results& results);

}  // namespace experiments::efficiency
