// The lamps of the night market.
#pragma once

#include "experiments/scenes/builder.h"

namespace experiments {

inline constexpr float kMarketSeconds = 8;  ///< how long everything moves and flickers
inline constexpr int kStalls = 8;           ///< on each side of the street
inline constexpr float kStallSpacing = 3;   ///< metres; the first stands at z = 0, the others at -z
inline constexpr float kStreetHalf = 2.4f;  ///< metres from the middle of the street to a stall's front
inline constexpr float kAwningHeight = 2.3f;

/// Where the i-th stall stands; even ones on the left, odd ones on the right.
inline float stallZ(int i) { return -kStallSpacing * static_cast<float>(i / 2); }

/// Strings of bulbs across the street, a lantern at each stall, neon signs above, two lamps carried along the street,
/// a spot light and a little moonlight.
void addMarketLights(SceneBuilder& scene);

}  // namespace experiments
