#include "experiments/ssim.h"

#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace experiments {

namespace {

constexpr double kSigma = 1.5, kRange = 1;
constexpr double kC1 = (0.01 * kRange) * (0.01 * kRange), kC2 = (0.03 * kRange) * (0.03 * kRange);
constexpr int kTaps = 2 * kSsimRadius + 1;
using Plane = core::Image<double>;

std::array<double, kTaps> gaussianWeights() {
  std::array<double, kTaps> weights{};
  double sum = 0;
  for (int i = 0; i < kTaps; ++i) {
    const double d = i - kSsimRadius;
    sum += weights[i] = std::exp(-0.5 * d * d / (kSigma * kSigma));
  }
  for (double& w : weights) w /= sum;
  return weights;
}

/// Index reflected at the borders with the edge pixel repeated: d c b a | a b c d | d c b a.
int reflected(int i, int size) {
  const int period = 2 * size;
  i = ((i % period) + period) % period;
  return i < size ? i : period - 1 - i;
}

/// Weighted sum of kTaps rows; tap(i) is the start of the i-th. Folded about the middle, x innermost.
template <class Tap>
void sumTaps(Tap&& tap, int width, double* __restrict out) {
  static const std::array<double, kTaps> weights = gaussianWeights();
  const double* const middle = tap(kSsimRadius);
  for (int x = 0; x < width; ++x) out[x] = weights[kSsimRadius] * middle[x];
  for (int i = 0; i < kSsimRadius; ++i) {
    const double *const before = tap(i), *const after = tap(kTaps - 1 - i);
    const double w = weights[i];
#pragma omp simd
    for (int x = 0; x < width; ++x) out[x] += w * (before[x] + after[x]);
  }
}

/// Separable Gaussian over columns, then rows.
Plane blurred(const Plane& in) {
  const int width = in.width(), height = in.height();
  Plane out(width, height);
  core::forEachRow(height, [&](int y) {
    std::vector<double> padded(static_cast<std::size_t>(width) + 2 * kSsimRadius);
    double* const row = padded.data() + kSsimRadius;
    sumTaps([&](int i) { return in.view().row(reflected(y + i - kSsimRadius, height)); }, width, row);
    for (int x = 1; x <= kSsimRadius; ++x) {
      row[-x] = row[reflected(-x, width)];
      row[width - 1 + x] = row[reflected(width - 1 + x, width)];
    }
    sumTaps([&](int i) { return padded.data() + i; }, width, out.view().row(y));
  });
  return out;
}

template <class Value>
Plane planeOf(int width, int height, Value&& value) {
  Plane plane(width, height);
  core::forEachPixel(width, height, [&](int x, int y) { plane(x, y) = value(x, y); });
  return plane;
}

Plane tonePlane(const core::In<float>& in) {
  return planeOf(in.width, in.height, [&](int x, int y) { return toneMapped(in(x, y)); });
}

Plane blurredProduct(const Plane& p, const Plane& q) {
  return blurred(planeOf(p.width(), p.height(), [&](int x, int y) { return p(x, y) * q(x, y); }));
}

/// SSIM of one pixel and channel from local means of a, b, aa, bb, ab [Wang et al. 2004, equation (13)].
double similarity(double a, double b, double aa, double bb, double ab) {
  const double varianceA = aa - a * a, varianceB = bb - b * b, covariance = ab - a * b;
  return (2 * a * b + kC1) * (2 * covariance + kC2) / ((a * a + b * b + kC1) * (varianceA + varianceB + kC2));
}

}  // namespace

double toneMapped(double x) {
  const double c = x > 0 ? x / (1 + x) : 0;
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;  // IEC 61966-2-1
}

SsimReference::SsimReference(const core::PlanesView<const float>& reference) {
  for (int c = 0; c < 3; ++c) {
    channels_[c].value = tonePlane(reference.plane[c]);
    channels_[c].mean = blurred(channels_[c].value);
    channels_[c].square = blurredProduct(channels_[c].value, channels_[c].value);
  }
}

core::Image<double> SsimReference::map(const core::PlanesView<const float>& test) const {
  Plane map(test.width(), test.height());
  for (int c = 0; c < 3; ++c) {
    const Channel& r = channels_[c];
    const Plane value = tonePlane(test.plane[c]), mean = blurred(value), square = blurredProduct(value, value),
                cross = blurredProduct(value, r.value);
    core::forEachPixel(map.width(), map.height(), [&](int x, int y) {
      map(x, y) += similarity(mean(x, y), r.mean(x, y), square(x, y), r.square(x, y), cross(x, y)) / 3;
    });
  }
  return map;
}

}  // namespace experiments
