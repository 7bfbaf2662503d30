// One level of the edge-avoiding à-trous filter over any number of planes that share their weights.
// Source: SVGF (Schied et al. 2017), equations (1) to (5); Dammertz et al. 2010.
#pragma once

#include <span>

#include "core/edge_weight.h"
#include "core/guide.h"
#include "twohistory/history_view.h"
#include "twohistory/twins.h"

namespace svgf {

inline constexpr int kAtrousRadius = 2;  ///< taps to each side of a pixel

/// What a level reads and writes. input is filtered into output, and with the same weights differences[i] into
/// differencesOut[i]; all have the guide's size.
struct Level {
  int step = 1;  ///< pixels between taps: 1, 2, 4, ...
  float phiColour = 4;
  core::EdgeParameters edges;
  core::PlanesView<const float> input;
  core::PlanesView<float> output;
  core::In<float> variance;  ///< of the luminance that guides
  core::ImageView<float> varianceOut;
  core::ImageView<float> luminance;  ///< luminance of the image that guides; filled by the caller
  core::ImageView<float> tolerance;  ///< scratch
  std::span<const core::In<core::Stored>> differences{};
  std::span<const core::ImageView<core::Stored>> differencesOut{};
  const twohistory::TwinTiles* twins = nullptr;  ///< tiles in which all differences are 0; null = none
};

/// Filters every pixel that has a surface; others are copied.
void atrous(const Level& level, const core::Guide& guide);

}  // namespace svgf
