// What an experiment measured, as written to results.json and results.csv and read back to resume.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/provenance.h"
#include "experiments/settings.h"

namespace experiments {

/// One figure of one sequence of frames. value: NaN (null in JSON) where a region held no pixel.
struct Row {
  std::string scene, variant;
  std::uint64_t seed = 0;
  std::string region, metric;
  double value = 0;
};

/// One figure of one frame.
struct FrameValue {
  std::string scene, variant;
  std::uint64_t seed = 0;
  std::string region, metric;
  int frame = 0;
  double value = 0;
};

/// Mean wall-clock milliseconds of one pass a frame. variant "shared" = paid once for all variants.
struct PassTime {
  std::string scene, variant, pass;
  double ms = 0;
};

struct Results {
  std::vector<Row> rows;
  std::vector<FrameValue> series;
  std::vector<PassTime> passes;
  Json config = Json::object();
  Provenance provenance;
  std::string baseline = "unweighted";  ///< the variant that ratios are against
};

/// Rows that hold the mean over frames of each sequence in `series`, frames without a value left out.
std::vector<Row> meansOverFrames(const std::vector<FrameValue>& series);

/// One row a scene, variant and pass, in the order of first appearance: the median of those given (one a seed, since
/// seeds render the same work).
std::vector<PassTime> medianPasses(const std::vector<PassTime>& passes);

/// Sorts rows and series by scene, variant, seed, region, metric (and frame); names in the order of first appearance
/// in rows, seeds ascending. What is equal in content then gives equal bytes.
void sortCanonically(Results& results);

/// The whole of results.json: rows, summary and ratios (computed, see summary.h), series, passes, config, provenance.
Json resultsJson(const Results& results);
/// Inverse of resultsJson, computed parts ignored. Throws core::Error naming `where` if a part is missing or mistyped.
Results resultsFromJson(const Json& json, const std::string& where);

/// Writes results.json and results.csv into an existing folder, each complete or not at all. Throws core::Error.
void saveResults(const Results& results, const std::filesystem::path& folder);
/// Reads a results.json. Throws core::Error.
Results loadResults(const std::filesystem::path& file);

/// rows as comma-separated values with a header line; fields quoted where needed, numbers with 17 digits.
std::string resultsCsv(const Results& results);

}  // namespace experiments
