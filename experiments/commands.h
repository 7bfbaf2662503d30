// The subcommands of `twofold`. Each add...Command registers one; its body runs when the line has been parsed, and
// throws core::UsageError (exit code 2) or core::Error (exit code 1).
#pragma once

namespace CLI {
class App;
}

namespace experiments {

void addRunCommand(CLI::App& app);
void addRenderCommand(CLI::App& app);
void addCompareCommand(CLI::App& app);
void addSceneCommand(CLI::App& app);
void addLabCommand(CLI::App& app);
void addEfficiencyCommand(CLI::App& app);
void addPredictCommand(CLI::App& app);
void addTableCommand(CLI::App& app);

}  // namespace experiments
