// What rows say together: means over seeds and paired ratios to a baseline, with 95 % confidence intervals.
#pragma once

#include <string>
#include <vector>

#include "core/statistics.h"
#include "experiments/results.h"

namespace experiments {

/// Mean over seeds with Student's t interval; low and high are NaN for a single seed. Values that are NaN are left out.
struct Summary {
  std::string scene, variant, region, metric;
  core::Interval value;
};

/// Geometric mean over seeds of variant / baseline, seed by seed, with the t interval of the log ratios. NaN where
/// a value is not positive or no seed has both.
struct Ratio {
  std::string scene, variant, baseline, region, metric;
  core::Interval value;
};

/// In the order of first appearance.
std::vector<Summary> summarise(const std::vector<Row>& rows);
/// Every variant but the baseline; empty if no row has the baseline.
std::vector<Ratio> ratiosTo(const std::vector<Row>& rows, const std::string& baseline);

Json summaryJson(const Summary& summary);
Json ratioJson(const Ratio& ratio);

/// Terminal table of one metric in one scene: a line per variant, a column per region: mean +- half interval, and in
/// parentheses the ratio to the baseline.
std::string summaryTable(const Results& results, const std::string& scene, const std::string& metric);

/// Columns padded to one width; the first left-aligned, the others right-aligned. cells[0] is the heading.
std::string alignedTable(const std::vector<std::vector<std::string>>& cells);

}  // namespace experiments
