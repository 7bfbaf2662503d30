#include "experiments/scenes/shapes.h"

namespace experiments {

using core::Mesh;
using core::uvec3;
using core::vec2;
using core::vec3;

namespace {

/// Adds a parallelogram around centre; right x up points outwards.
void addFace(Mesh& mesh, const vec3& centre, const vec3& right, const vec3& up, const vec2& repeat) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const vec3 normal = normalize(cross(right, up));
  for (int corner = 0; corner < 4; ++corner) {
    const vec2 uv(corner == 1 || corner == 2, corner < 2);
    mesh.positions.push_back(centre + (uv.x - 0.5f) * right + (0.5f - uv.y) * up);
    mesh.normals.push_back(normal);
    mesh.uvs.push_back(repeat * uv);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A point on the sphere of radius 0.5, with its normal.
std::uint32_t addSpherePoint(Mesh& mesh, const vec3& direction) {
  mesh.normals.push_back(normalize(direction));
  mesh.positions.push_back(0.5f * mesh.normals.back());
  return static_cast<std::uint32_t>(mesh.positions.size()) - 1;
}

void subdivide(Mesh& sphere) {
  const Mesh coarse = sphere;
  sphere = Mesh{};
  for (const uvec3& t : coarse.triangles) {
    const vec3 &a = coarse.normals[t.x], &b = coarse.normals[t.y], &c = coarse.normals[t.z];
    std::uint32_t v[6];
    const vec3 points[] = {a, b, c, a + b, b + c, c + a};
    for (int i = 0; i < 6; ++i) v[i] = addSpherePoint(sphere, points[i]);
    sphere.triangles.insert(sphere.triangles.end(),
                            {{v[0], v[3], v[5]}, {v[3], v[1], v[4]}, {v[5], v[4], v[2]}, {v[3], v[4], v[5]}});
  }
}

void addDisc(Mesh& mesh, int segments, float y) {
  const auto centre = static_cast<std::uint32_t>(mesh.positions.size());
  const vec3 normal(0, y > 0 ? 1 : -1, 0);
  mesh.positions.emplace_back(0, y, 0);
  mesh.normals.push_back(normal);
  for (int i = 0; i <= segments; ++i) {
    const float angle = 2 * core::kPi * static_cast<float>(i) / static_cast<float>(segments) * -normal.y;
    mesh.positions.emplace_back(0.5f * std::cos(angle), y, 0.5f * std::sin(angle));
    mesh.normals.push_back(normal);
    if (i > 0) mesh.triangles.emplace_back(centre, centre + i, centre + i + 1);
  }
}

}  // namespace

Mesh quadMesh(vec2 repeat) {
  Mesh mesh;
  addFace(mesh, vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), repeat);
  return mesh;
}

Mesh boxMesh(vec2 repeat) {
  Mesh mesh;
  for (float side : {0.5f, -0.5f}) {
    addFace(mesh, vec3(side, 0, 0), vec3(0, 0, -2 * side), vec3(0, 1, 0), repeat);
    addFace(mesh, vec3(0, side, 0), vec3(1, 0, 0), vec3(0, 0, -2 * side), repeat);
    addFace(mesh, vec3(0, 0, side), vec3(2 * side, 0, 0), vec3(0, 1, 0), repeat);
  }
  return mesh;
}

Mesh sphereMesh(int subdivisions) {
  Mesh mesh;
  for (int octant = 0; octant < 8; ++octant) {
    const vec3 s(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
    const std::uint32_t x = addSpherePoint(mesh, {s.x, 0, 0}), y = addSpherePoint(mesh, {0, s.y, 0});
    const std::uint32_t z = addSpherePoint(mesh, {0, 0, s.z});
    mesh.triangles.push_back(s.x * s.y * s.z > 0 ? uvec3(x, y, z) : uvec3(x, z, y));
  }
  for (int i = 0; i < subdivisions; ++i) subdivide(mesh);
  return mesh;
}

Mesh cylinderMesh(int segments) {
  Mesh mesh;
  for (int i = 0; i <= segments; ++i) {
    const float angle = 2 * core::kPi * static_cast<float>(i) / static_cast<float>(segments);
    const vec3 normal(std::cos(angle), 0, std::sin(angle));
    for (float y : {-0.5f, 0.5f}) {
      mesh.positions.push_back(0.5f * normal + vec3(0, y, 0));
      mesh.normals.push_back(normal);
    }
    const auto low = static_cast<std::uint32_t>(2 * i);
    if (i < segments) mesh.triangles.insert(mesh.triangles.end(), {{low, low + 1, low + 3}, {low, low + 3, low + 2}});
  }
  addDisc(mesh, segments, 0.5f);
  addDisc(mesh, segments, -0.5f);
  return mesh;
}

void append(Mesh& mesh, const Mesh& part, const vec3& centre, const vec3& size) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const vec3& p : part.positions) mesh.positions.push_back(centre + size * p);
  for (const vec3& n : part.normals) mesh.normals.push_back(normalize(n / size));
  mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (const uvec3& t : part.triangles) mesh.triangles.push_back(t + first);
}

}  // namespace experiments
