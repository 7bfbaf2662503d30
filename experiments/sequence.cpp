#include "experiments/sequence.h"

#include <algorithm>

#include "core/parallel.h"

namespace experiments {
namespace {

using core::Planes;
using core::PlanesView;

double luminanceSum(PlanesView<const float> image) {
  const std::int64_t width = image.width();
  return core::deterministicSum(width * image.height(), [&](std::int64_t i) {
    return static_cast<double>(core::luminance(image.load(static_cast<int>(i % width), static_cast<int>(i / width))));
  });
}

void fillLuminance(PlanesView<const float> image, core::Image<float>& out) {
  core::forEachPixel(out.width(), out.height(), [&](int x, int y) { out(x, y) = core::luminance(image.load(x, y)); });
}

/// Everything that is kept while a sequence runs.
class Sequence {
 public:
  Sequence(const Stage& stage, const Config& config, const std::vector<Variant>& variants, const std::string& scene,
           std::uint64_t seed, References& references, const SequenceHooks& hooks)
      : stage_(stage),
        config_(config),
        variants_(variants),
        scene_(scene),
        seed_(seed),
        references_(references),
        hooks_(hooks),
        shading_(stage, config.shade, seed, config.width, config.height),
        memory_(config.width, config.height),
        image_(config.width, config.height),
        target_(config.width, config.height),
        luminance_(config.width, config.height),
        halves_{luminance_, luminance_},
        energy_(variants.size() + 1),
        borders_(variants.size() + 1) {
    for (const Variant& v : variants) filters_.push_back(std::make_unique<FilterState>(v, config.width, config.height));
  }

  SequenceResult run() {
    for (int frame = 0; frame < config_.frames; ++frame) {
      if (frame == 1) forgetTimes();
      runFrame(frame);
      if (hooks_.frameDone) hooks_.frameDone();
    }
    finish();
    return std::move(result_);
  }

 private:
  static constexpr const char* kRaw = "raw";

  void runFrame(int frame) {
    const Shaded shaded = shade(stage_, config_.shade, static_cast<std::uint32_t>(frame), shading_);
    memory_.advance(shaded.guide, shading_.fovea());
    const ReferenceFrame* reference = hasReference(config_, frame) ? &references_.at(frame) : nullptr;
    std::optional<Reference> truth;
    if (reference) {
      truth.emplace(reference->view());
      demodulate(reference->mean(), shaded, target_);
      fillLuminance(truth->first(), halves_[0]), fillLuminance(truth->second(), halves_[1]);
    }
    const Reference* compared = truth ? &*truth : nullptr;

    if (shading_.diagnostics() && hooks_.diagnostics && isShown(frame))
      hooks_.diagnostics(frame, *shading_.diagnostics());
    remodulate(shaded.radiance, shaded, image_);
    measure(frame, kRaw, 0, compared);
    for (std::size_t v = 0; v < variants_.size(); ++v) {
      const PlanesView<const float> target = reference ? target_.view() : PlanesView<float>{};
      filter(shaded, variants_[v], target, *filters_[v], image_);
      measure(frame, variants_[v].name, v + 1, compared);
    }
  }

  bool isShown(int frame) const {
    const auto& wanted = config_.output.frames;
    return std::find(wanted.begin(), wanted.end(), frame) != wanted.end();
  }

  /// Books the errors of image_ and hands it on.
  void measure(int frame, const std::string& variant, std::size_t slot, const Reference* reference) {
    energy_[slot] += luminanceSum(image_);
    std::optional<Comparison> comparison;
    if (reference) {
      comparison.emplace(image_, *reference, scene_ + ", " + variant + ", frame " + std::to_string(frame));
      for (const Region region : kRegions) addMetrics(frame, variant, region, *comparison);
      fillLuminance(image_, luminance_);
      for (std::size_t b = 0; b < kBorders.size(); ++b)
        borders_[slot][b].add(luminance_, {halves_[0], halves_[1]}, memory_.mask(kBorders[b]));
    }
    if (hooks_.image && isShown(frame))
      hooks_.image({frame, variant, image_, comparison ? &*comparison : nullptr, shading_.gaze()});
  }

  void addMetrics(int frame, const std::string& variant, Region region, const Comparison& comparison) {
    const Metrics m = comparison.in(memory_.mask(region));
    const std::string name(regionName(region));
    const auto add = [&](const char* metric, double value) {
      result_.series.push_back({scene_, variant, seed_, name, metric, frame, value});
    };
    add("relMSE", m.relMse);
    add("relMSE_trimmed", m.relMseTrimmed);
    add("SSIM", m.ssim);
    add("energy_ratio", m.energyRatio);
  }

  void forgetTimes() {
    shading_.times() = {};
    for (auto& f : filters_) f->times() = {};
  }

  void addBorders(const std::string& variant, const std::array<BorderStep, kBorders.size()>& borders) {
    for (std::size_t b = 0; b < kBorders.size(); ++b) {
      const std::string region(regionName(kBorders[b]));
      result_.rows.push_back({scene_, variant, seed_, region, "border_step", borders[b].meanSquare()});
      result_.rows.push_back({scene_, variant, seed_, region, "border_noise", borders[b].noiseRatio()});
      result_.borders.push_back({variant, region, seed_, borders[b].contrasts()});
    }
  }

  void addPasses(const std::string& variant, const PassTimes& times) {
    const double frames = std::max(1, config_.frames - 1);
    for (const auto& [pass, ms] : times.sums()) result_.passes.push_back({scene_, variant, pass, ms / frames});
  }

  double bytesPerPixel(const FilterState& filter) const {
    return static_cast<double>(filter.bytes()) / config_.width / config_.height;
  }

  void finish() {
    addPasses("shared", shading_.times());
    addBorders(kRaw, borders_[0]);
    for (std::size_t v = 0; v < variants_.size(); ++v) {
      addPasses(variants_[v].name, filters_[v]->times());
      addBorders(variants_[v].name, borders_[v + 1]);
      result_.rows.push_back(
          {scene_, variants_[v].name, seed_, "full", "energy_over_raw", energy_[v + 1] / energy_[0]});
      if (variants_[v].filter.fireflyClamp > 0)
        result_.rows.push_back(
            {scene_, variants_[v].name, seed_, "full", "clamped_energy", filters_[v]->clampedEnergy() / energy_[0]});
      result_.rows.push_back(
          {scene_, variants_[v].name, seed_, "full", "bytes_per_pixel", bytesPerPixel(*filters_[v])});
      result_.badPixels = std::max(result_.badPixels, filters_[v]->badPixels());
    }
    result_.badPixels += shading_.badPixels();
  }

  const Stage& stage_;
  const Config& config_;
  const std::vector<Variant>& variants_;
  const std::string scene_;
  const std::uint64_t seed_;
  References& references_;
  const SequenceHooks& hooks_;
  ShadeState shading_;
  std::vector<std::unique_ptr<FilterState>> filters_;
  FovealMemory memory_;
  Planes image_, target_;
  core::Image<float> luminance_;
  std::array<core::Image<float>, 2> halves_;  ///< luminance of the reference's
  std::vector<double> energy_;                ///< luminance summed over all pixels and frames: raw, then the variants
  std::vector<std::array<BorderStep, kBorders.size()>> borders_;  ///< likewise
  SequenceResult result_;
};

}  // namespace

SequenceResult runSequence(const Stage& stage, const Config& config, const std::vector<Variant>& variants,
                           const std::string& scene, std::uint64_t seed, References& references,
                           const SequenceHooks& hooks) {
  return Sequence(stage, config, variants, scene, seed, references, hooks).run();
}

}  // namespace experiments
