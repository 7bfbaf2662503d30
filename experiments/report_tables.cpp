#include "experiments/report_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/compare.h"
#include "experiments/json_text.h"
#include "experiments/markup.h"
#include "experiments/names.h"
#include "experiments/summary.h"

namespace experiments {

namespace {

/// How far a figure is from perfect, for finding the best: less is better.
double badness(const std::string& metric, double value) {
  if (metric == "SSIM") return -value;
  if (metric == "energy_ratio" || metric == "energy_over_raw") return std::abs(std::log(value));
  return std::abs(value);
}

std::string intervalText(const core::Interval& i) {
  return std::isfinite(i.low) ? fmt::format("[{}, {}]", shortNumber(i.low), shortNumber(i.high)) : "one seed";
}

struct Cell {
  core::Interval value, ratio;
  bool hasRatio = false, best = false;
};

std::string cellHtml(const Cell& cell) {
  if (!std::isfinite(cell.value.mean)) return "<td>\u2013</td>";
  std::string html = fmt::format("<td{}>{}<small>{}</small>", cell.best ? " class=\"best\"" : "",
                                 shortNumber(cell.value.mean), intervalText(cell.value));
  if (cell.hasRatio && std::isfinite(cell.ratio.mean))
    html += fmt::format(
        "<small>\u00d7{:.3f} {}</small>", cell.ratio.mean,
        std::isfinite(cell.ratio.low) ? fmt::format("[{:.3f}, {:.3f}]", cell.ratio.low, cell.ratio.high) : "");
  return html + "</td>";
}

/// One metric of one scene.
class Table {
 public:
  Table(const std::vector<Row>& rows, const std::string& metric, const std::string& baseline) {
    for (const Summary& s : summarise(rows)) {
      variants_.add(s.variant), regions_.add(s.region);
      cells_[{s.variant, s.region}].value = s.value;
    }
    for (const Ratio& r : ratiosTo(rows, baseline)) {
      cells_[{r.variant, r.region}].ratio = r.value;
      cells_[{r.variant, r.region}].hasRatio = true;
    }
    for (const std::string& region : regions_.inOrder()) markBest(metric, region);
  }
  std::string html() const {
    std::string text = "<div class=\"scroll\"><table><tr><th>variant</th>";
    for (const std::string& region : regions_.inOrder()) text += "<th>" + escaped(region) + "</th>";
    for (const std::string& variant : variants_.inOrder()) {
      text += "</tr>\n<tr><td>" + escaped(variant) + "</td>";
      for (const std::string& region : regions_.inOrder()) {
        const auto cell = cells_.find({variant, region});
        text += cellHtml(cell == cells_.end() ? Cell{{NAN, NAN, NAN}, {}} : cell->second);
      }
    }
    return text + "</tr></table></div>\n";
  }

 private:
  void markBest(const std::string& metric, const std::string& region) {
    Cell* best = nullptr;
    for (const std::string& variant : variants_.inOrder()) {
      const auto cell = cells_.find({variant, region});
      if (variant == kLimitVariant || cell == cells_.end() || !std::isfinite(cell->second.value.mean)) continue;
      if (!best || badness(metric, cell->second.value.mean) < badness(metric, best->value.mean)) best = &cell->second;
    }
    if (best && variants_.inOrder().size() > 1) best->best = true;
  }

  Names variants_, regions_;
  std::map<std::pair<std::string, std::string>, Cell> cells_;
};

/// One line for every value; members of lists that are aggregates get lines of their own too.
std::string settingLines(const Json& json, const std::string& path) {
  const bool opens = json.is_object() || (json.is_array() && !json.empty() && json[0].is_object());
  if (!opens || json.empty())
    return "<tr><td>" + escaped(path) + "</td><td>" + escaped(compactText(json)) + "</td></tr>\n";
  std::string text;
  for (const auto& [key, value] : json.items()) text += settingLines(value, path.empty() ? key : path + "." + key);
  return text;
}

}  // namespace

std::vector<std::string> metricsOf(const Results& results) {
  Names present, ordered;
  for (const Row& r : results.rows) present.add(r.metric);
  for (const FrameValue& f : results.series) present.add(f.metric);
  for (const auto& [metric, value] : namedMetrics({}))
    if (present.has(metric)) ordered.add(metric);
  for (const std::string& metric : present.inOrder()) ordered.add(metric);
  return ordered.inOrder();
}

std::string htmlMetricTables(const Results& results, const std::string& scene) {
  std::map<std::string, std::vector<Row>> byMetric;
  for (const Row& r : results.rows)
    if (r.scene == scene) byMetric[r.metric].push_back(r);
  std::string html;
  for (const std::string& metric : metricsOf(results)) {
    if (byMetric.count(metric) == 0) continue;
    const bool first = html.empty();  // the leading metric is open, the others unfold
    html += fmt::format("<details{}><summary><b>{}</b> <span class=\"faint\">{}</span></summary>\n",
                        first ? " open" : "", escaped(metric), escaped(metricMeaning(metric)));
    html += Table(byMetric[metric], metric, results.baseline).html() + "</details>\n";
  }
  return html;
}

std::string htmlSettings(const Json& config) {
  return "<div class=\"scroll\"><table>" + settingLines(config, "") + "</table></div>\n";
}

}  // namespace experiments
