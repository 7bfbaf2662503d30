// Structural similarity of tone-mapped images.
// Source: Wang et al., "Image Quality Assessment: From Error Visibility to Structural Similarity" (2004); Gaussian
// window 11x11, sigma 1.5, K1 0.01, K2 0.03, population covariance, borders reflected (as scikit-image 0.19 defines
// it).
#pragma once

#include "core/image.h"

namespace experiments {

inline constexpr int kSsimRadius = 5;  ///< pixels that the window reaches; the border that a mean leaves out

/// A reference's half of the sums, prepared once for any number of images.
class SsimReference {
 public:
  explicit SsimReference(const core::PlanesView<const float>& reference);
  /// Channel mean of SSIM at every pixel of a linear RGB image of the same size, on toneMapped() values (data range 1).
  core::Image<double> map(const core::PlanesView<const float>& test) const;

 private:
  struct Channel {
    core::Image<double> value, mean, square;  ///< tone-mapped, its local mean, the local mean of its square
  };
  std::array<Channel, 3> channels_;
};

/// The map SSIM sees: x / (1 + x), then the sRGB transfer curve; negative x counts as 0.
double toneMapped(double x);

}  // namespace experiments
