#include "experiments/efficiency/overview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/efficiency/measure.h"
#include "experiments/markup.h"
#include "experiments/names.h"
#include "experiments/plot.h"
#include "experiments/summary.h"

namespace experiments::efficiency {
namespace {

using Cells = std::vector<std::vector<std::string>>;

struct NamedTable {
  std::string caption;
  Cells cells;
};

std::string intervalText(const core::Interval& i) {
  if (!std::isfinite(i.mean)) return "-";
  const std::string mean = fmt::format("{:.3g}", i.mean);
  return std::isfinite(i.low) ? fmt::format("{} [{:.3g}, {:.3g}]", mean, i.low, i.high) : mean;
}

std::string reachText(const EqualError& e) {
  switch (e.reach) {
    case Reach::measured:
      return "measured";
    case Reach::extrapolated:
      return "extrapolated by 1/n";
    case Reach::atMost:
      return "at most: better at its least n";
    case Reach::atLeast:
      break;
  }
  return "at least: not reached";
}

const Point* pointOf(const Findings& f, const std::string& scene, const std::string& metric, const std::string& label) {
  for (const Point& p : f.points)
    if (p.scene == scene && p.metric == metric && labelOf(p.method, p.count) == label) return &p;
  return nullptr;
}

NamedTable equalTable(const Findings& f, const std::string& scene, const std::string& metric) {
  const Point* aim = pointOf(f, scene, metric, f.target);
  NamedTable table{
      fmt::format("{}: time to the error of {} ({} {})", scene, f.target, metric, aim ? intervalText(aim->error) : "-"),
      {{"method", "ms a frame", "over " + f.target, "log-log slope in n", "how found"}}};
  for (const EqualError& e : f.equal) {
    if (e.scene != scene || e.metric != metric) continue;
    const std::string mark = e.best ? " (best baseline)" : "";
    table.cells.push_back({e.method + mark, intervalText(e.milliseconds), intervalText(e.ratio),
                           std::isfinite(e.slope) ? fmt::format("{:.2f}", e.slope) : "-", reachText(e)});
  }
  return table;
}

/// The best baseline's ratio at every count of the target.
NamedTable alongTarget(const EfficiencyConfig& config, const Results& results, const std::string& metric) {
  NamedTable table{
      "Best baseline's time over " + config.target + "'s, at the error of each of its counts (" + metric + ")",
      {{"scene"}}};
  const std::vector<Method> methods = methodsOf(config);
  const auto target =
      std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == config.target; });
  Names scenes;
  for (const Row& r : results.rows)
    if (scenes.add(r.scene) + 1 == table.cells.size()) table.cells.push_back({r.scene});
  for (const int n : target->counts) {
    table.cells[0].push_back("n=" + std::to_string(n));
    for (const EqualError& e : analyse(config, n, results.rows).equal)
      if (e.best && e.metric == metric)
        table.cells[scenes[e.scene] + 1].push_back(
            fmt::format("{} {}{}", e.method, intervalText(e.ratio), e.reach == Reach::measured ? "" : " *"));
  }
  return table;
}

NamedTable lightsTable(const ByLights& lights, const std::string& target) {
  NamedTable table{"Best baseline's time over that of " + target + " by number of lights (" + lights.metric + ")",
                   {{"lights", "best baseline", "ratio", "how found"}}};
  for (const auto& [n, e] : lights.best)
    table.cells.push_back({fmt::format("{:.0f}", n), e.method, intervalText(e.ratio), reachText(e)});
  return table;
}

std::vector<NamedTable> tablesOf(const EfficiencyConfig& config, const Results& results, const Findings& f) {
  std::vector<NamedTable> tables;
  Names scenes;
  for (const Row& r : results.rows) scenes.add(r.scene);
  for (const std::string& scene : scenes.inOrder())
    for (const char* metric : kErrors) tables.push_back(equalTable(f, scene, metric));
  for (const char* metric : kErrors) tables.push_back(alongTarget(config, results, metric));
  for (const ByLights& lights : f.byLights) tables.push_back(lightsTable(lights, f.target));
  return tables;
}

