// Building a light tree: lights are divided in two again and again, and every two levels become one of four children.
#include "core/check.h"
#include "core/light_bounds.h"
#include "core/light_split.h"
#include "core/light_tree.h"
#include "core/parallel.h"

namespace core {
namespace {

constexpr std::size_t kParallel = 4096;  // lights from which on two halves are worth two tasks

/// weight: of a light's power, what leaves straight ahead; power is over all sides and directions, as Lights counts it.
LightItem triangleItem(const Lights& lights, std::uint32_t i) {
  const TriangleLight& t = lights.triangle(i);
  Bounds box;
  for (const vec3& p : {t.origin, t.origin + t.edge1, t.origin + t.edge2}) box.add(p);
  const vec3 normal = normalize(t.cross2Area()) * (t.flags & TriangleLight::kMirrored ? -1.0f : 1.0f);
  const float sides = t.flags & TriangleLight::kDoubleSided ? 2.0f : 1.0f;
  return {box.low,
          box.high,
          isFinite(normal) ? normal : vec3(0, 0, 1),
          isFinite(normal) ? 1.0f : -1.0f,
          lights.probability(i) / sides,
          i};
}

LightItem punctualItem(const Lights& lights, std::uint32_t i) {
  const PunctualState& p = lights.punctual(i);
  const bool spot = p.type == PunctualLight::Type::spot;
  const float directions = spot ? 2 - p.cosInner - p.cosOuter : 4.0f;
  return {p.position, p.position, p.direction, spot ? p.cosOuter : -1.0f, lights.probability(i) / directions, i};
}

std::vector<LightItem> itemsOf(const Lights& lights) {
  std::vector<LightItem> items;
  for (std::uint32_t i = 0; i < lights.size(); ++i)
    if (lights.probability(i) > 0 && !lights.isInfinite(i))
      items.push_back(lights.isArea(i) ? triangleItem(lights, i) : punctualItem(lights, i));
  return items;
}

}  // namespace

class LightTreeBuilder {
 public:
  LightTreeBuilder(const Lights& lights, LightTree& tree) : lights_(lights), tree_(tree), items_(itemsOf(lights)) {
    if (items_.empty()) return;
    if (items_.size() > LightTreeNode::kIndex) throw Error("light tree", "too many lights", "use at most 2^29");
    split_.resize(2 * items_.size());
    nodesBelow_.resize(2 * items_.size());
    const Range all{0, 0, static_cast<std::uint32_t>(items_.size())};
    divide(all);
    normalise();
    const std::size_t count = std::max(nodesBelow_[0], 1u);
    tree.nodes_.resize(count);
    tree.parent_.assign(count, LightTree::kNoSlot);
    tree.slotOf_.assign(lights.size(), LightTree::kNoSlot);
    emit(all, 0);
  }

 private:
  /// A node of the binary tree: items [begin, end). Its left half is node + 1, its right half comes after all of that.
  struct Range {
    std::uint32_t node = 0, begin = 0, end = 0;
    std::uint32_t size() const { return end - begin; }
  };
  struct Children {
    std::array<Range, 4> range;
    int count = 0;
  };

  Range left(const Range& r) const { return {r.node + 1, r.begin, split_[r.node]}; }
  Range right(const Range& r) const { return {r.node + 2 * (split_[r.node] - r.begin), split_[r.node], r.end}; }

  /// The largest of two, then three ranges is divided again, unless it fits into one node. (So how at most four lights
  /// are divided never matters.)
  Children childrenOf(const Range& r) const {
    if (r.size() == 1) return {{r}, 1};
    Children c{{left(r), right(r)}, 2};
    while (c.count < 4) {
      const auto end = c.range.begin() + c.count;
      const auto largest =
          std::max_element(c.range.begin(), end, [](const Range& a, const Range& b) { return a.size() < b.size(); });
      if (largest->size() <= (r.size() <= 4 ? 1u : 4u)) break;
      const Range parent = *largest;
      std::move_backward(largest + 1, end, end + 1);
      *largest = left(parent);
      *(largest + 1) = right(parent);
      ++c.count;
    }
    return c;
  }

  template <class Body>
  static void forBoth(std::size_t size, std::size_t count, Body&& body) {
    if (size > kParallel) return forEachIndex(count, body);
    for (std::size_t i = 0; i < count; ++i) body(i);
  }

