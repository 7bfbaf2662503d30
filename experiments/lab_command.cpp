// `twofold lab`: blends on synthetic sequences.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "experiments/commands.h"
#include "experiments/lab/lab.h"
#include "experiments/lab/overview.h"
#include "experiments/threads.h"

namespace experiments {
namespace {

struct LabArguments {
  std::string config, only, output = "out/lab";
  std::vector<std::string> assignments;
  int threads = 0;
};

void run(const LabArguments& a) {
  const ThreadLimit threads(a.threads);
  const Json json = a.config.empty() ? Json::object() : readJson(a.config);
  const Results results = lab::runLab(lab::labConfigFrom(json, a.assignments, a.only), a.output);
  fmt::print("{}\nreport: {}\n", lab::overviewText(results),
             (std::filesystem::path(a.output) / "report.html").string());
}

}  // namespace

void addLabCommand(CLI::App& app) {
  auto arguments = std::make_shared<LabArguments>();
  CLI::App* command = app.add_subcommand("lab", "blends on synthetic sequences whose truth is known");
  command->add_option("config", arguments->config, "JSON file; without one the default cases and variants");
  command->add_option("--only", arguments->only, "only cases whose name contains this");
  command->add_option("--set", arguments->assignments, "path=value, changes one setting")->take_all();
  command->add_option("-o,--output", arguments->output, "folder for results")->capture_default_str();
  command->add_option("--threads", arguments->threads, "0 = all");
  command->footer([] { return "Settings and their defaults:\n" + listKeys(lab::LabConfig{}); });
  command->callback([=] { run(*arguments); });
}

}  // namespace experiments
