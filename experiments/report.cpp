#include "experiments/report.h"

#include <fmt/format.h>

#include "core/files.h"
#include "experiments/compare.h"
#include "experiments/markup.h"
#include "experiments/names.h"
#include "experiments/plot.h"
#include "experiments/regions.h"
#include "experiments/report_style.h"
#include "experiments/report_tables.h"

namespace experiments {

namespace {

std::string section(const std::string& heading, const std::string& content) {
  return content.empty() ? "" : "<h2>" + escaped(heading) + "</h2>\n" + content;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// What the results are made of, one sentence.
std::string extentOf(const Results& results) {
  Names scenes, variants, seeds;
  for (const Row& r : results.rows) scenes.add(r.scene), variants.add(r.variant), seeds.add(std::to_string(r.seed));
  return fmt::format("Scenes: {}. Variants: {}. Independent seeds: {}.", joined(scenes.inOrder()),
                     joined(variants.inOrder()), seeds.inOrder().size());
}

std::string head(const ReportData& data) {
  const Provenance& p = data.results.provenance;
  std::string html = "<h1>" + escaped(data.title) + "</h1>\n<p>" + escaped(extentOf(data.results)) + "</p>\n";
  html += "<p class=\"faint\">" +
          escaped(fmt::format("Twofold {} (commit {}, {}, {} build), {} of {} threads, {}.", p.version, p.commit,
                              p.compiler, p.build, p.threads, p.cpus, p.date)) +
          "</p>\n";
  for (const std::string& note : data.notes) html += "<p>" + escaped(note) + "</p>\n";
  return html;
}

std::string definition(std::string_view term, std::string_view meaning) {
  return "<dt>" + escaped(term) + "</dt><dd>" + escaped(meaning) + ".</dd>\n";
}

std::string definitions(const Results& results) {
  Names regions;
  for (const Row& r : results.rows) regions.add(r.region);
  std::string html =
      "<p>y is the image, r the reference. Each figure is the mean over the compared frames of a seed's "
      "sequence, then over seeds; brackets hold the 95 % confidence interval over seeds (Student's t). "
      "\u00d7 is the ratio to <b>" +
      escaped(results.baseline) +
      "</b>: geometric mean over seeds of ratios seed by seed, with its own interval. The best variant "
      "of a column is highlighted; <b>" +
      std::string(kLimitVariant) + "</b>, which sees the reference, is a limit and never counts as best.</p>\n<dl>\n";
  for (const std::string& metric : metricsOf(results))
    if (!metricMeaning(metric).empty()) html += definition(metric, metricMeaning(metric));
  for (const Region region : kRegions) {
    const std::string name(regionName(region));
    if (regions.has(name)) html += definition("region " + name, regionMeaning(region));
  }
  return html + "</dl>\n";
}

std::string figureHtml(const Figure& figure) {
  std::string html = "<figure><h3>" + escaped(figure.caption) + "</h3>\n<div class=\"panels\">\n";
  for (const Panel& panel : figure.panels)
    html += fmt::format("<div class=\"panel\"><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><p>{0}</p></div>\n",
                        escaped(panel.label), base64(panel.png));
  html += "</div>\n";
  if (figure.scale) html += svgColourScale(figure.scale->low, figure.scale->high, figure.scaleLabel);
  return html + "</figure>\n";
}

std::string figuresHtml(const std::vector<Figure>& figures) {
  if (figures.empty()) return "";
  std::string html =
      "<p class=\"faint\">A click enlarges an image; the arrow keys then flip through its neighbours.</p>\n";
  for (const Figure& figure : figures) html += figureHtml(figure);
  return html;
}

std::string sceneHtml(const Results& results, const std::string& scene) {
  return section("Error in " + scene, htmlMetricTables(results, scene)) +
         section("Error by frame in " + scene, htmlFramePlots(results, scene)) +
         section("Time by pass in " + scene, htmlPassTimes(results, scene));
}

}  // namespace

std::string reportHtml(const ReportData& data) {
  Results results = data.results;
  sortCanonically(results);
  Names scenes;
  for (const Row& r : results.rows) scenes.add(r.scene);

  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      escaped(data.title) + "</title>\n<style>" + kReportStyle + "</style></head>\n<body>\n" + head(data);
  html += section("What was measured", definitions(results));
  html += section("Overview", data.overview);
  for (const std::string& scene : scenes.inOrder()) html += sceneHtml(results, scene);
  html += section("Frames", figuresHtml(data.figures));
  html += section("Settings", "<details><summary>Every setting of this run</summary>" + htmlSettings(results.config) +
                                  "</details>\n");
  html += "<dialog id=\"zoom\"><p></p><img alt=\"\"></dialog>\n<script>" + std::string(kReportScript) + "</script>\n";
  return html + "</body></html>\n";
}

void saveReport(const ReportData& data, const std::filesystem::path& file) {
  core::writeFileAtomically(file, reportHtml(data));
}

}  // namespace experiments
