#include "experiments/config.h"

#include <set>

#include "core/check.h"
#include "experiments/scene_source.h"

namespace experiments {
namespace {

/// An entry of "variants": a name, or an object that starts from a named one.
Variant variantFrom(const Json& entry, const svgf::FilterParameters& filter, const std::string& path) {
  if (entry.is_string()) {
    Variant v = variantByName(entry.get<std::string>());
    v.filter = filter;
    return v;
  }
  if (!entry.is_object())
    throw core::UsageError(path, "it is neither a name nor an object",
                           "give a name, or {\"like\": NAME, \"name\": NEW, ...}");
  Json changes = entry;
  Variant v;
  if (const auto like = changes.find("like"); like != changes.end()) {
    if (!like->is_string()) throw core::UsageError(path + ".like", "it is not a name", "name a variant to start from");
    v = variantByName(like->get<std::string>());
    changes.erase(like);
  }
  v.filter = filter;
  fromJson(changes, v, path);
  return v;
}

void requireDistinct(const Config& config) {
  if (std::set(config.seeds.begin(), config.seeds.end()).size() != config.seeds.size())
    throw core::UsageError("config.seeds", "a seed comes twice", "independent sequences need seeds of their own");
  std::set<std::string> labels;
  for (const std::string& scene : config.scenes)
    if (!labels.insert(sceneLabel(scene)).second)
      throw core::UsageError("config.scenes", "two scenes are called '" + sceneLabel(scene) + "'",
                             "tables and images go by file name: rename one");
}

void requireFiles(const Config& config) {
  if (config.shade.gaze.kind == core::GazeKind::file && config.shade.gaze.file.empty())
    throw core::UsageError("config.gaze.file", "no recording is named", "name a CSV file, or choose another gaze.kind");
  if (config.shade.foveation.kind == core::FoveationKind::map && config.shade.foveation.file.empty())
    throw core::UsageError("config.foveation.file", "no map is named",
                           "name an OpenEXR file, or choose another foveation.kind");
}

}  // namespace

void requireConsistent(const restir::RestirParameters& p, const std::string& path) {
  const bool reuses = p.reuse != restir::Reuse::none;
  if (p.withoutReuse != restir::WithoutReuse::ris && reuses)
    throw core::UsageError(path + ".withoutReuse", "a baseline without reuse is asked for, and reuse too",
                           "set restir.reuse=none, or leave restir.withoutReuse at ris");
  if (p.second.on && !reuses)
    throw core::UsageError(path + ".second.on", "without reuse there is no second history",
                           "choose another restir.reuse, or switch it off");
}

Config configFrom(Json json, const std::vector<std::string>& assignments, const Config& defaults) {
  applyAssignments(json, assignments);
  Config config = defaults;
  fromJson(json, config);
  config.shade.tile = config.render.tile;
  config.shade.features = config.render.features;
  config.shade.restir.features =
      config.render.features == Features::all ? restir::Features::all : restir::Features::automatic;
  baselineOf(config);
  config.shade.diagnostics = config.output.diagnostics;
  config.shade.restir.tellAll |= config.output.diagnostics;
  for (const Variant& v : variantsOf(config)) {
    config.shade.checkSamples |= v.blend.validation.on;
    config.shade.restir.tellAll |= v.told != restir::Told::samples;
  }
  requireConsistent(config.shade.restir, "config.restir");
  requireConsistent(config);
  for (int frame : config.output.frames)
    if (frame >= config.frames)
      throw core::UsageError("config.output.frames", "frame " + std::to_string(frame) + " is not rendered",
                             "frames count from 0 to config.frames - 1");
  return config;
}

void requireConsistent(const Config& config) {
  requireDistinct(config);
  requireFiles(config);
  if (config.seeds.empty()) throw core::UsageError("config.seeds", "there is none", "give at least one");
  if (config.scenes.empty()) throw core::UsageError("config.scenes", "there is none", "give at least one");
}

std::vector<Variant> variantsOf(const Config& config) {
  std::vector<Variant> variants;
  std::set<std::string> names{"raw", "reference"};
  for (std::size_t i = 0; i < config.variants.size(); ++i) {
    const std::string path = "config.variants[" + std::to_string(i) + "]";
    variants.push_back(variantFrom(config.variants[i], config.filter, path));
    requireConsistent(variants.back());
    if (!names.insert(variants.back().name).second)
      throw core::UsageError(path, "the name '" + variants.back().name + "' is taken", "give it another name");
  }
  if (variants.empty()) throw core::UsageError("config.variants", "there is none", "give at least one");
  return variants;
}

std::string baselineOf(const Config& config) {
  const std::vector<Variant> variants = variantsOf(config);
  const std::string wanted = config.baseline.empty() ? "unweighted" : config.baseline;
  for (const Variant& v : variants)
    if (v.name == wanted) return wanted;
  if (config.baseline.empty()) return variants.front().name;
  if (config.baseline == "raw") return wanted;
  throw core::UsageError("config.baseline", "'" + config.baseline + "' is not among the variants",
                         "name one of them, or raw");
}

bool hasReference(const Config& config, int frame) {
  const int every = config.reference.every;
  return frame % every == every - 1 || frame == config.frames - 1;
}

}  // namespace experiments
