#include "experiments/runner.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "experiments/gallery.h"
#include "experiments/parts.h"
#include "experiments/progress.h"
#include "experiments/report.h"
#include "experiments/scene_source.h"
#include "experiments/scenes/builtin.h"

namespace experiments {
namespace {

namespace fs = std::filesystem;

/// One experiment while it runs.
class Runner {
 public:
  Runner(const Config& config, fs::path folder)
      : config_(config),
        folder_(std::move(folder)),
        variants_(variantsOf(config)),
        gallery_(config_, folder_ / "images") {
    config_.output.frames = galleryFrames(config);
    results_.config = toJson(config_);
    results_.baseline = baselineOf(config_);
    results_.provenance = currentProvenance();
  }

  Results run() {
    loadFiles();
    Json identity = toJson(config_);
    identity.erase("seeds");
    identity.erase("scenes");
    parts_.emplace(folder_ / "parts", std::move(identity));
    const auto sequences = static_cast<std::int64_t>(config_.scenes.size() * config_.seeds.size());
    progress_.emplace("frames", sequences * config_.frames + referenceSteps() * std::ssize(config_.scenes));
    for (const std::string& scene : config_.scenes) runScene(scene);
    progress_.reset();
    results_.passes = medianPasses(results_.passes);
    const std::vector<Row> means = meansOverFrames(results_.series);
    results_.rows.insert(results_.rows.end(), means.begin(), means.end());
    sortCanonically(results_);
    saveResults(results_, folder_);
    saveReport({"Twofold: " + folder_.filename().string(), results_, figures_, "", notes_}, folder_ / "report.html");
    return std::move(results_);
  }

 private:
  /// Work of one reference frame in units of a frame of a sequence: a rough guess that keeps the time left honest.
  std::int64_t stepsOfReference() const {
    constexpr int kSamplesPerVariant = 4;  // both halves' samples a pixel that cost as much as filtering one variant
    return std::max<std::int64_t>(1,
                                  2 * config_.reference.samples / (kSamplesPerVariant * (std::ssize(variants_) + 4)));
  }
  std::int64_t referenceSteps() const {
    std::int64_t frames = 0;
    for (int frame = 0; frame < config_.frames; ++frame) frames += hasReference(config_, frame);
    return frames * stepsOfReference();
  }

  /// Files first, so that a broken one ends the run before anything is written.
  void loadFiles() {
    environment_ = environmentOf(config_.scene);
    for (const std::string& source : config_.scenes)
      if (!isBuiltin(source)) files_.emplace(source, loadScene(source, {}, environment_));
  }

  void runScene(const std::string& source) {
    const auto file = files_.find(source);
    const core::Scene scene =
        file != files_.end() ? std::move(file->second) : loadScene(source, folder_ / "scenes", environment_);
    const std::string label = sceneLabel(source), hash = contentHash(scene);
    for (const auto& warning : scene.warnings) notes_.push_back(label + ": " + warning);
    const Stage stage(scene);
    References references(stage, config_, hash);
    renderReferences(label, references);
    std::vector<BorderContrasts> borders;
    for (const std::uint64_t seed : config_.seeds) {
      SequenceResult result = sequence(stage, label, hash, seed, references);
      borders.insert(borders.end(), result.borders.begin(), result.borders.end());
      add(label, std::move(result));
    }
    for (Row& row : systematicRows(label, borders))
      if (std::isfinite(row.value)) results_.rows.push_back(std::move(row));
    std::vector<std::string> names;
    for (const Variant& v : variants_) names.push_back(v.name);
    for (Figure& figure : gallery_.figures(label, names)) figures_.push_back(std::move(figure));
  }

  void renderReferences(const std::string& label, References& references) {
    const auto& shown = config_.output.frames;
    for (int frame = 0; frame < config_.frames; ++frame) {
      if (!hasReference(config_, frame)) continue;
      const ReferenceFrame& reference = references.at(frame);
      if (std::find(shown.begin(), shown.end(), frame) != shown.end())
        gallery_.addReference(label, frame, reference.mean());
      progress_->advance(stepsOfReference(), label + ", reference of frame " + std::to_string(frame));
    }
  }

  SequenceResult sequence(const Stage& stage, const std::string& label, const std::string& hash, std::uint64_t seed,
                          References& references) {
    if (std::optional<SequenceResult> part = parts_->read(label, hash, seed)) {
      progress_->skip(config_.frames);
      return std::move(*part);
    }
    SequenceHooks hooks;
    if (seed == config_.seeds.front()) {
      hooks.image = [&](const FrameImage& image) { gallery_.add(label, image); };
      hooks.diagnostics = [&](int frame, const restir::Diagnostics& d) { gallery_.addDiagnostics(label, frame, d); };
    }
    hooks.frameDone = [&] { progress_->advance(1, label + ", seed " + std::to_string(seed)); };
    SequenceResult result = runSequence(stage, config_, variants_, label, seed, references, hooks);
    parts_->write(result, label, hash, seed);
    return result;
  }

  void add(const std::string& label, SequenceResult result) {
    results_.rows.insert(results_.rows.end(), result.rows.begin(), result.rows.end());
    results_.series.insert(results_.series.end(), result.series.begin(), result.series.end());
    results_.passes.insert(results_.passes.end(), result.passes.begin(), result.passes.end());
    if (result.badPixels > 0)
      notes_.push_back(
          fmt::format("{}: {} pixels were not finite and counted as frames without samples", label, result.badPixels));
  }

  Config config_;
  fs::path folder_;
  std::vector<Variant> variants_;
  Gallery gallery_;
  Results results_;
  std::vector<Figure> figures_;
  std::vector<std::string> notes_;
  std::shared_ptr<const core::Environment> environment_;  ///< of every scene; null = none
  std::map<std::string, core::Scene> files_;              ///< scenes loaded from files, until they are run
  std::optional<Parts> parts_;
  std::optional<Progress> progress_;
};

}  // namespace

Results runExperiment(const Config& config, const std::filesystem::path& folder) {
  return Runner(config, folder).run();
}

}  // namespace experiments
