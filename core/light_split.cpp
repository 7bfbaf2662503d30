// Binned search for the cheapest plane between two groups of lights.
#include "core/light_split.h"

#include <array>

#include "core/bounds.h"

namespace core {
namespace {

constexpr int kBins = 12;

/// Solid angle that lights of a cone with cosine lobes shine into, weighed by the cosine [Conty Estevez and Kulla 2018,
/// section 4.4, M_Omega with theta_e = pi / 2].
float orientationOf(double cosine) {
  const double angle = std::acos(cosine), wide = std::min(angle + 0.5 * double{kPi}, double{kPi}),
               sine = std::sin(angle);
  const double beyond = 2 * wide * sine - std::cos(angle - 2 * wide) - 2 * angle * sine + cosine;
  return static_cast<float>(2 * double{kPi} * (1 - cosine) + 0.5 * double{kPi} * beyond);
}

/// The same from a table over the cosine.
float orientationCost(float cosine) {
  constexpr int kSteps = 256;
  static const std::array<float, kSteps + 1> kTable = [] {
    std::array<float, kSteps + 1> table{};
    for (int i = 0; i <= kSteps; ++i) table[i] = orientationOf(2.0 * i / kSteps - 1);
    return table;
  }();
  return kTable[static_cast<int>((std::clamp(cosine, -1.0f, 1.0f) + 1) * (0.5f * kSteps) + 0.5f)];
}

/// What some lights together would be as a node. Cones are bounded by the box around their axes: good enough to choose
/// a plane, and much faster than true unions.
struct Group {
  Bounds box, axes;
  float leastCosine = 1, weight = 0;
  std::size_t count = 0;

  void add(const LightItem& item) {
    box.add(item.low), box.add(item.high), axes.add(item.axis);
    leastCosine = std::min(leastCosine, item.cosine);
    weight += item.weight;
    ++count;
  }
  void add(const Group& other) {
    box.low = glm::min(box.low, other.box.low), box.high = glm::max(box.high, other.box.high);
    axes.low = glm::min(axes.low, other.axes.low), axes.high = glm::max(axes.high, other.axes.high);
    leastCosine = std::min(leastCosine, other.leastCosine);
    weight += other.weight;
    count += other.count;
  }
  /// Cosine of a cone around all axes: |v - m| <= rho for unit v bounds v.m from below.
  float coneCosine() const {
    const vec3 middle = 0.5f * (axes.low + axes.high), half = 0.5f * (axes.high - axes.low);
    const float m2 = dot(middle, middle), rho2 = dot(half, half);
    if (!(m2 > 1e-6f)) return -1;
    const float spread = std::clamp((1 + m2 - rho2) / (2 * std::sqrt(m2)), -1.0f, 1.0f);
    if (leastCosine >= 1) return spread;
    if (spread + leastCosine <= 0) return -1;  // the two angles make pi or more
    const auto sine = [](float c) { return std::sqrt(std::max(1 - c * c, 0.0f)); };
    return spread * leastCosine - sine(spread) * sine(leastCosine);
  }
  float cost() const {
    if (count == 0) return 0;
    const vec3 diagonal = box.high - box.low;
    return weight * dot(diagonal, diagonal) * orientationCost(coneCosine());
  }
};

/// Bins along the three axes.
struct Grid {
  vec3 low, scale;  // scale 0: all centres agree
  std::array<std::array<Group, kBins>, 3> bins{};

  explicit Grid(const Bounds& centres) : low(centres.low), scale(0) {
    const vec3 extent = centres.high - centres.low;
    for (int a = 0; a < 3; ++a)
      if (const float s = kBins / extent[a]; extent[a] > 0 && isFinite(s)) scale[a] = s;
  }
  int binOf(const vec3& centre, int axis) const {
    return std::min(static_cast<int>((centre[axis] - low[axis]) * scale[axis]), kBins - 1);
  }
  void add(const LightItem& item) {
    const vec3 centre = item.centre();
    for (int a = 0; a < 3; ++a)
      if (scale[a] > 0) bins[a][binOf(centre, a)].add(item);
  }
};

struct Plane {
  int axis = -1, bin = 0;  ///< bins up to `bin` come first
  float cost = kInfinity;
};

/// Cheapest plane along one axis. longest: the largest extent over this axis' own, against thin boxes.
void searchAxis(const Grid& grid, int axis, float longest, Plane& best) {
  const std::array<Group, kBins>& bins = grid.bins[axis];
  std::array<Group, kBins> after;  // of bins i, i + 1, ...
  after[kBins - 1] = bins[kBins - 1];
  for (int i = kBins - 2; i > 0; --i) (after[i] = bins[i]).add(after[i + 1]);
  Group first;
  for (int i = 0; i + 1 < kBins; ++i) {
    if (bins[i].count > 0) first.add(bins[i]);
    if (first.count == 0 || after[i + 1].count == 0) continue;
    const float cost = longest * (first.cost() + after[i + 1].cost());
    if (cost < best.cost) best = {axis, i, cost};
  }
}

}  // namespace

std::size_t splitLights(std::span<LightItem> items) {
  if (items.size() == 2) return 1;
  Bounds centres;
  for (const LightItem& item : items) centres.add(item.centre());
  Grid grid(centres);
  for (const LightItem& item : items) grid.add(item);
  Plane best;
  const vec3 extent = centres.high - centres.low;
  for (int a = 0; a < 3; ++a)
    if (grid.scale[a] > 0) searchAxis(grid, a, maxComponent(extent) / extent[a], best);
  if (best.axis < 0) return items.size() / 2;  // all at one place
  const auto middle = std::partition(items.begin(), items.end(), [&](const LightItem& item) {
    return grid.binOf(item.centre(), best.axis) <= best.bin;
  });
  return static_cast<std::size_t>(middle - items.begin());
}

}  // namespace core
