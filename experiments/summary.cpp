#include "experiments/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "experiments/json_text.h"
#include "experiments/names.h"

namespace experiments {

namespace {

/// Values that share (scene, variant, region, metric), by seed.
struct Group {
  std::string scene, variant, region, metric;
  std::map<std::uint64_t, double> bySeed;
};
using GroupKey = std::tuple<std::string, std::string, std::string, std::string>;

class Groups {
 public:
  explicit Groups(const std::vector<Row>& rows) {
    for (const Row& r : rows) {
      const auto [at, isNew] = index_.try_emplace({r.scene, r.variant, r.region, r.metric}, groups_.size());
      if (isNew) groups_.push_back({r.scene, r.variant, r.region, r.metric, {}});
      if (std::isfinite(r.value)) groups_[at->second].bySeed[r.seed] = r.value;
    }
  }
  const std::vector<Group>& inOrder() const { return groups_; }
  const Group* find(const GroupKey& key) const {
    const auto at = index_.find(key);
    return at == index_.end() ? nullptr : &groups_[at->second];
  }

 private:
  std::map<GroupKey, std::size_t> index_;
  std::vector<Group> groups_;
};

std::vector<double> valuesOf(const Group& group) {
  std::vector<double> values;
  for (const auto& [seed, value] : group.bySeed) values.push_back(value);
  return values;
}

core::Interval ratioOf(const Group& group, const Group& baseline) {
  std::vector<double> ratios;
  for (const auto& [seed, value] : group.bySeed) {
    const auto other = baseline.bySeed.find(seed);
    if (other == baseline.bySeed.end()) continue;
    const bool positive = value > 0 && other->second > 0;
    ratios.push_back(positive ? value / other->second : std::numeric_limits<double>::quiet_NaN());
  }
  return core::geometricInterval(ratios);
}

std::string tableCell(const Summary& summary, const core::Interval* ratio) {
  if (!std::isfinite(summary.value.mean)) return "-";
  std::string text = fmt::format("{:.4g}", summary.value.mean);
  if (std::isfinite(summary.value.low)) text += fmt::format(" +-{:.1g}", summary.value.halfWidth());
  if (ratio && std::isfinite(ratio->mean)) text += fmt::format(" ({:.3f})", ratio->mean);
  return text;
}

}  // namespace

std::vector<Summary> summarise(const std::vector<Row>& rows) {
  std::vector<Summary> summaries;
  const Groups groups(rows);
  for (const Group& g : groups.inOrder())
    summaries.push_back({g.scene, g.variant, g.region, g.metric, core::meanInterval(valuesOf(g))});
  return summaries;
}

std::vector<Ratio> ratiosTo(const std::vector<Row>& rows, const std::string& baseline) {
  std::vector<Ratio> ratios;
  const Groups groups(rows);
  for (const Group& g : groups.inOrder()) {
    const Group* base = groups.find({g.scene, baseline, g.region, g.metric});
    if (base && g.variant != baseline)
      ratios.push_back({g.scene, g.variant, baseline, g.region, g.metric, ratioOf(g, *base)});
  }
  return ratios;
}

Json summaryJson(const Summary& s) {
  return {{"scene", s.scene},
          {"variant", s.variant},
          {"region", s.region},
          {"metric", s.metric},
          {"mean", numberOrNull(s.value.mean)},
          {"low", numberOrNull(s.value.low)},
          {"high", numberOrNull(s.value.high)}};
}

Json ratioJson(const Ratio& r) {
  return {{"scene", r.scene},
          {"variant", r.variant},
          {"baseline", r.baseline},
          {"region", r.region},
          {"metric", r.metric},
          {"mean", numberOrNull(r.value.mean)},
          {"low", numberOrNull(r.value.low)},
          {"high", numberOrNull(r.value.high)}};
}

std::string alignedTable(const std::vector<std::vector<std::string>>& cells) {
  std::vector<std::size_t> widths;
  for (const auto& line : cells) {
    widths.resize(std::max(widths.size(), line.size()));
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  }
  std::string text;
  for (const auto& line : cells) {
    for (std::size_t c = 0; c < line.size(); ++c)
      text += c == 0 ? fmt::format("{:<{}}", line[c], widths[c]) : fmt::format("  {:>{}}", line[c], widths[c]);
    text += '\n';
  }
  return text;
}

std::string summaryTable(const Results& results, const std::string& scene, const std::string& metric) {
  std::vector<Row> rows;
  std::copy_if(results.rows.begin(), results.rows.end(), std::back_inserter(rows),
               [&](const Row& r) { return r.scene == scene && r.metric == metric; });
  Names variants, regions;
  for (const Row& r : rows) variants.add(r.variant), regions.add(r.region);

  std::vector<std::vector<std::string>> cells(variants.inOrder().size() + 1,
                                              std::vector<std::string>(regions.inOrder().size() + 1));
  cells[0][0] = metric;
  for (const std::string& v : variants.inOrder()) cells[variants[v] + 1][0] = v;
  for (const std::string& r : regions.inOrder()) cells[0][regions[r] + 1] = r;
  std::map<std::pair<std::string, std::string>, core::Interval> ratios;
  for (const Ratio& r : ratiosTo(rows, results.baseline)) ratios[{r.variant, r.region}] = r.value;
  const core::Interval kOne{1, 1, 1};  // the baseline against itself
  for (const Summary& s : summarise(rows)) {
    const auto ratio = ratios.find({s.variant, s.region});
    cells[variants[s.variant] + 1][regions[s.region] + 1] = tableCell(s, s.variant == results.baseline ? &kOne
                                                                         : ratio == ratios.end()       ? nullptr
                                                                                                 : &ratio->second);
  }
  return alignedTable(cells);
}

}  // namespace experiments
