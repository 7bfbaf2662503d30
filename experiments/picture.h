// HDR images as 8-bit pictures.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"

namespace experiments {

/// 8-bit sRGB pixels, 3 bytes each, row-major: exposure in stops, then x / (1 + x) a channel, then the sRGB curve.
std::vector<std::uint8_t> tonemapped(core::PlanesView<const float> image, float exposure);

}  // namespace experiments
