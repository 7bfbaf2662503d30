// `twofold predict`: the bookkeeping of a schedule of sample counts, as JSON.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/files.h"
#include "experiments/commands.h"
#include "experiments/json_text.h"
#include "experiments/predict.h"

namespace experiments {

namespace {

struct PredictArguments {
  std::string decay, counts, file;
  bool countsGiven = false, fileGiven = false;
};

std::vector<double> countsFromFile(const std::string& file) {
  std::string text;
  try {
    text = core::readFile(file);
  } catch (const core::Error& e) {
    throw core::UsageError("--counts-file", e.what(), "name a text file of sample counts");
  }
  return parseCounts(text, file);
}

std::vector<double> countsOf(const PredictArguments& arguments) {
  if (arguments.countsGiven == arguments.fileGiven)
    throw core::UsageError("predict", arguments.fileGiven ? "both --counts and --counts-file" : "no sample counts",
                           "give either --counts or --counts-file");
  return arguments.countsGiven ? parseCounts(arguments.counts, "--counts") : countsFromFile(arguments.file);
}

void predict(const PredictArguments& arguments) {
  Prediction prediction(parseDecay(arguments.decay, "--decay"));
  const std::vector<double> counts = countsOf(arguments);
  fmt::print("{{\"frames\": [");
  for (std::size_t i = 0; i < counts.size(); ++i) {
    prediction.advance(counts[i]);
    fmt::print("{}\n  {}", i ? "," : "", compactText(predictionJson(prediction, counts[i])));
  }
  fmt::print("\n]}}\n");
}

}  // namespace

void addPredictCommand(CLI::App& app) {
  auto arguments = std::make_shared<PredictArguments>();
  CLI::App* command = app.add_subcommand("predict", "weights, power sums, ages and variances of a schedule, as JSON");
  command->add_option("--decay", arguments->decay, "share of the history kept every frame, in [0, 1]")->required();
  auto* counts = command->add_option("--counts", arguments->counts, "samples of each frame, such as 1,1,8,0,1");
  auto* file = command->add_option("--counts-file", arguments->file, "file with the same, commas, spaces or lines");
  command->callback([=] {
    arguments->countsGiven = counts->count() > 0;
    arguments->fileGiven = file->count() > 0;
    predict(*arguments);
  });
}

}  // namespace experiments
