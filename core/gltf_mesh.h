// A glTF primitive as a mesh.
#pragma once

#include <optional>

#include "core/gltf_accessor.h"
#include "core/gltf_triangles.h"
#include "core/gltf_uv.h"
#include "core/scene.h"

namespace core {

/// What a primitive refers to.
struct PrimitiveSource {
  std::string where;  ///< file and mesh, for messages
  PrimitiveMode mode = PrimitiveMode::triangles;
  AccessorView positions;
  std::optional<AccessorView> normals, uvs, indices;
  UvTransform uvTransform;
};

/// The primitive's mesh, without name and material. Throws Error for numbers out of place, not finite, or missing.
Mesh meshOf(const PrimitiveSource& source);

}  // namespace core
