// Frames without a renderer: a flat wall, a signal, gamma noise whose variance falls with the sample count.
#pragma once

#include <cmath>
#include <functional>

#include "experiments/pipeline.h"

namespace tests {

/// A wall that fills the image, one surface, all pixels alike.
inline core::GuideImages wall(int width, int height) {
  core::GuideImages g(width, height);
  g.depth.fill(4);
  g.depthSlope.fill(0.01f);
  g.id.fill(1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) g.normal.view().store(x, y, core::vec3(0, 0, 1));
  return g;
}

/// Mean of n exponential variates of mean 1: relative variance 1 / n, as skewed as light samples are.
inline float noise(core::Rng& rng, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum -= std::log(1 - 0.999999 * rng.uniform());
  return n > 0 ? static_cast<float>(sum / n) : 0.0f;
}

/// A sequence of frames on a wall: signal(x, y, frame) times noise, counts(x, y, frame) samples, each of which is the
/// mean of so many exponential variates (relative noise of a sample: 1 / sqrt of that).
class Synthetic {
 public:
  using Signal = std::function<core::vec3(int, int, int)>;
  using Counts = std::function<int(int, int, int)>;

  Synthetic(int width, int height, std::uint64_t seed, Signal signal, Counts counts, int variatesPerSample = 1)
      : seed_(seed),
        signal_(std::move(signal)),
        counts_(std::move(counts)),
        variates_(variatesPerSample),
        guide_(wall(width, height)),
        radiance_(width, height),
        albedo_(width, height, 1),
        emission_(width, height, 0),
        samples_(width, height),
        taps_(width, height) {}

  experiments::Shaded frame(int number) {
    const int width = samples_.width();
    core::forEachPixel(width, samples_.height(), [&](int x, int y) {
      core::Rng rng(seed_, core::Pass::lab, static_cast<std::uint32_t>(y * width + x),
                    static_cast<std::uint32_t>(number));
      const int n = counts_(x, y, number);
      samples_(x, y) = static_cast<float>(n);
      radiance_.view().store(x, y, noise(rng, n * variates_) * signal_(x, y, number));
      taps_(x, y) = number > 0 ? twohistory::stillTap(y * width + x) : twohistory::Taps{};
    });
    return {radiance_, albedo_, emission_, samples_, guide_.view(), guide_.view(), {}, taps_};
  }
  core::vec3 truth(int x, int y, int number) const { return signal_(x, y, number); }
  core::GuideImages& guide() { return guide_; }
  core::Planes& radiance() { return radiance_; }

 private:
  std::uint64_t seed_;
  Signal signal_;
  Counts counts_;
  int variates_;
  core::GuideImages guide_;
  core::Planes radiance_, albedo_, emission_;
  core::Image<float> samples_;
  core::Image<twohistory::Taps> taps_;
};

/// Filters `frames` frames; returns the last image.
inline core::Planes filterSequence(Synthetic& input, const experiments::Variant& variant, int frames) {
  const core::Guide guide = input.guide().view();
  experiments::FilterState state(variant, guide.width(), guide.height());
  core::Planes out(guide.width(), guide.height());
  for (int i = 0; i < frames; ++i) experiments::filter(input.frame(i), variant, {}, state, out);
  return out;
}

/// Mean squared error of an image against the truth of a frame.
inline double squaredError(const core::Planes& image, const Synthetic& input, int frame) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const core::vec3 d = image.view().load(x, y) - input.truth(x, y, frame);
      sum += dot(d, d) / 3;
    }
  return sum / (image.width() * image.height());
}

}  // namespace tests