  void divide(const Range& r) {
    if (r.size() == 1) return;
    split_[r.node] = r.begin + static_cast<std::uint32_t>(
                                   r.size() <= 4 ? 1 : splitLights(std::span(items_).subspan(r.begin, r.size())));
    forBoth(r.size(), 2, [&](std::size_t i) { divide(i == 0 ? left(r) : right(r)); });
    std::uint32_t nodes = 1;
    const Children children = childrenOf(r);
    for (int k = 0; k < children.count; ++k) nodes += nodesBelow_[children.range[k].node];
    nodesBelow_[r.node] = nodes;
  }

  /// Weights such that importances stay far inside float's range wherever the surface is.
  void normalise() {
    Bounds box;
    double weight = 0;
    for (const LightItem& item : items_) box.add(item.low), box.add(item.high), weight += item.weight;
    const vec3 half = 0.5f * (box.high - box.low);
    const float radius2 = dot(half, half) > 0 ? dot(half, half) : 1.0f;
    scale_ = 0x1p40 * radius2 / weight;
    tree_.leastDistance2_ = 1e-12f * radius2;
  }

  LightBounds boundsOf(const LightItem& item) const {
    LightBounds b{item.centre(), 0, {item.low, item.high}, {item.axis, item.cosine}, false, false, double{item.weight}};
    if (lights_.isArea(item.light)) {
      const TriangleLight& t = lights_.triangle(item.light);
      for (const vec3& p : {t.origin, t.origin + t.edge1, t.origin + t.edge2})
        b.radius = std::max(b.radius, length(p - b.centre));
      b.twoSided = t.flags & TriangleLight::kDoubleSided;
    } else {
      b.coneAlone = lights_.punctual(item.light).type == PunctualLight::Type::spot;
    }
    return b;
  }

  void store(const LightBounds& b, std::uint32_t child, LightTreeNode& node, int k) const {
    constexpr float kRounding = 7e-5f;  // of the axis, as an angle
    const auto packed = [](float v) { return static_cast<std::int16_t>(v); };
    node.x[k] = b.centre.x, node.y[k] = b.centre.y, node.z[k] = b.centre.z;
    const vec3 size = glm::abs(b.centre);
    node.radius[k] = b.radius * (1 + 1e-5f) + 1e-6f * maxComponent(size);
    node.axisX[k] = packed(std::round(b.cone.axis.x * 32767));
    node.axisY[k] = packed(std::round(b.cone.axis.y * 32767));
    node.axisZ[k] = packed(std::round(b.cone.axis.z * 32767));
    node.cosine[k] = packed(std::floor(std::max(b.cone.cosine - kRounding, -1.0f) * 32767));
    node.weight[k] = static_cast<float>(b.weight * scale_);
    node.child[k] = child | (b.twoSided ? LightTreeNode::kTwoSided : 0) | (b.coneAlone ? LightTreeNode::kConeAlone : 0);
  }

  /// Fills node `at` and all below it. Returns the bounds of everything in it.
  LightBounds emit(const Range& r, std::uint32_t at) {
    const Children children = childrenOf(r);
    std::array<std::uint32_t, 4> below{};
    for (std::uint32_t k = 0, next = at + 1; k < static_cast<std::uint32_t>(children.count); ++k) {
      below[k] = next;
      next += nodesBelow_[children.range[k].node];
    }
    std::array<LightBounds, 4> bounds;
    forBoth(r.size(), children.count, [&](std::size_t k) {
      const Range& child = children.range[k];
      const LightItem& item = items_[child.begin];
      const auto slot = static_cast<std::uint32_t>(4 * at + k);
      const bool leaf = child.size() == 1;
      (leaf ? tree_.slotOf_[item.light] : tree_.parent_[below[k]]) = slot;
      bounds[k] = leaf ? boundsOf(item) : emit(child, below[k]);
      store(bounds[k], leaf ? item.light | LightTreeNode::kLeaf : below[k], tree_.nodes_[at], static_cast<int>(k));
    });
    return unite(std::span<const LightBounds>(bounds.data(), children.count));
  }

  const Lights& lights_;
  LightTree& tree_;
  std::vector<LightItem> items_;
  std::vector<std::uint32_t> split_, nodesBelow_;  // per binary node: first item of the right half; nodes of four
  double scale_ = 1;
};

LightTree::LightTree(const Lights& lights) { LightTreeBuilder(lights, *this); }

}  // namespace core
