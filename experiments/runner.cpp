#include "experiments/runner.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "core/files.h"
#include "core/random.h"
#include "core/statistics.h"
#include "experiments/gallery.h"
#include "experiments/json_text.h"
#include "experiments/progress.h"
#include "experiments/report.h"
#include "experiments/scene_source.h"
#include "experiments/scenes/builtin.h"
#include "experiments/sequence.h"

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
    makeFolder(folder_ / "parts");
    const auto sequences = static_cast<std::int64_t>(config_.scenes.size() * config_.seeds.size());
    progress_.emplace("frames", sequences * config_.frames + referenceSteps() * std::ssize(config_.scenes));
    for (const std::string& scene : config_.scenes) runScene(scene);
    progress_.reset();
    averagePasses();
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
    for (const std::string& source : config_.scenes)
      if (!isBuiltin(source)) files_.emplace(source, loadScene(source));
  }

  static void makeFolder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw core::Error(folder.string(), error.message(), "name a folder that can be written");
  }

  void runScene(const std::string& source) {
    const auto file = files_.find(source);
    const core::Scene scene = file != files_.end() ? std::move(file->second) : loadScene(source, folder_ / "scenes");
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
    const fs::path part = partFile(label, hash, seed);
    if (fs::exists(part)) {
      progress_->skip(config_.frames);
      return readPart(part);
    }
    SequenceHooks hooks;
    if (seed == config_.seeds.front()) hooks.image = [&](const FrameImage& image) { gallery_.add(label, image); };
    hooks.frameDone = [&] { progress_->advance(1, label + ", seed " + std::to_string(seed)); };
    SequenceResult result = runSequence(stage, config_, variants_, label, seed, references, hooks);
    writePart(result, part);
    return result;
  }

  /// Parts are named by everything that decides their content, so a changed configuration never reuses one.
  fs::path partFile(const std::string& label, const std::string& hash, std::uint64_t seed) const {
    Json identity = toJson(config_);
    identity.erase("seeds");
    identity.erase("scenes");
    identity["version"] = results_.provenance.version + results_.provenance.commit;
    const std::uint64_t key = core::mixBits(std::hash<std::string>{}(identity.dump() + hash));
    return folder_ / "parts" / fmt::format("{}-{}-{:016x}.json", label, seed, key);
  }

  /// A part is a results file of one sequence.
  static void writePart(const SequenceResult& result, const fs::path& file) {
    Results part;
    part.rows = result.rows;
    part.series = result.series;
    part.passes = result.passes;
    part.config["badPixels"] = result.badPixels;
    part.config["borders"] = Json::array();
    for (const BorderContrasts& b : result.borders)
      part.config["borders"].push_back(
          {{"variant", b.variant}, {"region", b.region}, {"seed", b.seed}, {"contrasts", b.contrasts}});
    core::writeFileAtomically(file, resultsJson(part).dump());
  }
  static SequenceResult readPart(const fs::path& file) {
    Results part = loadResults(file);
    std::vector<BorderContrasts> borders;
    for (const Json& b : part.config.value("borders", Json::array()))
      borders.push_back({b.at("variant"), b.at("region"), b.at("seed"), b.at("contrasts")});
    return {std::move(part.rows), std::move(part.series), std::move(borders), std::move(part.passes),
            part.config.value("badPixels", std::int64_t{0})};
  }

  void add(const std::string& label, SequenceResult result) {
    results_.rows.insert(results_.rows.end(), result.rows.begin(), result.rows.end());
    results_.series.insert(results_.series.end(), result.series.begin(), result.series.end());
    results_.passes.insert(results_.passes.end(), result.passes.begin(), result.passes.end());
    if (result.badPixels > 0)
      notes_.push_back(
          fmt::format("{}: {} pixels were not finite and counted as frames without samples", label, result.badPixels));
  }

  /// Seeds render the same work: one row a pass, the median over seeds.
  void averagePasses() {
    std::vector<PassTime> merged;
    std::vector<std::vector<double>> times;
    for (const PassTime& p : results_.passes) {
      std::size_t i = 0;
      while (i < merged.size() &&
             !(merged[i].scene == p.scene && merged[i].variant == p.variant && merged[i].pass == p.pass))
        ++i;
      if (i == merged.size()) merged.push_back(p), times.emplace_back();
      times[i].push_back(p.ms);
    }
    for (std::size_t i = 0; i < merged.size(); ++i) merged[i].ms = core::median(times[i]);
    results_.passes = std::move(merged);
  }

  Config config_;
  fs::path folder_;
  std::vector<Variant> variants_;
  Gallery gallery_;
  Results results_;
  std::vector<Figure> figures_;
  std::vector<std::string> notes_;
  std::map<std::string, core::Scene> files_;  ///< scenes loaded from files, until they are run
  std::optional<Progress> progress_;
};

}  // namespace

Results runExperiment(const Config& config, const std::filesystem::path& folder) {
  return Runner(config, folder).run();
}

}  // namespace experiments
