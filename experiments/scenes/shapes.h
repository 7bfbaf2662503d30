// Unit shapes that built-in scenes are made of; nodes give them place and size.
#pragma once

#include "core/scene.h"

namespace experiments {

/// Square in the xy plane, side 1, centred, facing +z, uv 0..1 (v down) times `repeat`.
core::Mesh quadMesh(core::vec2 repeat = core::vec2(1));

/// Cube, side 1, centred, flat faces, uv 0..1 times `repeat` on each.
core::Mesh boxMesh(core::vec2 repeat = core::vec2(1));

/// Sphere of radius 0.5, centred, smooth: 8 * 4^subdivisions triangles, starting from an octahedron.
core::Mesh sphereMesh(int subdivisions);

/// Cylinder along y, radius 0.5, height 1, centred, closed, smooth around: 4 * segments triangles.
core::Mesh cylinderMesh(int segments);

/// Adds a copy of part, scaled and moved, to mesh; both have uvs or neither has.
void append(core::Mesh& mesh, const core::Mesh& part, const core::vec3& centre, const core::vec3& size);

}  // namespace experiments
