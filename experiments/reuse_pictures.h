// Pictures of what reuse leaves behind: sample age, confidence, duplicates and N_eff (restir/diagnostics.h).
#pragma once

#include <array>
#include <filesystem>

#include "experiments/picture.h"
#include "restir/diagnostics.h"

namespace experiments {

/// One quantity: how it is named in files, what it means, and the values that the ends of its colour map stand for.
struct ReuseQuantity {
  const char* name;
  const char* meaning;
  ErrorScale scale;
  core::In<float> (restir::Diagnostics::*values)() const;
};
const std::array<ReuseQuantity, 4>& reuseQuantities();

/// The quantity on a logarithmic colour scale; grey where it is 0 or less (no sample, no surface, none).
Picture reusePicture(const ReuseQuantity& quantity, const restir::Diagnostics& diagnostics);

/// Writes stem.NAME.png for each quantity and, if exr, stem.reuse.exr with a channel for each. Throws core::Error.
void writeReusePictures(const std::filesystem::path& stem, const restir::Diagnostics& diagnostics, bool exr);

}  // namespace experiments
