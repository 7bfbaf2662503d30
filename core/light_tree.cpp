// Drawing from a light tree.
#include "core/light_tree.h"

namespace core {
namespace {

constexpr float kSlack = 1e-4f;  // of a cosine: bounds stay bounds in spite of rounding

}  // namespace

/// Sines and cosines are kept times d, so that no root waits for another: s_w = d sin(theta_w) and so on. An angle is
/// at most another where the sine of their difference is at most 0.
[[gnu::always_inline]] inline std::array<float, 4> LightTree::importances(const LightTreeNode& n, const vec3& position,
                                                                          const vec3& normal) const {
  std::array<float, 4> result;
  const float least = leastDistance2_;
#pragma omp simd
  for (int k = 0; k < 4; ++k) {
    const float dx = position.x - n.x[k], dy = position.y - n.y[k], dz = position.z - n.z[k], r = n.radius[k];
    const float d2 = dx * dx + dy * dy + dz * dz, r2 = r * r;
    const float near2 = std::max(d2, std::max(0.25f * r2, least)), inverse = 1 / std::max(d2, least);
    const float along = (n.axisX[k] * dx + n.axisY[k] * dy + n.axisZ[k] * dz) * (1.0f / 32767);
    const float cW = n.child[k] & LightTreeNode::kTwoSided ? std::abs(along) : along;
    const float sW = std::sqrt(std::max(d2 - cW * cW, 0.0f));
    const float cosO = n.cosine[k] * (1.0f / 32767), sinO = std::sqrt(std::max(1 - cosO * cosO, 0.0f));
    const float d = std::sqrt(d2), cU = std::sqrt(std::max(d2 - r2, 0.0f)), sU = r;
    const float cI = -(normal.x * dx + normal.y * dy + normal.z * dz), sI = std::sqrt(std::max(d2 - cI * cI, 0.0f));
    const float sWO = sW * cosO - cW * sinO;  // theta_w - theta_o
    const float cX = sWO > 0 ? cW * cosO + sW * sinO : d, sX = std::max(sWO, 0.0f);
    const float cosP = sX * cU - cX * sU > 0 ? (cX * cU + sX * sU) * inverse : 1.0f;  // - theta_u
    const float cosR = sI * cU - cI * sU > 0 ? (cI * cU + sI * sU) * inverse : 1.0f;  // theta_i - theta_u
    const float lobe = std::max(cosP + kSlack, 0.0f), spot = cosP >= 1 - kSlack ? 1.0f : 0.0f;
    const float emitted = n.child[k] & LightTreeNode::kConeAlone ? spot : lobe;
    const float facing = emitted * std::max(cosR + kSlack, 0.0f);
    result[k] = n.weight[k] / near2 * (d2 <= r2 ? 1.0f : facing);  // [tree 1]
  }
  return result;
}

namespace {

/// What a child is drawn in proportion to: importances, or weights where there are none.
struct Shares {
  std::array<float, 4> of;
  std::array<double, 4> until;  ///< sums over this child and those before it

  Shares(const LightTreeNode& node, const std::array<float, 4>& importance) : of(importance) {
    add();
    if (until[3] > 0) return;
    of = node.weight;
    add();
  }
  double probability(std::size_t k) const { return double{of[k]} / until[3]; }
  /// The child that u falls on; u becomes uniform in [0, 1) again. A child without share is never met.
  std::size_t draw(double& u) const {
    constexpr double kBelowOne = 1 - 0x1p-53;
    const double at = u * until[3];
    const std::size_t k = std::size_t{at >= until[0]} + std::size_t{at >= until[1]} + std::size_t{at >= until[2]};
    u = std::min((at - (k > 0 ? until[k - 1] : 0.0)) / double{of[k]}, kBelowOne);
    return k;
  }

 private:
  void add() {
    until[0] = double{of[0]};
    for (int k = 1; k < 4; ++k) until[k] = until[k - 1] + double{of[k]};
  }
};

}  // namespace

/// Asks for all children while their importances are worked out: a large tree is not in any cache.
inline void LightTree::prefetchChildren(const LightTreeNode& node) const {
  for (const std::uint32_t child : node.child) {
    const bool leaf = child & LightTreeNode::kLeaf;
    const auto* bytes = reinterpret_cast<const char*>(&nodes_[leaf ? 0 : child & LightTreeNode::kIndex]);
    __builtin_prefetch(bytes);
    __builtin_prefetch(bytes + 64);
  }
}

LightTree::Drawn LightTree::sample(const vec3& position, const vec3& normal, double u) const {
  double probability = 1;
  for (std::uint32_t at = 0;;) {
    const LightTreeNode& node = nodes_[at];
    prefetchChildren(node);
    const Shares shares(node, importances(node, position, normal));
    const std::size_t k = shares.draw(u);
    probability *= shares.probability(k);
    at = node.child[k] & LightTreeNode::kIndex;
    if (node.child[k] & LightTreeNode::kLeaf) return {at, probability};
  }
}

double LightTree::pdf(const vec3& position, const vec3& normal, std::uint32_t light) const {
  std::uint32_t slot = light < slotOf_.size() ? slotOf_[light] : kNoSlot;
  if (slot == kNoSlot) return 0;
  double probability = 1;
  for (; slot != kNoSlot; slot = parent_[slot / 4]) {
    const LightTreeNode& node = nodes_[slot / 4];
    probability *= Shares(node, importances(node, position, normal)).probability(slot % 4);
  }
  return probability;
}

}  // namespace core