std::string htmlOf(const NamedTable& table) {
  std::string html = "<h3>" + escaped(table.caption) + "</h3>\n<div class=\"scroll\"><table>";
  for (std::size_t row = 0; row < table.cells.size(); ++row) {
    html += "<tr>";
    for (const std::string& cell : table.cells[row])
      html += row == 0 ? "<th>" + escaped(cell) + "</th>" : "<td>" + escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

void addTo(Line& line, double x, const core::Interval& y) {
  line.x.push_back(x), line.y.push_back(y.mean);
  line.low.push_back(y.low), line.high.push_back(y.high);
}

/// From a curve's last point to where it is thought to reach the target's error, dashed.
Line continuation(const Line& curve, const EqualError& e, double error) {
  Line line{e.method + ", extrapolated", curve.style + kSeriesClasses / 2, {}, {}};
  line.x = {curve.x.back(), e.milliseconds.mean};
  line.y = {curve.y.back(), error};
  return line;
}

std::string curvesPlot(const Findings& f, const Names& methods, const std::string& scene, const std::string& metric) {
  LinePlot plot{scene + ", " + metric, "milliseconds a frame to sample light", metric, true, {}};
  plot.logarithmicX = true;
  for (const std::string& method : methods.inOrder()) {
    Line line{method, methods[method], {}, {}};
    for (const Point& p : f.points)
      if (p.scene == scene && p.metric == metric && p.method == method) addTo(line, p.milliseconds.mean, p.error);
    if (!line.x.empty()) plot.lines.push_back(std::move(line));
  }
  const Point* aim = pointOf(f, scene, metric, f.target);
  for (const EqualError& e : f.equal)
    if (aim && e.scene == scene && e.metric == metric && e.reach == Reach::extrapolated)
      plot.lines.push_back(continuation(plot.lines[methods[e.method]], e, aim->error.mean));
  return svgLinePlot(plot);
}

std::string lightsPlot(const ByLights& lights, const std::string& target) {
  LinePlot plot{lights.metric, "lights", "best baseline's time over " + target, true, {}};
  plot.logarithmicX = true;
  Line ratios{"best baseline", 1, {}, {}}, one{"equal", 8, {}, {}};
  for (const auto& [n, e] : lights.best) addTo(ratios, n, e.ratio);
  one.x = {lights.best.front().first, lights.best.back().first}, one.y = {1, 1};
  plot.lines = {ratios, one};
  return svgLinePlot(plot);
}

std::string plots(const std::vector<std::string>& all) {
  std::string html = "<div class=\"plots\">";
  for (const std::string& svg : all) html += svg.empty() ? "" : "<div>" + svg + "</div>";
  return html + "</div>\n";
}

std::string explanation(const Findings& f) {
  return "<p>A point is a method at one number n of samples a pixel: milliseconds a frame of the passes that sample "
         "light (median over frames; poses, surfaces and reprojection, which all methods share, are left out), and the "
         "error of the unfiltered image. Points are geometric means over seeds, whiskers and brackets 95 % intervals "
         "(Student's t on logarithms). Intervals do not hold the reference's own error, which all methods "
         "share.</p>\n<p>Times to the error of <b>" +
         escaped(f.target) +
         "</b> lie on straight lines between points in both logarithms, seed by seed. Dashed lines and * are not "
         "measured but extrapolated: of independent samples, error falls as 1/n and every further sample takes the "
         "same "
         "time. Where a method's slope in n is flatter than -1, as it is for trimmed means, that favours the method. "
         "\u201cAt most\u201d and \u201cat least\u201d are bounds. The best baseline is the one with the least "
         "time.</p>\n";
}

}  // namespace

std::string overviewText(const EfficiencyConfig& config, const Results& results) {
  const Findings f = analyse(config, targetCountOf(config, methodsOf(config)), results.rows);
  std::string text;
  for (const NamedTable& table : tablesOf(config, results, f))
    text += "\n" + table.caption + "\n" + alignedTable(table.cells);
  text += "\n* extrapolated or a bound\n";
  for (const ByLights& lights : f.byLights) text += verdict(lights, f.target) + "\n";
  return text;
}

std::string overviewHtml(const EfficiencyConfig& config, const Results& results) {
  const Findings f = analyse(config, targetCountOf(config, methodsOf(config)), results.rows);
  Names methods, scenes;
  for (const Method& m : methodsOf(config)) methods.add(m.name);
  for (const Row& r : results.rows) scenes.add(r.scene);
  std::string html = explanation(f);
  for (const ByLights& lights : f.byLights) html += "<p>" + escaped(verdict(lights, f.target)) + "</p>\n";
  html += htmlLegend(methods.inOrder());
  for (const std::string& scene : scenes.inOrder()) {
    std::vector<std::string> curves;
    for (const char* metric : kErrors) curves.push_back(curvesPlot(f, methods, scene, metric));
    html += plots(curves);
  }
  std::vector<std::string> ratios;
  for (const ByLights& lights : f.byLights) ratios.push_back(lightsPlot(lights, f.target));
  if (!ratios.empty()) html += plots(ratios);
  for (const NamedTable& table : tablesOf(config, results, f)) html += htmlOf(table);
  return html;
}

}  // namespace experiments::efficiency
