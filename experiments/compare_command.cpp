// `twofold compare`: metrics of one image against another, as JSON.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "experiments/commands.h"
#include "experiments/compare.h"
#include "experiments/json_text.h"

namespace experiments {

namespace {

struct CompareArguments {
  std::string reference, test, layer;
};

void compare(const CompareArguments& a) {
  fmt::print("{}\n", compactText(compareFiles(a.reference, a.test, a.layer), 2));
}

}  // namespace

void addCompareCommand(CLI::App& app) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand("compare", "metrics of one image against another, as JSON");
  command->add_option("reference", arguments->reference, "OpenEXR file taken as the truth")->required();
  command->add_option("test", arguments->test, "OpenEXR file of the same size")->required();
  command->add_option("--layer", arguments->layer, "compare LAYER.R, LAYER.G, LAYER.B instead of R, G, B");
  command->callback([=] { compare(*arguments); });
}

}  // namespace experiments
