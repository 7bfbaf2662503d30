// Triangles out of glTF primitives: lists, strips and fans, indexed or not.
// Source: glTF 2.0 specification, section 3.7.2.1.
#pragma once

#include <string>
#include <vector>

#include "core/maths.h"

namespace core {

/// glTF's primitive modes.
enum class PrimitiveMode { points, lines, lineLoop, lineStrip, triangles, triangleStrip, triangleFan };

/// indices: one per corner in drawing order, each below vertexCount. mode: one of the three triangle modes.
/// Throws Error naming `where` for an index out of range or a count that makes no whole triangles.
std::vector<uvec3> trianglesOf(PrimitiveMode mode, const std::vector<std::uint32_t>& indices, std::size_t vertexCount,
                               const std::string& where);

}  // namespace core
