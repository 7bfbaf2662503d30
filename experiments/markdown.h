// Tables of results as Markdown, for papers and for docs/results.md.
#pragma once

#include <string>
#include <vector>

#include "experiments/results.h"

namespace experiments {

/// What a table shows; empty lists mean all, in the order of the results.
struct MarkdownSelection {
  std::vector<std::string> scenes, metrics, regions, variants;
  std::string baseline;  ///< empty: the results' own
};

/// One table a scene and metric: a line a variant, and for every region the mean over seeds and the paired ratio to the
/// baseline with its 95 % interval. Several scenes with one metric are followed by the geometric mean of their ratios
/// and the worst of them. "border_contrast2" is one table of all scenes instead, a line a scene: the contrast in % with
/// its interval and, where there is "border_noise", the ratio of noise. Throws core::UsageError where the results lack
/// what was asked for.
std::string markdownTables(const Results& results, const MarkdownSelection& selection);

}  // namespace experiments
