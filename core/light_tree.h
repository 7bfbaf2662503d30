// A tree over the lights that have a place, to draw one in proportion to a bound on what it sends to a surface.
//
// A node of four children is two cache lines. From the root down, a child is drawn in proportion to its importance
//   [tree 1]  I = w max(cos(theta_w - theta_o - theta_u), 0) max(cos(theta_i - theta_u), 0) / max(d, r/2)^2
// w: sum of intensities; d: distance to the centre of its sphere of radius r, which fills the angle theta_u as seen
// from the surface; theta_w: between the cone's axis and the surface, theta_o: the cone's half angle; theta_i: between
// the surface's normal and the centre. Angles below 0 count as 0, inside the sphere both cosines are 1. (With max(d, r)
// as published, variance under many lamps was 1.4 times as high: half the radius is nearer to where the lights are.) A
// light that shines above the normal's horizon always has importance; where no child of a node has any, weights decide,
// so that probabilities always sum to 1.
//
// Sources: Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (2018); Pharr,
// Jakob and Humphreys, "Physically Based Rendering", 4th edition (2023), section 12.6.3, for bounds without
// trigonometry. Four children a node, drawing among all four at once, and r/2 are this project's.
#pragma once

#include <array>

#include "core/lights.h"

namespace core {

/// Children k = 0 to 3; weight 0 = none.
struct alignas(128) LightTreeNode {
  std::array<float, 4> x{}, y{}, z{}, radius{};                     ///< spheres
  std::array<std::int16_t, 4> axisX{}, axisY{}, axisZ{}, cosine{};  ///< cones, times 32767; cosine rounded down
  std::array<float, 4> weight{};
  std::array<std::uint32_t, 4> child{};  ///< node, or light if kLeaf, and flags
  static constexpr std::uint32_t kLeaf = 1u << 31, kTwoSided = 1u << 30, kConeAlone = 1u << 29;
  static constexpr std::uint32_t kIndex = kConeAlone - 1;
};
static_assert(sizeof(LightTreeNode) == 128);

class LightTree {
 public:
  LightTree() = default;
  /// Over the triangles, points and spots that have power. O(n log n), on all threads; the same bits for any number of
  /// them. lights may go afterwards. Throws Error beyond 2^29 lights.
  explicit LightTree(const Lights& lights);

  /// True if no light of finite distance has power.
  bool empty() const { return nodes_.empty(); }

  struct Drawn {
    std::uint32_t light = kNoLight;
    double probability = 0;
  };
  /// Draws a light for a surface at position, whose normal faces the side that reflects. u: uniform in [0, 1), of as
  /// many bits as a double has. Must not be empty().
  Drawn sample(const vec3& position, const vec3& normal, double u) const;
  /// Probability with which sample() draws the light; 0 for lights that are not in the tree.
  double pdf(const vec3& position, const vec3& normal, std::uint32_t light) const;

  std::size_t bytes() const {
    return nodes_.size() * (sizeof(LightTreeNode) + sizeof(std::uint32_t)) + slotOf_.size() * sizeof(std::uint32_t);
  }

 private:
  friend class LightTreeBuilder;
  static constexpr std::uint32_t kNoSlot = 0xffffffffu;

  void prefetchChildren(const LightTreeNode& node) const;
  std::array<float, 4> importances(const LightTreeNode& node, const vec3& position, const vec3& normal) const;

  std::vector<LightTreeNode> nodes_;   // depth first
  std::vector<std::uint32_t> parent_;  // per node: 4 x parent + child number
  std::vector<std::uint32_t> slotOf_;  // per light: the same
  float leastDistance2_ = 0;           // keeps quotients finite
};

}  // namespace core
