// Drawing from a light tree.
#include "core/light_tree.h"

namespace core {
namespace {

constexpr float kSlack = 1e-4f;  // of a cosine: bounds stay bounds in spite of rounding

}  // namespace

std::array<float, 4> LightTree::importances(const LightTreeNode& n, const vec3& position, const vec3& normal) const {
  std::array<float, 4> result;
  const float least = leastDistance2_;
#pragma omp simd
  for (int k = 0; k < 4; ++k) {
    const float dx = position.x - n.x[k], dy = position.y - n.y[k], dz = position.z - n.z[k], r = n.radius[k];
    const float d2 = dx * dx + dy * dy + dz * dz, r2 = r * r;
    const float far2 = std::max(d2, std::max(r2, least));
    const float inverse = 1 / std::sqrt(far2);
    const float sinU = r * inverse, cosU = std::sqrt(std::max(1 - sinU * sinU, 0.0f));
    const float along = (n.axisX[k] * dx + n.axisY[k] * dy + n.axisZ[k] * dz) * (inverse / 32767);
    const float cosW = std::min(n.child[k] & LightTreeNode::kTwoSided ? std::abs(along) : along, 1.0f);
    const float sinW = std::sqrt(std::max(1 - cosW * cosW, 0.0f));
    const float cosO = n.cosine[k] * (1.0f / 32767), sinO = std::sqrt(std::max(1 - cosO * cosO, 0.0f));
    const bool within = cosW >= cosO;
    const float cosX = within ? 1.0f : cosW * cosO + sinW * sinO;  // theta_w - theta_o
    const float sinX = within ? 0.0f : sinW * cosO - cosW * sinO;
    const float cosP = cosX >= cosU ? 1.0f : cosX * cosU + sinX * sinU;  // - theta_u
    const float lobe = std::max(cosP + kSlack, 0.0f), spot = cosP >= 1 - kSlack ? 1.0f : 0.0f;
    const float cosI = -(normal.x * dx + normal.y * dy + normal.z * dz) * inverse;
    const float sinI = std::sqrt(std::max(1 - cosI * cosI, 0.0f));
    const float cosR = cosI >= cosU ? 1.0f : cosI * cosU + sinI * sinU;  // theta_i - theta_u
    const float emitted = n.child[k] & LightTreeNode::kConeAlone ? spot : lobe;
    const float facing = emitted * std::max(cosR + kSlack, 0.0f);
    result[k] = n.weight[k] / far2 * (d2 <= r2 ? 1.0f : facing);  // [tree 1]
  }
  return result;
}

namespace {

/// Importances, or weights where there are none.
double shares(const LightTreeNode& node, std::array<float, 4>& importance) {
  const auto sumOf = [](const std::array<float, 4>& v) {
    return (double{v[0]} + double{v[1]}) + (double{v[2]} + double{v[3]});
  };
  const double sum = sumOf(importance);
  if (sum > 0) return sum;
  importance = node.weight;
  return sumOf(importance);
}

/// The child that u falls on; u becomes uniform again.
int drawChild(const std::array<float, 4>& share, double sum, double& u) {
  constexpr double kBelowOne = 1 - 0x1p-53;
  const double at = u * sum;
  int chosen = 0;
  double before = 0, sumBefore = 0;
  for (int k = 0; k < 4; ++k) {
    const bool later = share[k] > 0 && at >= sumBefore;  // the last child that begins at or before `at`
    chosen = later ? k : chosen;
    before = later ? sumBefore : before;
    sumBefore += double{share[k]};
  }
  u = std::min((at - before) / double{share[chosen]}, kBelowOne);
  return chosen;
}

}  // namespace

LightTree::Drawn LightTree::sample(const vec3& position, const vec3& normal, double u) const {
  double probability = 1;
  for (std::uint32_t at = 0;;) {
    const LightTreeNode& node = nodes_[at];
    std::array<float, 4> share = importances(node, position, normal);
    const double sum = shares(node, share);
    const int k = drawChild(share, sum, u);
    probability *= double{share[k]} / sum;
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
    std::array<float, 4> share = importances(node, position, normal);
    const double sum = shares(node, share);
    probability *= double{share[slot % 4]} / sum;
  }
  return probability;
}

}  // namespace core
