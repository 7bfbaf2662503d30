#include "experiments/efficiency/config.h"

#include <algorithm>

#include "core/check.h"

namespace experiments::efficiency {
namespace {

Method methodFrom(const Json& entry, const EfficiencyConfig& config, const std::vector<Method>& earlier,
                  const std::string& path) {
  if (!entry.is_object())
    throw core::UsageError(path, "it is not an object", "give {\"name\": NAME, \"restir\": {...}}");
  Json changes = entry;
  Method m{"", config.restir, config.counts};
  if (const auto like = changes.find("like"); like != changes.end()) {
    const auto from = std::find_if(earlier.begin(), earlier.end(), [&](const Method& e) { return *like == e.name; });
    if (from == earlier.end())
      throw core::UsageError(path + ".like", "it names no method that stands before", "name one of those");
    m = *from;
    m.name.clear();
    changes.erase("like");
  }
  fromJson(changes, m, path);
  m.restir.features = config.render.features == Features::all ? restir::Features::all : restir::Features::automatic;
  return m;
}

void requireConsistent(const Method& m, const std::string& path) {
  if (m.name.empty()) throw core::UsageError(path + ".name", "it has no name", "give it one");
  if (m.counts.empty()) throw core::UsageError(path + ".counts", "there is none", "give at least one");
  if (std::adjacent_find(m.counts.begin(), m.counts.end(), std::greater_equal<>()) != m.counts.end())
    throw core::UsageError(path + ".counts", "they do not ascend", "sort them, each once");
}

const Method* find(const std::vector<Method>& methods, const std::string& name) {
  const auto found = std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == name; });
  return found == methods.end() ? nullptr : &*found;
}

}  // namespace

std::vector<Json> defaultMethods() {
  const auto baseline = [](const char* name) {
    return Json{{"name", name}, {"restir", {{"reuse", "none"}, {"withoutReuse", name}}}, {"counts", {1, 4, 16}}};
  };
  return {baseline("uniform"),
          baseline("power"),
          baseline("tree"),
          baseline("ris"),
          {{"name", "balance"}, {"restir", {{"reuse", "both"}, {"mis", "balance"}}}},
          {{"name", "pairwise"}, {"restir", {{"reuse", "both"}, {"mis", "pairwise"}}}}};
}

EfficiencyConfig efficiencyConfigFrom(Json json, const std::vector<std::string>& assignments) {
  applyAssignments(json, assignments);
  EfficiencyConfig config;
  fromJson(json, config);
  experiments::requireConsistent(experimentOf(config));
  const std::vector<Method> methods = methodsOf(config);
  targetCountOf(config, methods);
  baselinesOf(config, methods);
  return config;
}

std::vector<Method> methodsOf(const EfficiencyConfig& config) {
  std::vector<Method> methods;
  for (std::size_t i = 0; i < config.methods.size(); ++i) {
    const std::string path = "config.methods[" + std::to_string(i) + "]";
    Method m = methodFrom(config.methods[i], config, methods, path);
    requireConsistent(m, path);
    experiments::requireConsistent(m.restir, path + ".restir");
    if (find(methods, m.name))
      throw core::UsageError(path, "the name '" + m.name + "' is taken", "give it another name");
    methods.push_back(std::move(m));
  }
  if (methods.empty()) throw core::UsageError("config.methods", "there is none", "give at least one");
  return methods;
}

std::vector<std::string> baselinesOf(const EfficiencyConfig& config, const std::vector<Method>& methods) {
  for (const std::string& name : config.baselines)
    if (!find(methods, name))
      throw core::UsageError("config.baselines", "'" + name + "' is not among the methods", "name some of them");
  if (!config.baselines.empty()) return config.baselines;
  std::vector<std::string> names;
  for (const Method& m : methods)
    if (m.independent() && m.name != config.target) names.push_back(m.name);
  return names;
}

int targetCountOf(const EfficiencyConfig& config, const std::vector<Method>& methods) {
  const Method* target = find(methods, config.target);
  if (!target)
    throw core::UsageError("config.target", "'" + config.target + "' is not among the methods", "name one of them");
  if (config.targetCount == 0) return target->counts.front();
  if (std::find(target->counts.begin(), target->counts.end(), config.targetCount) == target->counts.end())
    throw core::UsageError("config.targetCount", std::to_string(config.targetCount) + " is none of the target's counts",
                           "give one of them, or 0");
  return config.targetCount;
}

std::string labelOf(const std::string& method, int count) { return method + " n=" + std::to_string(count); }

Config experimentOf(const EfficiencyConfig& config) {
  Config experiment;
  experiment.scenes = config.scenes;
  experiment.seeds = config.seeds;
  experiment.frames = config.warmUp + config.frames;
  experiment.width = config.width;
  experiment.height = config.height;
  experiment.render = config.render;
  experiment.reference = config.reference;
  experiment.shade.reprojection = config.reprojection;
  experiment.shade.tile = config.render.tile;
  experiment.shade.features = config.render.features;
  return experiment;
}

}  // namespace experiments::efficiency
