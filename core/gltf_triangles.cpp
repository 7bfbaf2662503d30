#include "core/gltf_triangles.h"

#include "core/check.h"
#include "core/gltf_support.h"

namespace core {
namespace {

void checkIndices(const std::vector<std::uint32_t>& indices, std::size_t vertexCount, const std::string& where) {
  for (std::uint32_t index : indices)
    if (index >= vertexCount)
      throw Error(where,
                  "index " + std::to_string(index) + " is out of range of " + std::to_string(vertexCount) + " vertices",
                  kRepair);
}

std::vector<uvec3> fromList(const std::vector<std::uint32_t>& v) {
  std::vector<uvec3> triangles(v.size() / 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  return triangles;
}

/// p_i = {v_i, v_(i + (1 + i mod 2)), v_(i + (2 - i mod 2))} keeps the winding of every triangle.
std::vector<uvec3> fromStrip(const std::vector<std::uint32_t>& v) {
  std::vector<uvec3> triangles(v.size() - 2);
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = {v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]};
  return triangles;
}

std::vector<uvec3> fromFan(const std::vector<std::uint32_t>& v) {
  std::vector<uvec3> triangles(v.size() - 2);
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = {v[i + 1], v[i + 2], v[0]};
  return triangles;
}

}  // namespace

std::vector<uvec3> trianglesOf(PrimitiveMode mode, const std::vector<std::uint32_t>& indices, std::size_t vertexCount,
                               const std::string& where) {
  checkIndices(indices, vertexCount, where);
  if (indices.size() < 3 || (mode == PrimitiveMode::triangles && indices.size() % 3 != 0))
    throw Error(where, std::to_string(indices.size()) + " corners make no whole triangles", kRepair);
  if (mode == PrimitiveMode::triangleStrip) return fromStrip(indices);
  if (mode == PrimitiveMode::triangleFan) return fromFan(indices);
  return fromList(indices);
}

}  // namespace core
