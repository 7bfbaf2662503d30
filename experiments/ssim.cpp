#include "experiments/ssim.h"

#include <cmath>

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

/// Separable Gaussian over rows, then columns.
Plane blurred(const Plane& in) {
  static const std::array<double, kTaps> weights = gaussianWeights();
  const int width = in.width(), height = in.height();
  Plane rows(width, height), out(width, height);
  const auto tap = [&](int y, int x, bool along) {
    const Plane& source = along ? in : rows;
    double sum = 0;
    for (int i = 0; i < kTaps; ++i) {
      const int d = i - kSsimRadius;
      sum += weights[i] * (along ? source(reflected(x + d, width), y) : source(x, reflected(y + d, height)));
    }
    return sum;
  };
  core::forEachPixel(width, height, [&](int x, int y) { rows(x, y) = tap(y, x, true); });
  core::forEachPixel(width, height, [&](int x, int y) { out(x, y) = tap(y, x, false); });
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

/// Adds a third of one channel's SSIM to map [Wang et al. 2004, equation (13)].
void addChannel(const Plane& a, const Plane& b, Plane& map) {
  const int width = a.width(), height = a.height();
  const auto product = [&](const Plane& p, const Plane& q) {
    return blurred(planeOf(width, height, [&](int x, int y) { return p(x, y) * q(x, y); }));
  };
  const Plane meanA = blurred(a), meanB = blurred(b), aa = product(a, a), bb = product(b, b), ab = product(a, b);
  core::forEachPixel(width, height, [&](int x, int y) {
    const double ma = meanA(x, y), mb = meanB(x, y);
    const double va = aa(x, y) - ma * ma, vb = bb(x, y) - mb * mb, cov = ab(x, y) - ma * mb;
    map(x, y) += (2 * ma * mb + kC1) * (2 * cov + kC2) / ((ma * ma + mb * mb + kC1) * (va + vb + kC2)) / 3;
  });
}

}  // namespace

double toneMapped(double x) {
  const double c = x > 0 ? x / (1 + x) : 0;
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;  // IEC 61966-2-1
}

core::Image<double> ssimMap(const core::PlanesView<const float>& a, const core::PlanesView<const float>& b) {
  Plane map(a.width(), a.height());
  for (int c = 0; c < 3; ++c) addChannel(tonePlane(a.plane[c]), tonePlane(b.plane[c]), map);
  return map;
}

}  // namespace experiments
