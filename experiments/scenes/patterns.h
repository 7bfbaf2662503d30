// Textures and motions of the built-in scenes, made from integer hashes and sines: the same on every run.
#pragma once

#include <functional>

#include "core/scene.h"

namespace experiments {

/// A number in [0, 1) that depends on the two keys alone.
float hashed(std::uint32_t key, std::uint32_t stream = 0);

/// size x size texels from color(x, y), which gives linear RGB in [0, 1]; sRGB-encoded unless `linear`.
core::Texture paint(int size, const std::function<core::vec3(int, int)>& color, bool linear = false);

core::Texture brickTexture();
core::Texture stripeTexture(const core::vec3& a, const core::vec3& b);
core::Texture plankTexture();
/// Dark paving stones.
core::Texture pavingTexture();
/// Roughness (green) from 0.15 in puddles to 0.3 elsewhere, metallic 0.
core::Texture wetnessTexture();

/// A track of keysPerSecond * seconds + 1 keys of value(time).
core::Track sampled(float seconds, float keysPerSecond, const std::function<core::vec4(float)>& value,
                    core::Interpolation interpolation = core::Interpolation::linear);

/// A pendulum: rotation about a unit axis by degrees * sin(2 pi (time / period + phase)).
core::Track swing(float seconds, float degrees, float period, float phase, const core::vec3& axis);

/// From a to b at constant speed.
core::Track glide(float seconds, const core::vec3& a, const core::vec3& b);

}  // namespace experiments
