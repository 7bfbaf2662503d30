// One level of the edge-avoiding à-trous filter over any number of planes that share their weights.
// Source: SVGF (Schied et al. 2017), equations (1) to (5); Dammertz et al. 2010.
#pragma once

#include <span>

#include "core/edge_weight.h"
#include "core/guide.h"

namespace svgf {

/// What a level reads and writes. inputs[i] is filtered into outputs[i]; all have the guide's size.
struct Level {
  int step = 1;  ///< pixels between taps: 1, 2, 4, ...
  float phiColour = 4;
  core::EdgeParameters edges;
  std::span<const core::In<float>> inputs;
  std::span<const core::ImageView<float>> outputs;
  core::In<float> variance;  ///< of the luminance that guides
  core::ImageView<float> varianceOut;
  core::ImageView<float> luminance;  ///< luminance of the image that guides; filled by the caller
  core::ImageView<float> tolerance;  ///< scratch
};

/// Filters every pixel that has a surface; others are copied.
void atrous(const Level& level, const core::Guide& guide);

}  // namespace svgf
