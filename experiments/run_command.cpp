// `twofold run`: an experiment from a configuration file.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "experiments/commands.h"
#include "experiments/runner.h"
#include "experiments/scene_source.h"
#include "experiments/summary.h"
#include "experiments/threads.h"

namespace experiments {
namespace {

struct RunArguments {
  std::string config, output = "out/run";
  std::vector<std::string> assignments;
  int threads = 0;
};

void printTables(const Results& results, const Config& config) {
  for (const std::string& scene : config.scenes)
    for (const char* metric : {"relMSE", "SSIM"})
      fmt::print("\n{}: {} (ratio to {})\n{}", sceneLabel(scene), metric, results.baseline,
                 summaryTable(results, sceneLabel(scene), metric));
}

void run(const RunArguments& a) {
  const ThreadLimit threads(a.threads);
  const Config config = configFrom(readJson(a.config), a.assignments);
  const Results results = runExperiment(config, a.output);
  printTables(results, config);
  fmt::print("\nreport: {}\n", (std::filesystem::path(a.output) / "report.html").string());
}

}  // namespace

void addRunCommand(CLI::App& app) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "an experiment: variants x scenes x seeds, into results and a report");
  command->add_option("config", arguments->config, "JSON file")->required();
  command->add_option("--set", arguments->assignments, "path=value, changes one setting")->take_all();
  command->add_option("-o,--output", arguments->output, "folder for results")->capture_default_str();
  command->add_option("--threads", arguments->threads, "0 = all");
  command->footer([] { return "Settings and their defaults:\n" + listKeys(Config{}); });
  command->callback([=] { run(*arguments); });
}

}  // namespace experiments
