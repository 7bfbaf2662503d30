#include "experiments/lab/lab.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <set>

#include "core/check.h"
#include "core/files.h"
#include "core/parallel.h"
#include "experiments/config.h"
#include "experiments/lab/measure.h"
#include "experiments/lab/overview.h"
#include "experiments/lab/stretched.h"
#include "experiments/parts.h"
#include "experiments/progress.h"
#include "experiments/report.h"

namespace experiments::lab {
namespace {

/// One case and seed with all variants.
class Job {
 public:
  Job(const LabConfig& config, const Case& c, std::uint64_t seed, std::vector<Variant> variants)
      : config_(config),
        case_(c),
        seed_(seed),
        variants_(std::move(variants)),
        input_(c, seed, config.width, config.height, config.reprojection),
        memory_(config.width, config.height),
        image_(config.width, config.height),
        measures_(variants_.size()) {
    for (Variant& v : variants_) {
      if (!c.filter) v.filter.levels = 0;
      states_.push_back(std::make_unique<FilterState>(v, config.width, config.height));
    }
  }

  /// A measure a variant.
  std::vector<Measure> run() {
    for (int frame = 0; frame < config_.frames; ++frame) runFrame(frame >= config_.first);
    return std::move(measures_);
  }

 private:
  void runFrame(bool counts) {
    const Shaded frame = input_.next();
    memory_.advance(frame.guide, input_.fovea());
    for (std::size_t v = 0; v < variants_.size(); ++v) {
      filter(frame, variants_[v], input_.truth(), *states_[v], image_);
      if (counts) measures_[v].add(image_, input_.truth(), memory_);
    }
  }

  const LabConfig& config_;
  const Case& case_;
  std::uint64_t seed_;
  std::vector<Variant> variants_;
  Synthetic input_;
  FovealMemory memory_;
  core::Planes image_;
  std::vector<Measure> measures_;
  std::vector<std::unique_ptr<FilterState>> states_;
};

void addRows(const Case& c, bool colours, const std::string& variant, std::uint64_t seed, const Measure& m,
             std::vector<Row>& rows) {
  const auto add = [&](Region region, const char* metric, double value) {
    rows.push_back({c.name, variant, seed, std::string(regionName(region)), metric, value});
  };
  for (const Region region : kRegions) add(region, "MSE", m.squaredError(region));
  if (colours)
    for (const Region region : kRegions) add(region, "MSE_rgb", m.squaredColourError(region));
  for (const Region region : kBorders) add(region, "border_step", m.border(region).meanSquare());
  for (const Region region : kBorders) add(region, "border_noise", m.border(region).noiseRatio());
}

/// The experiment's configuration as far as variants go.
Config variantConfig(const LabConfig& lab) {
  Config config;
  config.variants = lab.variants;
  config.filter = lab.filter;
  config.baseline = lab.baseline;
  return config;
}

void requireConsistent(const LabConfig& config) {
  const auto fail = [](const char* where, const std::string& what, const char* remedy) {
    throw core::UsageError(where, what, remedy);
  };
  if (config.cases.empty()) fail("config.cases", "there is none", "give at least one, or another --only");
  if (config.seeds.empty()) fail("config.seeds", "there is none", "give at least one");
  if (std::set(config.seeds.begin(), config.seeds.end()).size() != config.seeds.size())
    fail("config.seeds", "a seed comes twice", "independent sequences need seeds of their own");
  if (config.first >= config.frames) fail("config.first", "no frame is left to count", "make it less than frames");
  std::set<std::string> names;
  for (const Case& c : config.cases)
    if (c.name.empty() || !names.insert(c.name).second)
      fail("config.cases", "two cases are called '" + c.name + "'", "give each a name of its own");
}

}  // namespace

LabConfig labConfigFrom(Json json, const std::vector<std::string>& assignments, const std::string& only) {
  applyAssignments(json, assignments);
  LabConfig config;
  fromJson(json, config);
  config.cases = stretched(config.cases, config.stretch);
  config.stretch.clear();  // what is written down with the results runs as it is
  std::erase_if(config.cases, [&](const Case& c) { return c.name.find(only) == std::string::npos; });
  requireConsistent(config);
  config.baseline = baselineOf(variantConfig(config));
  return config;
}

Results runLab(const LabConfig& config) {
  const std::vector<Variant> variants = variantsOf(variantConfig(config));
  const std::size_t seeds = config.seeds.size(), jobs = config.cases.size() * seeds;
  std::vector<std::vector<Measure>> measures(jobs);
  Progress progress("sequences", static_cast<std::int64_t>(jobs));
  core::forEachIndex(jobs, [&](std::size_t i) {
    const Case& c = config.cases[i / seeds];
    // An inner loop that waits must not begin another sequence meanwhile: stacks and memory would pile up.
    tbb::this_task_arena::isolate([&] { measures[i] = Job(config, c, config.seeds[i % seeds], variants).run(); });
    progress.advance(1, c.name);
  });
  const bool colours =
      std::any_of(config.cases.begin(), config.cases.end(), [](const Case& c) { return isColoured(c.signal); });
  Results results;
  for (std::size_t i = 0; i < jobs; ++i)
    for (std::size_t v = 0; v < variants.size(); ++v)
      addRows(config.cases[i / seeds], colours, variants[v].name, config.seeds[i % seeds], measures[i][v],
              results.rows);
  for (std::size_t c = 0; c < config.cases.size(); ++c) {  // what only several seeds together can tell
    std::vector<BorderContrasts> contrasts;
    for (std::size_t s = 0; s < seeds; ++s)
      for (std::size_t v = 0; v < variants.size(); ++v)
        for (const Region region : kBorders)
          contrasts.push_back({variants[v].name, std::string(regionName(region)), config.seeds[s],
                               measures[c * seeds + s][v].border(region).contrasts()});
    for (Row& r : systematicRows(config.cases[c].name, contrasts)) results.rows.push_back(std::move(r));
  }
  results.config = toJson(config);
  results.baseline = config.baseline;
  results.provenance = currentProvenance();
  return results;
}

Results runLab(const LabConfig& config, const std::filesystem::path& folder) {
  makeFolder(folder);
  Results results = runLab(config);
  saveResults(results, folder);
  saveReport({"Twofold laboratory: " + folder.filename().string(), results, {}, overviewHtml(results), {}},
             folder / "report.html");
  return results;
}

}  // namespace experiments::lab
