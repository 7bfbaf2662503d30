// Vectors and the few formulas that every folder shares.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

namespace core {

using glm::dvec3;
using glm::ivec2;
using glm::mat4;
using glm::quat;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Of statistics: there was nothing to measure.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Relative luminance of linear Rec. 709 radiance.
inline float luminance(const vec3& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }

/// (1 - t) a + t b, the convention of every blend in this project: t = 1 is all of b.
template <class T>
T lerp(const T& a, const T& b, float t) {
  return (1 - t) * a + t * b;
}

inline bool isFinite(float x) { return std::isfinite(x); }
inline bool isFinite(const vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

inline float maxComponent(const vec3& v) { return std::max(v.x, std::max(v.y, v.z)); }

/// Orthonormal tangent frame around a unit normal. Source: Duff et al., "Building an Orthonormal Basis, Revisited"
/// (2017).
struct Frame {
  vec3 tangent, bitangent, normal;
  explicit Frame(const vec3& n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    bitangent = vec3(b, sign + n.y * n.y * a, -n.y);
  }
  vec3 toLocal(const vec3& v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
  vec3 toWorld(const vec3& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

}  // namespace core
