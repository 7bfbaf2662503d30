// How far an image is from its reference, by region. Offline: double precision, sums in a fixed order.
// Sources: design of the relative error and its trimmed mean: the two-history slides (000) and their protocol; SSIM as
// in ssim.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/image.h"
#include "experiments/ssim.h"

namespace experiments {

using Colour = core::PlanesView<const float>;  ///< linear RGB
using Mask = core::In<std::uint8_t>;           ///< nonzero = in the region; an empty mask is the full frame

/// What images are compared with: one image, or two independent halves whose own noise then does not bias errors.
/// Prepared once for any number of comparisons; cheap to copy. Views only: the images must outlive it.
class Reference {
 public:
  /// second may be empty. Throws core::Error, naming `name`, where sizes differ or a pixel is not finite.
  Reference(const Colour& first, const Colour& second, const std::string& name = "reference");
  explicit Reference(const Colour& only, const std::string& name = "reference") : Reference(only, only, name) {}

  const Colour& first() const { return first_; }
  const Colour& second() const { return second_; }
  const SsimReference& ssim() const { return *ssim_; }
  const std::string& name() const { return name_; }

 private:
  Colour first_, second_;
  std::string name_;
  std::shared_ptr<const SsimReference> ssim_;
};

/// Errors over one region; NaN throughout where the region holds no pixel.
struct Metrics {
  double relMse = 0;         ///< mean over pixels and channels of (y - r1)(y - r2) / (r^2 + 0.01), r = (r1 + r2) / 2
  double relMseTrimmed = 0;  ///< the same without the 0.1 % of pixels (channel means) that are worst
  double ssim = 0;           ///< structural similarity, 5-pixel border left out; 1 = equal
  double energyRatio = 0;    ///< mean luminance of the test over that of the reference
  double mse = 0;            ///< mean of (y - r1)(y - r2)
  double bias = 0;           ///< mean of y - r
  double maxError = 0;       ///< largest |y - r| of any channel
};

/// One image against one reference, pixel by pixel; then means over any number of regions.
class Comparison {
 public:
  /// Throws core::Error, naming `name`, where sizes differ or a pixel is not finite.
  Comparison(const Colour& test, const Reference& reference, const std::string& name = "test image");

  Metrics in(const Mask& region = {}) const;
  /// Channel mean of the relative squared error (may be negative with two halves). For error maps.
  double relativeError(int x, int y) const { return pixels_(x, y).relative; }
  int width() const { return pixels_.width(); }
  int height() const { return pixels_.height(); }

 private:
  /// Channel means of one pixel's errors, the largest of them, and both luminances.
  struct Pixel {
    double relative = 0, squared = 0, difference = 0, largest = 0, testLuminance = 0, referenceLuminance = 0;
  };
  static Pixel pixelOf(const Colour& test, const Reference& reference, int x, int y);
  std::vector<std::int64_t> indicesOf(const Mask& region) const;
  double ssimOver(const std::vector<std::int64_t>& indices) const;

  core::Image<Pixel> pixels_;
  core::Image<double> ssim_;
};

/// Throws core::Error that names the first pixel (in reading order) with a value that is not finite.
void requireFinite(const Colour& image, const std::string& name);

/// Mean of `values` without the largest `fraction` of them, rounded up to whole values but never all; NaN if empty.
double trimmedMean(std::vector<double> values, double fraction);

}  // namespace experiments
