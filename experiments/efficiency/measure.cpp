#include "experiments/efficiency/measure.h"

#include <algorithm>
#include <memory>

#include "core/statistics.h"

namespace experiments::efficiency {
namespace {

using PassMedians = std::vector<std::pair<std::string, double>>;

/// Times of one frame after another.
class FrameTimes {
 public:
  void add(const PassTimes& frame) { frames_.push_back(frame.sums()); }

  /// Median over frames of each pass.
  PassMedians passes() const {
    PassMedians medians;
    for (std::size_t p = 0; !frames_.empty() && p < frames_.front().size(); ++p) {
      std::vector<double> times;
      for (const auto& frame : frames_) times.push_back(frame[p].second);
      medians.emplace_back(frames_.front()[p].first, core::median(times));
    }
    return medians;
  }
  /// Median over frames of all passes' sum.
  double total() const {
    std::vector<double> times;
    for (const auto& frame : frames_) {
      times.push_back(0);
      for (const auto& [pass, ms] : frame) times.back() += ms;
    }
    return core::median(times);
  }

 private:
  std::vector<PassMedians> frames_;
};

/// One method at one count.
struct Contender {
  const Method& method;
  int count;
  core::Image<float> samples;
  restir::RestirState state;
  std::optional<restir::SecondHistory> second;
  core::Planes radiance;
  FrameTimes times;
  std::vector<Metrics> metrics;  ///< of frames with a reference
};

/// First frame that a method renders: those that remember nothing need one frame before those that count, in which
/// memory is allocated.
int firstFrame(const EfficiencyConfig& config, const Method& method) {
  return method.remembers() ? 0 : std::max(0, config.warmUp - 1);
}

class Measurement {
 public:
  Measurement(const Stage& stage, const EfficiencyConfig& config, const std::string& scene, std::uint64_t seed,
              References& references)
      : stage_(stage),
        config_(config),
        experiment_(experimentOf(config)),
        scene_(scene),
        seed_(seed),
        references_(references),
        methods_(methodsOf(config)),
        view_(config.width, config.height),
        albedo_(config.width, config.height),
        image_(config.width, config.height) {
    const int w = config.width, h = config.height;
    for (const Method& m : methods_)
      for (const int n : m.counts)
        contenders_.push_back(std::make_unique<Contender>(
            Contender{m, n, {w, h, static_cast<float>(n)}, restir::RestirState(w, h), {}, core::Planes(w, h), {}, {}}));
    for (const auto& c : contenders_)
      if (c->method.restir.second.on) c->second.emplace(w, h);
  }

  SequenceResult run(const std::function<void(std::int64_t)>& advanced) {
    for (int frame = 0; frame < experiment_.frames; ++frame) {
      const std::int64_t samples = runFrame(frame);
      if (advanced) advanced(samples);
    }
    for (const auto& c : contenders_) addRows(*c);
    for (const auto& [pass, ms] : shared_.passes()) addPass("shared", pass, ms);
    return std::move(result_);
  }

 private:
  std::int64_t runFrame(int frame) {
    lookAt(frame);
    const bool counts = frame >= config_.warmUp;
    std::optional<Reference> truth;
    if (counts && hasReference(experiment_, frame)) truth.emplace(references_.at(frame).view());
    std::int64_t samples = 0;
    for (const auto& c : contenders_) {
      if (frame < firstFrame(config_, c->method)) continue;
      samples += c->count;
      shade(*c, counts);
      if (truth) compare(*c, frame, *truth);
    }
    return samples;
  }

  /// What all contenders share of a frame.
  void lookAt(int frame) {
    PassTimes times;
    see(stage_, experiment_.shade, static_cast<std::uint32_t>(frame), view_, times);
    if (frame == 0) addPass("shared", "first pose (builds lights and the scene's tree)", times.sums().front().second);
    if (frame >= config_.warmUp) shared_.add(times);
    fillAlbedo(view_.now().gbuffer.surfaces, albedo_);
  }

  void shade(Contender& c, bool counts) {
    const core::Moment now = view_.now().moment(), before = view_.before().moment();
    PassTimes times;
    const restir::Frame frame{now, before, c.samples, view_.taps(), seed_, config_.render.tile};
    shadeLights(c.method.restir, frame, {c.state, c.second ? &*c.second : nullptr}, {}, c.radiance, times);
    if (counts) c.times.add(times);
  }

  void compare(Contender& c, int frame, const Reference& truth) {
    Shaded shaded{};
    shaded.albedo = albedo_;
    shaded.emission = view_.now().gbuffer.emission;
    remodulate(c.radiance, shaded, image_);
    c.metrics.push_back(
        Comparison(image_, truth, scene_ + ", " + labelOf(c.method.name, c.count) + ", frame " + std::to_string(frame))
            .in());
  }

  void addRows(const Contender& c) {
    const std::string label = labelOf(c.method.name, c.count);
    const auto add = [&](const char* metric, double value) {
      result_.rows.push_back({scene_, label, seed_, "full", metric, value});
    };
    const auto mean = [&](double Metrics::*member) {
      core::RunningMoments moments;
      for (const Metrics& m : c.metrics) moments.add(m.*member);
      return moments.mean();
    };
    add(kTime, c.times.total());
    add("relMSE_trimmed", mean(&Metrics::relMseTrimmed));
    add("relMSE", mean(&Metrics::relMse));
    add("energy_ratio", mean(&Metrics::energyRatio));
    for (const auto& [pass, ms] : c.times.passes()) addPass(label, pass, ms);
    result_.badPixels += c.state.badPixels() + (c.second ? c.second->badPixels() : 0);
  }

  void addPass(const std::string& variant, const std::string& pass, double ms) {
    result_.passes.push_back({scene_, variant, pass, ms});
  }

  const Stage& stage_;
  const EfficiencyConfig& config_;
  const Config experiment_;
  const std::string scene_;
  const std::uint64_t seed_;
  References& references_;
  const std::vector<Method> methods_;
  View view_;
  core::Planes albedo_, image_;
  std::vector<std::unique_ptr<Contender>> contenders_;
  FrameTimes shared_;
  SequenceResult result_;
};

}  // namespace

SequenceResult measure(const Stage& stage, const EfficiencyConfig& config, const std::string& scene, std::uint64_t seed,
                       References& references, const std::function<void(std::int64_t)>& advanced) {
  return Measurement(stage, config, scene, seed, references).run(advanced);
}

std::int64_t workOf(const EfficiencyConfig& config) {
  std::int64_t samples = 0;
  for (const Method& m : methodsOf(config))
    for (const int n : m.counts) samples += std::int64_t{n} * (config.warmUp + config.frames - firstFrame(config, m));
  return samples;
}

}  // namespace experiments::efficiency
