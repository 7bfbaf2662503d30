// Where lights are, which way they shine and how strongly: bounds of one light or of many.
// Source: Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (2018), section 4.
#pragma once

#include "core/bounds.h"

namespace core {

/// Directions within an angle of an axis.
struct DirectionCone {
  vec3 axis{0, 0, 1};  ///< unit
  float cosine = 1;    ///< of the angle; -1 = all directions
};

/// A cone around two others, as narrow as one can be whose rim touches both.
inline DirectionCone unite(const DirectionCone& a, const DirectionCone& b) {
  const float between = std::acos(std::clamp(dot(a.axis, b.axis), -1.0f, 1.0f));
  const float angleA = std::acos(a.cosine), angleB = std::acos(b.cosine);
  if (std::min(between + angleB, kPi) <= angleA) return a;
  if (std::min(between + angleA, kPi) <= angleB) return b;
  const float angle = 0.5f * (angleA + between + angleB);
  const vec3 aside = b.axis - dot(a.axis, b.axis) * a.axis;
  const float length2 = dot(aside, aside);
  if (angle >= kPi || !(length2 > 1e-12f)) return {a.axis, angle >= kPi || dot(a.axis, b.axis) < 0 ? -1.0f : a.cosine};
  const float turn = angle - angleA;
  return {normalize(std::cos(turn) * a.axis + std::sin(turn) / std::sqrt(length2) * aside), std::cos(angle)};
}

/// Light leaves from inside a sphere around directions of a cone: a cosine lobe about each, or (spots) within the cone
/// alone.
struct LightBounds {
  vec3 centre{0};
  float radius = 0;
  Bounds box;
  DirectionCone cone;
  bool twoSided = false;  ///< shines about the opposite of the axis too
  bool coneAlone = true;  ///< no light outside the cone
  double weight = 0;      ///< intensity at the brightest direction, any unit
};

/// Bounds of all parts together. parts: at least one.
inline LightBounds unite(std::span<const LightBounds> parts) {
  LightBounds all = parts[0];
  for (const LightBounds& part : parts.subspan(1)) {
    DirectionCone cone = part.cone;
    if (all.twoSided && part.twoSided && dot(cone.axis, all.cone.axis) < 0) cone.axis = -cone.axis;
    all.cone = unite(all.cone, cone);
    all.twoSided |= part.twoSided;
    all.coneAlone &= part.coneAlone;
    all.weight += part.weight;
    all.box.add(part.box.low);
    all.box.add(part.box.high);
  }
  all.centre = 0.5f * (all.box.low + all.box.high);
  float radius = 0;
  for (const LightBounds& part : parts) radius = std::max(radius, length(part.centre - all.centre) + part.radius);
  all.radius = std::min(radius, 0.5f * length(all.box.high - all.box.low));
  return all;
}

}  // namespace core
