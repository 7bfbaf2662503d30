// The program `twofold`: parses the command line, runs one command, and turns every failure into one line.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>

#include "core/check.h"
#include "experiments/commands.h"
#include "experiments/provenance.h"

namespace {

enum ExitCode { kSuccess = 0, kFailure = 1, kWrongUsage = 2 };

int report(ExitCode code, std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < ' '; }, ' ');
  fmt::print(stderr, "twofold: {}\n", message);
  return code;
}

void addCommands(CLI::App& app) {
  app.require_subcommand(1);
  app.set_version_flag("--version", experiments::programVersion());
  experiments::addRunCommand(app);
  experiments::addRenderCommand(app);
  experiments::addCompareCommand(app);
  experiments::addSceneCommand(app);
  experiments::addLabCommand(app);
  experiments::addEfficiencyCommand(app);
  experiments::addPredictCommand(app);
  experiments::addTableCommand(app);
}

int run(int argc, char** argv) {
  CLI::App app("Twofold: a laboratory for sample reuse in Monte Carlo rendering", "twofold");
  addCommands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    app.exit(e);
  } catch (const CLI::ParseError& e) {
    return report(kWrongUsage, std::string(e.what()) + "; see twofold --help");
  }
  if (std::fflush(stdout) != 0) return report(kFailure, "standard output: cannot be written; check the disk");
  return kSuccess;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const core::UsageError& e) {
    return report(kWrongUsage, e.what());
  } catch (const std::bad_alloc&) {
    return report(kFailure, "out of memory; use a smaller resolution or fewer variants");
  } catch (const std::exception& e) {
    return report(kFailure, e.what());
  }
}
