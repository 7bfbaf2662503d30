// `twofold efficiency`: error against time of methods that sample direct light.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "experiments/commands.h"
#include "experiments/efficiency/efficiency.h"
#include "experiments/efficiency/overview.h"
#include "experiments/threads.h"

namespace experiments {
namespace {

struct EfficiencyArguments {
  std::string config, output = "out/efficiency";
  std::vector<std::string> assignments;
  int threads = 0;
};

void run(const EfficiencyArguments& a) {
  const ThreadLimit threads(a.threads);
  const Json json = a.config.empty() ? Json::object() : readJson(a.config);
  const efficiency::EfficiencyConfig config = efficiency::efficiencyConfigFrom(json, a.assignments);
  const Results results = efficiency::runEfficiency(config, a.output);
  fmt::print("{}\nreport: {}\n", efficiency::overviewText(config, results),
             (std::filesystem::path(a.output) / "report.html").string());
}

}  // namespace

void addEfficiencyCommand(CLI::App& app) {
  auto arguments = std::make_shared<EfficiencyArguments>();
  CLI::App* command = app.add_subcommand("efficiency", "error against time of methods that sample direct light");
  command->add_option("config", arguments->config, "JSON file; without one the default scenes and methods");
  command->add_option("--set", arguments->assignments, "path=value, changes one setting")->take_all();
  command->add_option("-o,--output", arguments->output, "folder for results")->capture_default_str();
  command->add_option("--threads", arguments->threads, "0 = all");
  command->footer([] { return "Settings and their defaults:\n" + listKeys(efficiency::EfficiencyConfig{}); });
  command->callback([=] { run(*arguments); });
}

}  // namespace experiments
