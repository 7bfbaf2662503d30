// Which neighbours a pixel reuses: by random numbers and the G-buffer, before any reservoir is read.
#pragma once

#include <array>
#include <span>

#include "core/moment.h"
#include "core/random.h"

namespace restir {

inline constexpr int kMostNeighbours = 15;

struct SpatialParameters {
  int neighbours = 3;           ///< at most kMostNeighbours
  float radius = 1.0f / 30;     ///< fraction of the image's height
  float normalCosine = 0.9f;    ///< least cosine between the normals
  float planeDistance = 0.05f;  ///< fraction of the distance to the camera
};

/// True if light sampled for one surface may be worth trying for the other. Reuse is unbiased whatever this says.
bool similar(const core::Surface& a, const core::Surface& b, const core::vec3& viewer, const SpatialParameters& p);

/// Row-major indices of similar pixels in a disk around a pixel; a neighbour may come up twice.
struct Neighbours {
  std::array<std::int32_t, kMostNeighbours> pixel;
  int count = 0;
};
Neighbours chooseNeighbours(const core::Moment& now, core::ivec2 pixel, const SpatialParameters& p, core::Rng& rng);

}  // namespace restir
