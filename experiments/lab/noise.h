// The noise of the laboratory: a factor of mean 1 on the truth, as light samples make it and as reuse leaves it.
#pragma once

#include "core/image.h"
#include "core/random.h"
#include "twohistory/taps.h"

namespace experiments::lab {

struct NoiseParameters {
  float sigma = 1.5f;   ///< relative standard deviation of one sample; gamma distributed
  float fireflies = 0;  ///< probability of a sample `fireflyFactor` times as bright
  float fireflyFactor = 100;
  float held = 0;       ///< probability that a pixel keeps the noise of the frame before, as ReSTIR does
  bool shared = false;  ///< averaged over 3x3 pixels, its variance kept: as spatial reuse does
};

template <class V>
void describe(V& v, NoiseParameters& p) {
  v("sigma", p.sigma, "relative standard deviation of one sample", 0.0, 100.0);
  v("fireflies", p.fireflies, "probability that a sample is a firefly", 0.0, 0.5);
  v("fireflyFactor", p.fireflyFactor, "how much brighter a firefly is", 1.0, 1e6);
  v("held", p.held, "probability that a pixel keeps the noise of the frame before", 0.0, 0.999);
  v("shared", p.shared, "noise correlated over 3x3 pixels, its variance kept");
}

/// Gamma variate of mean 1 and this shape > 0, so of variance 1 / shape.
/// Source: Marsaglia, Tsang, "A Simple Method for Generating Gamma Variables" (2000); shape < 1 by their boost.
float gammaVariate(core::Rng& rng, float shape);

/// A field of noise factors that goes on from frame to frame.
class NoiseField {
 public:
  NoiseField(const NoiseParameters& parameters, std::uint64_t seed, int width, int height);

  /// Draws frame `frame`. n: sample counts; where 0 the factor means nothing. taps: into the frame before.
  void advance(core::In<float> n, core::In<twohistory::Taps> taps, std::uint32_t frame);
  /// Factor of mean 1 at a pixel.
  float at(int x, int y) const;
  /// Whether factors of one frame depend on those of another pixel or frame.
  bool isReused() const { return parameters_.held > 0 || parameters_.shared; }
  /// A factor that does not, for a pixel of n samples.
  float independent(int x, int y, float n, std::uint32_t frame) const;

 private:
  float fresh(core::Rng& rng, float n, bool shared) const;

  NoiseParameters parameters_;
  std::uint64_t seed_;
  core::Image<float> now_, before_;
};

}  // namespace experiments::lab
