#include "experiments/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "experiments/ssim.h"

namespace experiments {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kRelativeFloor = 0.01;  ///< added to r^2; the slides' protocol
constexpr double kTrimmed = 0.001;       ///< share of pixels left out of the trimmed mean

/// One channel's errors against both halves of the reference.
struct ChannelError {
  double reference, first, second;
  ChannelError(double y, double r1, double r2) : reference(0.5 * (r1 + r2)), first(y - r1), second(y - r2) {}
  double squared() const { return first * second; }
  double relative() const { return squared() / (reference * reference + kRelativeFloor); }
  double signedError() const { return 0.5 * (first + second); }
};

ChannelError errorAt(const Colour& test, const Reference& reference, int channel, int x, int y) {
  return {test.plane[channel](x, y), reference.first.plane[channel](x, y), reference.second.plane[channel](x, y)};
}

double relativeErrorAt(const Colour& test, const Reference& reference, int x, int y) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += errorAt(test, reference, c, x, y).relative();
  return sum / 3;
}

/// Linear indices of a region's pixels, in reading order.
std::vector<std::int64_t> pixelsOf(const Mask& region, int width, int height) {
  std::vector<std::int64_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (region.empty() || region(x, y)) pixels.push_back(std::int64_t{y} * width + x);
  return pixels;
}

/// Mean of value(x, y) over pixels given by linear index; NaN without pixels.
template <class Value>
double meanOver(const std::vector<std::int64_t>& pixels, int width, Value&& value) {
  if (pixels.empty()) return kNaN;
  const double sum = core::deterministicSum(static_cast<std::int64_t>(pixels.size()), [&](std::int64_t i) {
    return static_cast<double>(value(static_cast<int>(pixels[i] % width), static_cast<int>(pixels[i] / width)));
  });
  return sum / static_cast<double>(pixels.size());
}

/// Mean over pixels and channels of term(ChannelError).
template <class Term>
double meanError(const Colour& test, const Reference& reference, const std::vector<std::int64_t>& pixels, Term&& term) {
  return meanOver(pixels, test.width(), [&](int x, int y) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += term(errorAt(test, reference, c, x, y));
    return sum / 3;
  });
}

double maxErrorOver(const Colour& test, const Reference& reference, const std::vector<std::int64_t>& pixels) {
  double largest = pixels.empty() ? kNaN : 0;
  for (const std::int64_t i : pixels)
    for (int c = 0; c < 3; ++c) {
      const int x = static_cast<int>(i % test.width()), y = static_cast<int>(i / test.width());
      largest = std::max(largest, std::abs(errorAt(test, reference, c, x, y).signedError()));
    }
  return largest;
}

double luminance(const Colour& image, int x, int y) {
  return 0.2126 * image.plane[0](x, y) + 0.7152 * image.plane[1](x, y) + 0.0722 * image.plane[2](x, y);
}

std::vector<double> valuesAt(const core::Image<double>& image, const std::vector<std::int64_t>& pixels) {
  std::vector<double> values;
  values.reserve(pixels.size());
  for (const std::int64_t i : pixels) values.push_back(image.data()[i]);
  return values;
}

/// Without the pixels that lie within kSsimRadius of the border.
std::vector<std::int64_t> interior(std::vector<std::int64_t> pixels, int width, int height) {
  std::erase_if(pixels, [&](std::int64_t i) {
    const auto x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    return std::min({x, y, width - 1 - x, height - 1 - y}) < kSsimRadius;
  });
  return pixels;
}

core::Planes meanOfHalves(const Reference& reference) {
  core::Planes mean(reference.first.width(), reference.first.height());
  core::forEachPixel(mean.width(), mean.height(), [&](int x, int y) {
    mean.view().store(x, y, 0.5f * (reference.first.load(x, y) + reference.second.load(x, y)));
  });
  return mean;
}

void requireSize(const Colour& image, const Colour& other, const std::string& name, const std::string& otherName) {
  if (image.width() == other.width() && image.height() == other.height()) return;
  throw core::Error(name,
                    fmt::format("its size {}x{} differs from {}x{} of {}", image.width(), image.height(), other.width(),
                                other.height(), otherName),
                    "compare images of one size");
}

}  // namespace

void requireFinite(const Colour& image, const std::string& name) {
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      if (core::isFinite(image.load(x, y))) continue;
      throw core::Error(name, fmt::format("pixel ({}, {}) is not finite", x, y), "mend or replace the image");
    }
}

double trimmedMean(std::vector<double> values, double fraction) {
  if (values.empty()) return kNaN;
  const double share = std::ceil(fraction * static_cast<double>(values.size()) - 1e-9);
  const std::size_t kept = values.size() - std::min(values.size() - 1, static_cast<std::size_t>(std::max(0.0, share)));
  std::sort(values.begin(), values.end());
  const double sum = core::deterministicSum(static_cast<std::int64_t>(kept), [&](std::int64_t i) { return values[i]; });
  return sum / static_cast<double>(kept);
}

Comparison::Comparison(const Colour& test, const Reference& reference, const std::string& testName,
                       const std::string& referenceName)
    : test_(test), reference_(reference), relative_(test.width(), test.height()) {
  requireSize(test, reference.first, testName, referenceName);
  requireSize(test, reference.second, testName, referenceName);
  requireFinite(test, testName);
  requireFinite(reference.first, referenceName);
  requireFinite(reference.second, referenceName);
  core::forEachPixel(test.width(), test.height(),
                     [&](int x, int y) { relative_(x, y) = relativeErrorAt(test, reference, x, y); });
  ssim_ = ssimMap(test, meanOfHalves(reference).view());
}

Metrics Comparison::in(const Mask& region) const {
  const int width = test_.width(), height = test_.height();
  if (!region.empty()) CHECK(region.width == width && region.height == height);
  const std::vector<std::int64_t> pixels = pixelsOf(region, width, height);
  const std::vector<double> relative = valuesAt(relative_, pixels);
  Metrics m;
  m.relMse = trimmedMean(relative, 0);
  m.relMseTrimmed = trimmedMean(relative, kTrimmed);
  m.ssim = meanOver(interior(pixels, width, height), width, [&](int x, int y) { return ssim_(x, y); });
  const auto mean = [&](const Colour& c) {
    return meanOver(pixels, width, [&](int x, int y) { return luminance(c, x, y); });
  };
  m.energyRatio = mean(test_) / (0.5 * (mean(reference_.first) + mean(reference_.second)));
  m.mse = meanError(test_, reference_, pixels, [](const ChannelError& e) { return e.squared(); });
  m.bias = meanError(test_, reference_, pixels, [](const ChannelError& e) { return e.signedError(); });
  m.maxError = maxErrorOver(test_, reference_, pixels);
  return m;
}

}  // namespace experiments
