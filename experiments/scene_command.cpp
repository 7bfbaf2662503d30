// `twofold scene`: built-in scenes as glTF files.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/check.h"
#include "core/glb.h"
#include "experiments/commands.h"
#include "experiments/scenes/builtin.h"

namespace experiments {

namespace {

struct SceneArguments {
  bool list = false;
  std::string name, output;
};

void scene(const SceneArguments& arguments) {
  if (arguments.list == !arguments.name.empty())
    throw core::UsageError("scene", arguments.list ? "both a name and --list" : "no scene is named",
                           "give a name and -o FILE.glb, or --list alone");
  if (arguments.list) {
    for (const std::string& name : builtinSceneNames()) fmt::print("{}\n", name);
    return;
  }
  if (arguments.output.empty()) throw core::UsageError("scene", "no output file is named", "add -o FILE.glb");
  if (!arguments.output.ends_with(".glb"))
    throw core::UsageError("scene", "'" + arguments.output + "' does not end in .glb", "name a .glb file");
  core::saveGlb(builtinScene(arguments.name), arguments.output);
}

}  // namespace

void addSceneCommand(CLI::App& app) {
  auto arguments = std::make_shared<SceneArguments>();
  CLI::App* command = app.add_subcommand("scene", "writes a built-in scene as binary glTF");
  command->add_option("name", arguments->name, "name of a built-in scene");
  command->add_option("-o,--output", arguments->output, "file to write, FILE.glb");
  command->add_flag("--list", arguments->list, "lists the names of the built-in scenes");
  command->callback([=] { scene(*arguments); });
}

}  // namespace experiments
