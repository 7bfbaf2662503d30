// How far an image is from its reference, by region. Offline: double precision, sums in a fixed order.
// Sources: design of the relative error and its trimmed mean: the two-history slides (000) and their protocol; SSIM as
// in ssim.h.
#pragma once

#include <string>
#include <vector>

#include "core/image.h"

namespace experiments {

using Colour = core::PlanesView<const float>;  ///< linear RGB
using Mask = core::In<std::uint8_t>;           ///< nonzero = in the region; an empty mask is the full frame

/// What an image is compared with: one image, or two independent halves whose own noise then does not bias errors.
struct Reference {
  Colour first, second;  ///< second may be empty
  Reference(const Colour& only) : first(only), second(only) {}
  Reference(const Colour& a, const Colour& b) : first(a), second(b.empty() ? a : b) {}
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

/// One image against one reference; what is computed once serves every region. Holds no view of the images' pixels
/// beyond its constructor except through the views given, which must outlive it.
class Comparison {
 public:
  /// Throws core::Error where sizes differ or a pixel is not finite; testName and referenceName appear in the message.
  Comparison(const Colour& test, const Reference& reference, const std::string& testName = "test image",
             const std::string& referenceName = "reference");

  Metrics in(const Mask& region = {}) const;
  /// Per pixel: channel mean of the relative squared error. For error maps.
  core::In<double> relativeError() const { return relative_; }

 private:
  Colour test_;
  Reference reference_;
  core::Image<double> relative_, ssim_;
};

/// Throws core::Error that names the first pixel (in reading order) with a value that is not finite.
void requireFinite(const Colour& image, const std::string& name);

/// Mean of `values` without the largest `fraction` of them, rounded up to whole values but never all; NaN if empty.
double trimmedMean(std::vector<double> values, double fraction);

}  // namespace experiments
