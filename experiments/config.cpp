#include "experiments/config.h"

#include <set>

#include "core/check.h"

namespace experiments {
namespace {

/// An entry of "variants": a name, or an object that starts from a named one.
Variant variantFrom(const Json& entry, const svgf::FilterParameters& filter, const std::string& path) {
  if (entry.is_string()) {
    Variant v = variantByName(entry.get<std::string>());
    v.filter = filter;
    return v;
  }
  if (!entry.is_object()) throw core::UsageError(path, "it is neither a name nor an object", "see docs/extending.md");
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

}  // namespace

Config configFrom(Json json, const std::vector<std::string>& assignments, const Config& defaults) {
  applyAssignments(json, assignments);
  Config config = defaults;
  fromJson(json, config);
  config.shade.tile = config.render.tile;
  config.shade.features = config.render.features;
  config.shade.restir.features =
      config.render.features == Features::all ? restir::Features::all : restir::Features::automatic;
  variantsOf(config);
  if (config.seeds.empty()) throw core::UsageError("config.seeds", "there is none", "give at least one");
  if (config.scenes.empty()) throw core::UsageError("config.scenes", "there is none", "give at least one");
  for (int frame : config.output.frames)
    if (frame >= config.frames)
      throw core::UsageError("config.output.frames", "frame " + std::to_string(frame) + " is not rendered",
                             "frames count from 0 to config.frames - 1");
  return config;
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

bool hasReference(const Config& config, int frame) {
  const int every = config.reference.every;
  return frame % every == every - 1 || frame == config.frames - 1;
}

}  // namespace experiments
