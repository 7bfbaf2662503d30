#include "core/gltf_mesh.h"

#include <numeric>

#include "core/check.h"

namespace core {
namespace {

std::vector<std::uint32_t> cornersOf(const PrimitiveSource& source) {
  if (source.indices) return readIndices(*source.indices);
  std::vector<std::uint32_t> corners(source.positions.count);
  std::iota(corners.begin(), corners.end(), 0u);
  return corners;
}

void checkCount(const AccessorView& attribute, const PrimitiveSource& source) {
  if (attribute.count != source.positions.count)
    throw Error(source.where, "its attributes differ in count", "repair the file or export it again");
}

}  // namespace

Mesh meshOf(const PrimitiveSource& source) {
  Mesh mesh;
  mesh.positions = readVectors<vec3>(source.positions);
  mesh.triangles = trianglesOf(source.mode, cornersOf(source), mesh.positions.size(), source.where);
  if (source.normals) {
    checkCount(*source.normals, source);
    mesh.normals = readVectors<vec3>(*source.normals);
  }
  if (source.uvs) {
    checkCount(*source.uvs, source);
    mesh.uvs = readVectors<vec2>(*source.uvs);
    if (!source.uvTransform.isIdentity())
      for (vec2& uv : mesh.uvs) uv = source.uvTransform.apply(uv);
  }
  return mesh;
}

}  // namespace core
