#include "experiments/lab/noise.h"

#include <cmath>

#include "core/parallel.h"

namespace experiments::lab {
namespace {

constexpr float kSharedBy = 9;  ///< pixels of a 3x3 window

/// Standard normal variate (Box and Muller).
double normalVariate(core::Rng& rng) {
  const double u = 1 - static_cast<double>(rng.uniform()), v = rng.uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * 3.14159265358979323846 * v);
}

/// Gamma variate of this shape >= 1 and scale 1.
double largeGamma(core::Rng& rng, double shape) {
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double x = normalVariate(rng), v = std::pow(1 + c * x, 3);
    if (!(v > 0)) continue;
    const double u = 1 - static_cast<double>(rng.uniform());
    if (std::log(u) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
  }
}

}  // namespace

float gammaVariate(core::Rng& rng, float shape) {
  const double k = shape;
  if (k >= 1) return static_cast<float>(largeGamma(rng, k) / k);
  const double u = 1 - static_cast<double>(rng.uniform());
  return static_cast<float>(largeGamma(rng, k + 1) * std::pow(u, 1 / k) / k);
}

NoiseField::NoiseField(const NoiseParameters& p, std::uint64_t seed, int width, int height)
    : parameters_(p), seed_(seed), now_(width, height), before_(width, height) {}

/// Mean of n independent samples' factors. The variance that sharing over a window takes away is drawn in advance.
float NoiseField::fresh(core::Rng& rng, float n, bool shared) const {
  const NoiseParameters& p = parameters_;
  const float count = std::max(n, 1.0f), spread = p.sigma * p.sigma * (shared ? kSharedBy : 1.0f);
  float factor = spread > 0 ? gammaVariate(rng, count / spread) : 1;
  if (p.fireflies > 0) {
    float bright = 0;
    for (int i = 0; i < static_cast<int>(count); ++i) bright += rng.uniform() < p.fireflies ? 1.0f : 0.0f;
    const float more = p.fireflyFactor - 1;
    factor *= (1 + more * bright / count) / (1 + more * p.fireflies);
  }
  return factor;
}

void NoiseField::advance(core::In<float> n, core::In<twohistory::Taps> taps, std::uint32_t frame) {
  std::swap(now_, before_);
  core::forEachPixel(n.width, n.height, [&](int x, int y) {
    core::Rng rng(seed_, core::Pass::lab, static_cast<std::uint32_t>(y * n.width + x), frame);
    const bool kept = parameters_.held > 0 && taps(x, y).valid() && rng.uniform() < parameters_.held;
    now_(x, y) = kept ? before_.data()[chooseTap(taps(x, y), twohistory::Choice::stochastic, rng.uniform()).pixel[0]]
                      : fresh(rng, n(x, y), parameters_.shared);
  });
}

float NoiseField::independent(int x, int y, float n, std::uint32_t frame) const {
  core::Rng rng(seed_, core::Pass::other, static_cast<std::uint32_t>(y * now_.width() + x), frame);
  return fresh(rng, n, false);
}

float NoiseField::at(int x, int y) const {
  if (!parameters_.shared) return now_(x, y);
  float sum = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      sum += now_(std::clamp(x + dx, 0, now_.width() - 1), std::clamp(y + dy, 0, now_.height() - 1));
  return sum / kSharedBy;
}

}  // namespace experiments::lab
