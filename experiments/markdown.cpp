#include "experiments/markdown.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/check.h"
#include "experiments/names.h"
#include "experiments/summary.h"

namespace experiments {

namespace {

/// What was asked for, or all there is. kind: for the error.
std::vector<std::string> chosen(const std::vector<std::string>& wanted, const Names& present, const char* kind) {
  for (const std::string& name : wanted)
    if (!present.has(name))
      throw core::UsageError(name, std::string("the results have no such ") + kind,
                             fmt::format("choose among {}", fmt::join(present.inOrder(), ", ")));
  return wanted.empty() ? present.inOrder() : wanted;
}

/// A bar would end a cell.
std::string cellText(std::string name) {
  for (std::size_t at = 0; (at = name.find('|', at)) != std::string::npos; at += 2) name.insert(at, "\\");
  return name;
}

std::string ratioText(const core::Interval& i) {
  if (!std::isfinite(i.mean)) return "\u2013";
  return std::isfinite(i.low) ? fmt::format("{:.3f} [{:.3f}, {:.3f}]", i.mean, i.low, i.high)
                              : fmt::format("{:.3f}", i.mean);
}

class Tables {
 public:
  Tables(const Results& results, const MarkdownSelection& s)
      : baseline_(s.baseline.empty() ? results.baseline : s.baseline) {
    Names scenes, metrics, regions, variants;
    for (const Row& r : results.rows)
      scenes.add(r.scene), metrics.add(r.metric), regions.add(r.region), variants.add(r.variant);
    scenes_ = chosen(s.scenes, scenes, "scene"), metrics_ = chosen(s.metrics, metrics, "metric");
    regions_ = chosen(s.regions, regions, "region"), variants_ = chosen(s.variants, variants, "variant");
    chosen({baseline_}, variants, "variant");
    for (const Summary& x : summarise(results.rows)) means_[{x.scene, x.metric, x.variant, x.region}] = x.value;
    for (const Ratio& x : ratiosTo(results.rows, baseline_))
      ratios_[{x.scene, x.metric, x.variant, x.region}] = x.value;
  }
  std::string text() const {
    std::string all;
    for (const std::string& metric : metrics_) {
      if (metric == kContrast) {
        all += borderTable();
        continue;
      }
      for (const std::string& scene : scenes_) all += sceneTable(scene, metric);
      if (scenes_.size() > 1) all += overScenes(metric);
    }
    return all;
  }

 private:
  static constexpr const char* kContrast = "border_contrast2";
  using Key = std::tuple<std::string, std::string, std::string, std::string>;

