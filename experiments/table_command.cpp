// `twofold table`: the tables of a results.json as Markdown.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "experiments/commands.h"
#include "experiments/markdown.h"

namespace experiments {

namespace {

struct TableArguments {
  std::string file;
  MarkdownSelection selection;
};

}  // namespace

void addTableCommand(CLI::App& app) {
  auto a = std::make_shared<TableArguments>();
  CLI::App* command = app.add_subcommand("table", "the tables of a results.json as Markdown");
  command->add_option("results", a->file, "results.json of `run` or `lab`")->required();
  const auto list = [&](const char* name, std::vector<std::string>& names, const char* what) {
    command->add_option(name, names, what)->delimiter(',')->allow_extra_args(false);
  };
  list("--scenes", a->selection.scenes, "only these, separated by commas");
  list("--metrics", a->selection.metrics, "only these");
  list("--regions", a->selection.regions, "only these");
  list("--variants", a->selection.variants, "only these, in this order");
  command->add_option("--over", a->selection.baseline,
                      "the variant that ratios are against; default: the run's. Contrasts of borders are no ratios");
  command->callback([=] { fmt::print("{}", markdownTables(loadResults(a->file), a->selection)); });
}

}  // namespace experiments
