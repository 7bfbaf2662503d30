#include "experiments/scenes/builtin.h"

#include <map>

#include "core/check.h"

namespace experiments {
namespace {

const std::map<std::string, core::Scene (*)()>& makers() {
  static const std::map<std::string, core::Scene (*)()> table{
      {"ajar", ajarScene}, {"cornell", cornellScene}, {"market", marketScene}};
  return table;
}

}  // namespace

std::vector<std::string> builtinSceneNames() {
  std::vector<std::string> names;
  for (const auto& [name, make] : makers()) names.push_back(name);
  names.push_back("lamps-1000");
  return names;
}

bool isBuiltin(const std::string& name) { return isLamps(name) || makers().contains(name); }

core::Scene builtinScene(const std::string& name) {
  if (isLamps(name)) return lampsScene(name);
  const auto found = makers().find(name);
  if (found != makers().end()) return found->second();
  std::string known;
  for (const std::string& each : builtinSceneNames()) known += (known.empty() ? "" : ", ") + each;
  throw core::UsageError(name, "no such built-in scene", "choose one of " + known);
}

}  // namespace experiments
