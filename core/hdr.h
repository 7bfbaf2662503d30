// Radiance HDR images (.hdr, .pic): RGBE pixels, flat or run-length encoded in the old or the new way.
// Sources: Ward, "Real Pixels", Graphics Gems II (1991); the "Radiance Synthetic Imaging System" file format pages.
#pragma once

#include <filesystem>

#include "core/image.h"

namespace core {

/// Linear RGB of a picture, row 0 at its top; values are divided by the EXPOSURE and COLORCORR of its header, as the
/// format asks. A mantissa m with exponent e is m 2^(e - 136), the convention of most readers (Radiance's own adds half
/// a step). Throws Error where the file is missing, no RGB Radiance picture, truncated, turned by 90 degrees, or above
/// 2^27 pixels.
Planes readHdr(const std::filesystem::path& path);

}  // namespace core
