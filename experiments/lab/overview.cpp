#include "experiments/lab/overview.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <tuple>

#include "core/maths.h"
#include "experiments/markup.h"
#include "experiments/names.h"
#include "experiments/plot.h"
#include "experiments/summary.h"

namespace experiments::lab {
namespace {

constexpr const char* kSeed = "seed";

/// One metric of one region over the baseline's, by case and variant.
class Ratios {
 public:
  Ratios(const Results& results, const std::string& metric, const std::string& region, const std::string& baseline)
      : baseline_(baseline) {
    std::vector<Row> rows;
    for (const Row& r : results.rows) {
      if (r.metric != metric || r.region != region) continue;
      cases_.add(r.scene), variants_.add(r.variant);
      rows.push_back(r);
    }
    for (const Ratio& r : ratiosTo(rows, baseline)) values_[{r.scene, r.variant}] = r.value;
  }
  const std::vector<std::string>& cases() const { return cases_.inOrder(); }
  const std::vector<std::string>& variants() const { return variants_.inOrder(); }
  core::Interval at(const std::string& c, const std::string& variant) const {
    if (variant == baseline_) return {1, 1, 1};
    const auto found = values_.find({c, variant});
    return found == values_.end() ? core::Interval{core::kNaN, core::kNaN, core::kNaN} : found->second;
  }
  /// Geometric mean over the cases that have a value; NaN if none has.
  double mean(const std::string& variant) const {
    std::vector<double> values;
    for (const std::string& c : cases())
      if (const double v = at(c, variant).mean; v > 0) values.push_back(v);
    return core::geometricMean(values);
  }

 private:
  std::string baseline_;
  Names cases_, variants_;
  std::map<std::pair<std::string, std::string>, core::Interval> values_;
};

/// Geometric mean over cases of a variant's MSE over `seed`'s, once for every random seed: their interval.
core::Interval toSeedBySeeds(const Results& results, const std::string& region, const std::string& variant) {
  std::map<std::pair<std::string, std::uint64_t>, double> base;
  for (const Row& r : results.rows)
    if (r.metric == "MSE" && r.region == region && r.variant == kSeed) base[{r.scene, r.seed}] = r.value;
  std::map<std::uint64_t, std::vector<double>> ratios;
  for (const Row& r : results.rows) {
    if (r.metric != "MSE" || r.region != region || r.variant != variant) continue;
    const auto found = base.find({r.scene, r.seed});
    if (found != base.end() && r.value > 0 && found->second > 0) ratios[r.seed].push_back(r.value / found->second);
  }
  std::vector<double> means;
  for (const auto& [seed, values] : ratios) means.push_back(core::geometricMean(values));
  return core::geometricInterval(means);
}

std::string cellText(const core::Interval& i) {
  if (!std::isfinite(i.mean)) return "-";
  if (!std::isfinite(i.low) || i.low == i.high) return fmt::format("{:.3f}", i.mean);
  return fmt::format("{:.3f} +-{:.3f}", i.mean, i.halfWidth());
}

std::string intervalText(const core::Interval& i) {
  return std::isfinite(i.low) ? fmt::format("[{:.3f}, {:.3f}]", i.low, i.high) : "-";
}

using Cells = std::vector<std::vector<std::string>>;

Cells tableOf(const Results& results, const std::string& metric, const std::string& region) {
  const Ratios ratios(results, metric, region, results.baseline);
  Cells cells{{metric + ", " + region}};
  for (const std::string& v : ratios.variants())
    if (v != results.baseline) cells[0].push_back(v);
  for (const std::string& c : ratios.cases()) {
    std::vector<std::string> row{c};
    bool any = false;
    for (std::size_t i = 1; i < cells[0].size(); ++i) {
      const core::Interval ratio = ratios.at(c, cells[0][i]);
      any = any || std::isfinite(ratio.mean);
      row.push_back(cellText(ratio));
    }
    if (any) cells.push_back(row);
  }
  cells.push_back({"geometric mean"});
  for (std::size_t i = 1; i < cells[0].size(); ++i)
    cells.back().push_back(fmt::format("{:.3f}", ratios.mean(cells[0][i])));
  return cells;
}

Cells standingsTable(const Results& results, const std::string& region) {
  Cells cells{
      {"all cases, " + region, "over " + std::string(kSeed), "95 %", "over " + results.baseline, "worst", "in"}};
  for (const Standing& s : standings(results, region))
    cells.push_back({s.variant, fmt::format("{:.3f}", s.toSeed), intervalText(s.bySeeds),
                     fmt::format("{:.3f}", s.toBaseline), fmt::format("{:.3f}", s.worst), s.worstCase});
  return cells;
}

std::string htmlOf(const Cells& cells) {
  std::string html = "<div class=\"scroll\"><table>";
  for (std::size_t row = 0; row < cells.size(); ++row) {
    html += "<tr>";
    for (const std::string& cell : cells[row])
      html += row == 0 ? "<th>" + escaped(cell) + "</th>" : "<td>" + escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

/// What is shown, in order.
std::vector<Cells> allTables(const Results& results) {
  std::vector<Cells> tables;
  for (const char* region : {"full", "fovea"}) tables.push_back(standingsTable(results, region));
  for (const char* region : {"full", "fovea", "periphery", "recently_foveal"})
    tables.push_back(tableOf(results, "MSE", region));
  for (const char* region : {"fovea", "recently_foveal"}) tables.push_back(tableOf(results, "border_step", region));
  return tables;
}

/// Every variant as a point: how much it gains over `seed`, and what it costs where it does worst.
std::string frontier(const Results& results) {
  LinePlot plot{"The frontier between boldness and safety",
                "worst case, error over " + results.baseline + " (larger of full frame and fovea)",
                "geometric mean, error over seed (full frame)",
                false,
                {}};
  const std::vector<Standing> full = standings(results, "full"), fovea = standings(results, "fovea");
  plot.labelled = true;
  for (std::size_t i = 0; i < full.size(); ++i) {
    const double worst = i < fovea.size() ? std::max(full[i].worst, fovea[i].worst) : full[i].worst;
    plot.lines.push_back({full[i].variant, i, {std::min(worst, 3.0)}, {full[i].toSeed}});
  }
  const std::string svg = svgLinePlot(plot);
  return svg.empty() ? "" : "<p>Worst cases above 3 are drawn at 3.</p>" + svg;
}

}  // namespace

std::vector<Standing> standings(const Results& results, const std::string& region) {
  const Ratios toBaseline(results, "MSE", region, results.baseline), toSeed(results, "MSE", region, kSeed);
  std::vector<Standing> all;
  for (const std::string& variant : toBaseline.variants()) {
    if (variant == results.baseline) continue;
    Standing s{variant, toSeed.mean(variant), toSeedBySeeds(results, region, variant), toBaseline.mean(variant), 0, ""};
    for (const std::string& c : toBaseline.cases()) {
      const double ratio = toBaseline.at(c, variant).mean;
      if (ratio > s.worst) s.worst = ratio, s.worstCase = c;
    }
    all.push_back(s);
  }
  return all;
}

std::string overviewText(const Results& results) {
  std::string text;
  for (const Cells& table : allTables(results)) text += "\n" + alignedTable(table);
  return text;
}

std::string overviewHtml(const Results& results) {
  std::string html = frontier(results);
  for (const Cells& table : allTables(results)) html += htmlOf(table);
  return html;
}

}  // namespace experiments::lab
