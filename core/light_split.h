// How the lights of a tree's node are divided in two.
// Source: Conty Estevez and Kulla 2018, section 4.4: the surface area orientation heuristic. Its area is that of the
// sphere around the box here, because nodes are spheres.
#pragma once

#include <span>

#include "core/maths.h"

namespace core {

/// One light as the builder moves it about.
struct LightItem {
  vec3 low{0}, high{0};  ///< box
  vec3 axis{0, 0, 1};    ///< unit
  float cosine = 1;      ///< of the cone around axis
  float weight = 0;
  std::uint32_t light = 0;

  vec3 centre() const { return 0.5f * (low + high); }
};

/// Reorders items and returns how many of them, at least one and not all, come first. items: at least two. The result
/// depends on nothing but their order and values.
std::size_t splitLights(std::span<LightItem> items);

}  // namespace core
