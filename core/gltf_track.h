// Keyframes out of glTF animation samplers and flicker extras.
// Source: glTF 2.0 specification, section 3.11.
#pragma once

#include "core/gltf_accessor.h"
#include "core/scene.h"

namespace core {

/// Throws Error naming `where` for a name that glTF does not define.
Interpolation interpolationOf(const std::string& name, const std::string& where);

/// Keys of a translation or scale (components 3) or a rotation (4, normalised where it is not a spline's).
/// Throws Error for times that do not ascend, numbers that are not finite, a count that does not fit, a zero rotation.
Track trackOf(const AccessorView& times, const AccessorView& values, Interpolation interpolation, int components);

/// Factors on emission, at least 0, linear or step. Throws Error naming `where`.
Track flickerOf(const std::vector<double>& times, const std::vector<double>& factors, Interpolation interpolation,
                const std::string& where);

/// Index of an equal track in the list; one that is not there yet is added.
int addOnce(std::vector<Track>& tracks, const Track& track);

/// A rotation of unit length; one that already is keeps its bits. Throws Error naming `where` for one of length zero.
vec4 unitRotation(const vec4& xyzw, const std::string& where);

}  // namespace core
