#include "experiments/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/maths.h"
#include "core/parallel.h"

namespace experiments {

namespace {

constexpr double kRelativeFloor = 0.01;  ///< added to r^2; the slides' protocol
constexpr double kTrimmed = 0.001;       ///< share of pixels left out of the trimmed mean
constexpr std::array kLuminance{0.2126, 0.7152, 0.0722};

/// Mean over indices of value(index), in an order fixed by their count; NaN without any.
template <class Value>
double meanOver(const std::vector<std::int64_t>& indices, Value&& value) {
  const auto count = static_cast<std::int64_t>(indices.size());
  if (count == 0) return core::kNaN;
  return core::deterministicSum(count, [&](std::int64_t i) { return value(indices[i]); }) / static_cast<double>(count);
}

core::Planes meanOfHalves(const Colour& first, const Colour& second) {
  core::Planes mean(first.width(), first.height());
  const core::PlanesView<float> out = mean.view();
  core::forEachPixel(mean.width(), mean.height(),
                     [&](int x, int y) { out.store(x, y, 0.5f * (first.load(x, y) + second.load(x, y))); });
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
  if (values.empty()) return core::kNaN;
  const double share = std::ceil(fraction * static_cast<double>(values.size()) - 1e-9);
  const std::size_t kept = values.size() - std::min(values.size() - 1, static_cast<std::size_t>(std::max(0.0, share)));
  if (kept < values.size()) std::nth_element(values.begin(), values.begin() + kept, values.end());
  const double sum = core::deterministicSum(static_cast<std::int64_t>(kept), [&](std::int64_t i) { return values[i]; });
  return sum / static_cast<double>(kept);
}

Reference::Reference(const Colour& first, const Colour& second, const std::string& name)
    : first_(first), second_(second.empty() ? first : second), name_(name) {
  requireSize(second_, first_, name, "its other half");
  requireFinite(first_, name);
  requireFinite(second_, name);
  ssim_ = std::make_shared<const SsimReference>(meanOfHalves(first_, second_).view());
}

Comparison::Pixel Comparison::pixelOf(const Colour& test, const Reference& reference, int x, int y) {
  Pixel p;
  for (int c = 0; c < 3; ++c) {
    const double value = test.plane[c](x, y), r1 = reference.first().plane[c](x, y),
                 r2 = reference.second().plane[c](x, y), r = 0.5 * (r1 + r2);
    const double squared = (value - r1) * (value - r2);
    p.squared += squared / 3;
    p.relative += squared / (r * r + kRelativeFloor) / 3;
    p.difference += (value - r) / 3;
    p.largest = std::max(p.largest, std::abs(value - r));
    p.testLuminance += kLuminance[c] * value;
    p.referenceLuminance += kLuminance[c] * r;
  }
  return p;
}

Comparison::Comparison(const Colour& test, const Reference& reference, const std::string& name)
    : pixels_(test.width(), test.height()) {
  requireSize(test, reference.first(), name, reference.name());
  requireFinite(test, name);
  core::forEachPixel(width(), height(), [&](int x, int y) { pixels_(x, y) = pixelOf(test, reference, x, y); });
  ssim_ = reference.ssim().map(test);
}

std::vector<std::int64_t> Comparison::indicesOf(const Mask& region) const {
  if (!region.empty()) CHECK(region.width == width() && region.height == height());
  std::vector<std::int64_t> indices;
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x)
      if (region.empty() || region(x, y)) indices.push_back(std::int64_t{y} * width() + x);
  return indices;
}

double Comparison::ssimOver(const std::vector<std::int64_t>& indices) const {
  std::vector<std::int64_t> interior;
  for (const std::int64_t i : indices) {
    const auto x = static_cast<int>(i % width()), y = static_cast<int>(i / width());
    if (std::min({x, y, width() - 1 - x, height() - 1 - y}) >= kSsimRadius) interior.push_back(i);
  }
  return meanOver(interior, [&](std::int64_t i) { return ssim_.data()[i]; });
}

Metrics Comparison::in(const Mask& region) const {
  const std::vector<std::int64_t> indices = indicesOf(region);
  const Pixel* const pixels = pixels_.data();
  const auto mean = [&](double Pixel::*member) {
    return meanOver(indices, [&](std::int64_t i) { return pixels[i].*member; });
  };
  std::vector<double> relative;
  double largest = indices.empty() ? core::kNaN : 0;
  for (const std::int64_t i : indices) {
    relative.push_back(pixels[i].relative);
    largest = std::max(largest, pixels[i].largest);
  }
  Metrics m;
  m.relMse = mean(&Pixel::relative);
  m.relMseTrimmed = trimmedMean(std::move(relative), kTrimmed);
  m.ssim = ssimOver(indices);
  m.energyRatio = mean(&Pixel::testLuminance) / mean(&Pixel::referenceLuminance);
  m.mse = mean(&Pixel::squared);
  m.bias = mean(&Pixel::difference);
  m.maxError = largest;
  return m;
}

}  // namespace experiments
