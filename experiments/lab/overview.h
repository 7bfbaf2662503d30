// The laboratory at a glance: one table, cases by variants, of error over the baseline's; and its aims.
#pragma once

#include <string>

#include "core/statistics.h"
#include "experiments/results.h"

namespace experiments::lab {

/// How a variant does over all cases, in one region.
struct Standing {
  std::string variant;
  double toSeed = 0;       ///< geometric mean over cases of MSE over `seed`'s; NaN where `seed` did not run
  core::Interval bySeeds;  ///< the same seed by seed, 95 %
  double toBaseline = 0;   ///< the same over the baseline's
  double worst = 0;        ///< largest over cases of MSE over the baseline's (mean over seeds)
  std::string worstCase;
};

/// Every variant but the baseline, in the order of the results. region: as in results.
std::vector<Standing> standings(const Results& results, const std::string& region);

/// Tables for a terminal: standings, error over the baseline's by case and region, border steps.
std::string overviewText(const Results& results);
/// The same for the report: tables, and the frontier between boldness and safety as a plot.
std::string overviewHtml(const Results& results);

}  // namespace experiments::lab