  bool has(const std::string& scene, const std::string& metric, const std::string& region) const {
    return std::any_of(variants_.begin(), variants_.end(), [&](const std::string& v) {
      return means_.count({scene, metric, v, region}) > 0;
    });
  }
  static std::string heading(const std::string& title, const std::string& columns, std::size_t count,
                             const char* first = "variant") {
    std::string line = fmt::format("**{}**\n\n| {} |{}\n|---|", cellText(title), first, columns);
    for (std::size_t i = 0; i < count; ++i) line += "---|";
    return line + '\n';
  }
  std::string sceneTable(const std::string& scene, const std::string& metric) const {
    std::vector<std::string> regions;
    for (const std::string& r : regions_)
      if (has(scene, metric, r)) regions.push_back(r);
    if (regions.empty()) return {};
    std::string columns;
    for (const std::string& r : regions) columns += fmt::format(" {} | over {} |", cellText(r), cellText(baseline_));
    std::string table = heading(scene + ", " + metric, columns, 2 * regions.size());
    for (const std::string& v : variants_) {
      table += "| " + cellText(v) + " |";
      for (const std::string& r : regions) table += cells({scene, metric, v, r});
      table += '\n';
    }
    return table + '\n';
  }
  std::string cells(const Key& key) const {
    const auto mean = means_.find(key);
    const auto ratio = ratios_.find(key);
    const bool known = mean != means_.end() && std::isfinite(mean->second.mean);
    const std::string over = std::get<2>(key) == baseline_ ? "1"
                             : ratio == ratios_.end()      ? "\u2013"
                                                           : ratioText(ratio->second);
    return fmt::format(" {} | {} |", known ? fmt::format("{:.4g}", mean->second.mean) : "\u2013", over);
  }
  /// Steps of the mean image as Weber contrasts in %, 0 where the squared one is negative, and the ratio of the noise
  /// outside to that inside; region by region in a cell.
  std::string borderTable() const {
    std::string columns;
    for (const std::string& v : variants_) columns += " " + cellText(v) + " |";
    const std::vector<std::string> regions = bordered();
    std::string table =
        heading(fmt::format("contrast of the border in %, noise outside over inside; {}", fmt::join(regions, ", ")),
                columns, variants_.size(), "scene");
    for (const std::string& scene : scenes_) {
      table += "| " + cellText(scene) + " |";
      for (const std::string& v : variants_) table += borderCell(scene, v, regions);
      table += '\n';
    }
    return table + '\n';
  }
  std::vector<std::string> bordered() const {
    std::vector<std::string> regions;
    for (const std::string& r : regions_)
      if (std::any_of(scenes_.begin(), scenes_.end(), [&](const std::string& s) { return has(s, kContrast, r); }))
        regions.push_back(r);
    return regions;
  }
  std::string borderCell(const std::string& scene, const std::string& variant,
                         const std::vector<std::string>& regions) const {
    const auto percent = [](double squared) { return 100 * std::sqrt(std::max(0.0, squared)); };
    std::vector<std::string> parts;
    for (const std::string& r : regions) {
      const auto found = means_.find({scene, kContrast, variant, r});
      if (found == means_.end() || !std::isfinite(found->second.mean)) {
        parts.emplace_back("\u2013");
        continue;
      }
      const core::Interval& c = found->second;
      std::string part = fmt::format("{:.1f}", percent(c.mean));
      if (std::isfinite(c.low)) part += fmt::format(" [{:.1f}, {:.1f}]", percent(c.low), percent(c.high));
      const auto noise = means_.find({scene, "border_noise", variant, r});
      if (noise != means_.end() && std::isfinite(noise->second.mean))
        part += fmt::format(", x{:.2f}", noise->second.mean);
      parts.push_back(part);
    }
    return fmt::format(" {} |", fmt::join(parts, " \\| "));
  }
  /// Geometric means over scenes, and the worst.
  std::string overScenes(const std::string& metric) const {
    std::string columns;
    for (const std::string& r : regions_)
      columns += fmt::format(" {} over {} | worst, in |", cellText(r), cellText(baseline_));
    std::string table = heading("all scenes, " + metric, columns, 2 * regions_.size());
    for (const std::string& v : variants_) {
      if (v == baseline_) continue;
      table += "| " + cellText(v) + " |";
      for (const std::string& r : regions_) table += meanAndWorst(metric, v, r);
      table += '\n';
    }
    return table + '\n';
  }
  std::string meanAndWorst(const std::string& metric, const std::string& variant, const std::string& region) const {
    double logs = 0, worst = 0;
    int count = 0;
    std::string where;
    for (const std::string& scene : scenes_) {
      const auto ratio = ratios_.find({scene, metric, variant, region});
      if (ratio == ratios_.end() || !(ratio->second.mean > 0)) continue;
      logs += std::log(ratio->second.mean), ++count;
      if (ratio->second.mean > worst) worst = ratio->second.mean, where = scene;
    }
    if (count == 0) return " \u2013 | \u2013 |";
    return fmt::format(" {:.3f} | {:.3f}, {} |", std::exp(logs / count), worst, cellText(where));
  }

  std::string baseline_;
  std::vector<std::string> scenes_, metrics_, regions_, variants_;
  std::map<Key, core::Interval> means_;
  std::map<Key, core::Interval> ratios_;
};

}  // namespace

std::string markdownTables(const Results& results, const MarkdownSelection& selection) {
  return Tables(results, selection).text();
}

}  // namespace experiments
