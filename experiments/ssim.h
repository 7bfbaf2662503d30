// Structural similarity of tone-mapped images.
// Source: Wang et al., "Image Quality Assessment: From Error Visibility to Structural Similarity" (2004); Gaussian
// window 11x11, sigma 1.5, K1 0.01, K2 0.03, population covariance, borders reflected (as scikit-image 0.19 defines
// it).
#pragma once

#include "core/image.h"

namespace experiments {

inline constexpr int kSsimRadius = 5;  ///< pixels that the window reaches; the border that a mean leaves out

/// Channel mean of SSIM at every pixel of two linear RGB images of one size, on toneMapped() values (data range 1).
core::Image<double> ssimMap(const core::PlanesView<const float>& a, const core::PlanesView<const float>& b);

/// The map SSIM sees: x / (1 + x), then the sRGB transfer curve; negative x counts as 0.
double toneMapped(double x);

}  // namespace experiments
