#include "experiments/efficiency/efficiency.h"

#include <fmt/format.h>

#include <map>
#include <optional>

#include "core/files.h"
#include "experiments/efficiency/analysis.h"
#include "experiments/efficiency/measure.h"
#include "experiments/efficiency/overview.h"
#include "experiments/json_text.h"
#include "experiments/parts.h"
#include "experiments/progress.h"
#include "experiments/report.h"
#include "experiments/scene_source.h"
#include "experiments/scenes/builtin.h"

namespace experiments::efficiency {
namespace {

namespace fs = std::filesystem;

/// Steps of progress of one reference frame, in samples a pixel of a method: a rough guess for the time left.
std::int64_t stepsOfReference(const EfficiencyConfig& config) {
  constexpr int kReferenceSamples = 8;  // in the time of one sample of a method
  return std::max(1, 2 * config.reference.samples / kReferenceSamples);
}

class Runner {
 public:
  Runner(const EfficiencyConfig& config, fs::path folder)
      : config_(config), experiment_(experimentOf(config)), folder_(std::move(folder)) {
    results_.config = toJson(config);
    results_.baseline = labelOf(config.target, targetCountOf(config, methodsOf(config)));
    results_.provenance = currentProvenance();
  }

  Results run() {
    for (const std::string& source : config_.scenes)  // a broken file ends the run before anything is written
      if (!isBuiltin(source)) files_.emplace(source, loadScene(source));
    parts_.emplace(folder_ / "parts", identity());
    const std::int64_t steps =
        std::ssize(config_.seeds) * workOf(config_) + std::ssize(referenceFrames()) * stepsOfReference(config_);
    progress_.emplace("samples a pixel", steps * std::ssize(config_.scenes));
    for (const std::string& source : config_.scenes) runScene(source);
    progress_.reset();
    results_.passes = medianPasses(results_.passes);
    sortCanonically(results_);
    save();
    return std::move(results_);
  }

 private:
  /// What times and errors depend on.
  Json identity() const {
    Json identity = toJson(config_);
    for (const char* key : {"seeds", "scenes", "target", "targetCount", "baselines"}) identity.erase(key);
    identity["threads"] = results_.provenance.threads;
    return identity;
  }

  std::vector<int> referenceFrames() const {
    std::vector<int> frames;
    for (int frame = config_.warmUp; frame < experiment_.frames; ++frame)
      if (hasReference(experiment_, frame)) frames.push_back(frame);
    return frames;
  }

  void runScene(const std::string& source) {
    const auto file = files_.find(source);
    const core::Scene scene = file != files_.end() ? std::move(file->second) : loadScene(source, folder_ / "scenes");
    const std::string label = sceneLabel(source), hash = contentHash(scene);
    for (const auto& warning : scene.warnings) notes_.push_back(label + ": " + warning);
    const Stage stage(scene);
    References references(stage, experiment_, hash);
    for (const int frame : referenceFrames()) {
      references.at(frame);
      progress_->advance(stepsOfReference(config_), label + ", reference of frame " + std::to_string(frame));
    }
    for (const std::uint64_t seed : config_.seeds) add(label, sequence(stage, label, hash, seed, references));
  }

  SequenceResult sequence(const Stage& stage, const std::string& label, const std::string& hash, std::uint64_t seed,
                          References& references) {
    if (std::optional<SequenceResult> part = parts_->read(label, hash, seed)) {
      progress_->skip(workOf(config_));
      return std::move(*part);
    }
    SequenceResult result = measure(stage, config_, label, seed, references, [&](std::int64_t samples) {
      progress_->advance(samples, label + ", seed " + std::to_string(seed));
    });
    parts_->write(result, label, hash, seed);
    return result;
  }

  void add(const std::string& label, const SequenceResult& result) {
    results_.rows.insert(results_.rows.end(), result.rows.begin(), result.rows.end());
    results_.passes.insert(results_.passes.end(), result.passes.begin(), result.passes.end());
    if (result.badPixels > 0)
      notes_.push_back(fmt::format("{}: {} pixels were not finite and black", label, result.badPixels));
  }

  void save() const {
    const Findings findings = analyse(config_, targetCountOf(config_, methodsOf(config_)), results_.rows);
    Json json = resultsJson(results_);
    for (const char* key : {"points", "equal_error", "by_lights"}) json[key] = Json::array();
    for (const Point& p : findings.points) json["points"].push_back(pointJson(p));
    for (const EqualError& e : findings.equal) json["equal_error"].push_back(equalErrorJson(e));
    for (const ByLights& l : findings.byLights) json["by_lights"].push_back(byLightsJson(l));
    core::writeFileAtomically(folder_ / "results.json", listedText(json));
    core::writeFileAtomically(folder_ / "results.csv", resultsCsv(results_));
    saveReport(
        {"Twofold efficiency: " + folder_.filename().string(), results_, {}, overviewHtml(config_, results_), notes_},
        folder_ / "report.html");
  }

  const EfficiencyConfig& config_;
  const Config experiment_;
  const fs::path folder_;
  Results results_;
  std::vector<std::string> notes_;
  std::map<std::string, core::Scene> files_;  ///< scenes loaded from files, until they are run
  std::optional<Parts> parts_;
  std::optional<Progress> progress_;
};

}  // namespace

Results runEfficiency(const EfficiencyConfig& config, const fs::path& folder) { return Runner(config, folder).run(); }

}  // namespace experiments::efficiency
