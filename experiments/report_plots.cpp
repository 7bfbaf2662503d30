// Error by frame and time by pass, as plots of a report.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/statistics.h"
#include "experiments/markup.h"
#include "experiments/names.h"
#include "experiments/plot.h"
#include "experiments/report_tables.h"

namespace experiments {

namespace {

using FrameMeans = std::map<int, core::RunningMoments>;  ///< over seeds, by frame

/// Series of one scene and metric, by region and variant.
struct Curves {
  Names regions;
  std::map<std::pair<std::string, std::string>, FrameMeans> means;
};

Line lineOf(const FrameMeans& means, const std::string& label, std::size_t style) {
  Line line{label, style, {}, {}};
  for (const auto& [frame, moments] : means) {
    line.x.push_back(frame);
    line.y.push_back(moments.mean());
  }
  return line;
}

std::string plotsOf(const Curves& curves, const std::string& metric, const Names& variants) {
  std::string html = "<div class=\"plots\">";
  for (const std::string& region : curves.regions.inOrder()) {
    LinePlot plot{region, "frame", metric, metric != "SSIM" && metric != "bias" && metric != "energy_ratio", {}};
    for (const std::string& variant : variants.inOrder()) {
      const auto found = curves.means.find({region, variant});
      if (found != curves.means.end()) plot.lines.push_back(lineOf(found->second, variant, variants[variant]));
    }
    const std::string svg = svgLinePlot(plot);
    if (!svg.empty()) html += "<div>" + svg + "</div>";
  }
  return html + "</div>\n";
}

/// Milliseconds of one scene as a matrix.
struct PassMatrix {
  Names variants, passes;
  std::map<std::pair<std::string, std::string>, double> ms;
  double at(const std::string& variant, const std::string& pass) const {
    const auto found = ms.find({variant, pass});
    return found == ms.end() || !(found->second >= 0) ? 0 : found->second;
  }
};

std::string passTable(const PassMatrix& m) {
  std::string html = "<div class=\"scroll\"><table><tr><th>ms a frame</th>";
  for (const std::string& pass : m.passes.inOrder()) html += "<th>" + escaped(pass) + "</th>";
  html += "<th>sum</th>";
  for (const std::string& variant : m.variants.inOrder()) {
    html += "</tr>\n<tr><td>" + escaped(variant) + "</td>";
    double sum = 0;
    for (const std::string& pass : m.passes.inOrder()) {
      const bool present = m.ms.count({variant, pass}) > 0;
      html += "<td>" + (present ? fmt::format("{:.2f}", m.at(variant, pass)) : "\u2013") + "</td>";
      sum += m.at(variant, pass);
    }
    html += fmt::format("<td>{:.2f}</td>", sum);
  }
  return html + "</tr></table></div>\n";
}

}  // namespace

std::string htmlFramePlots(const Results& results, const std::string& scene) {
  Names variants;
  std::map<std::string, Curves> byMetric;
  for (const FrameValue& f : results.series) {
    if (f.scene != scene) continue;
    variants.add(f.variant);
    Curves& curves = byMetric[f.metric];
    curves.regions.add(f.region);
    if (std::isfinite(f.value)) curves.means[{f.region, f.variant}][f.frame].add(f.value);
  }
  std::string html;
  for (const std::string& metric : metricsOf(results)) {
    if (byMetric.count(metric) == 0) continue;
    html += fmt::format("<details{}><summary><b>{}</b></summary>\n{}</details>\n", html.empty() ? " open" : "",
                        escaped(metric), plotsOf(byMetric[metric], metric, variants));
  }
  return html.empty() ? "" : htmlLegend(variants.inOrder()) + html;
}

std::string htmlPassTimes(const Results& results, const std::string& scene) {
  PassMatrix m;
  for (const PassTime& p : results.passes) {
    if (p.scene != scene) continue;
    m.variants.add(p.variant), m.passes.add(p.pass);
    m.ms[{p.variant, p.pass}] = p.ms;
  }
  if (m.ms.empty()) return "";
  StackedBars bars{"milliseconds a frame", m.variants.inOrder(), m.passes.inOrder(), {}};
  for (const std::string& variant : bars.bars) {
    bars.values.emplace_back();
    for (const std::string& pass : bars.segments) bars.values.back().push_back(m.at(variant, pass));
  }
  std::string legend = "<div class=\"legend\">";
  for (std::size_t i = 0; i < bars.segments.size(); ++i)
    legend += fmt::format(
        "<span><svg width=\"14\" height=\"14\" class=\"key\"><rect width=\"14\" height=\"14\" class=\"bar "
        "{}\"/></svg>{}</span>",
        seriesClass(i), escaped(bars.segments[i]));
  return legend + "</div>\n" + svgStackedBars(bars) + passTable(m);
}

}  // namespace experiments
