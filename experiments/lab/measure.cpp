#include "experiments/lab/measure.h"

#include <limits>

#include "core/parallel.h"

namespace experiments::lab {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint8_t kFar = 0, kInside = 1, kOutside = 2;

/// Whether a pixel of the other kind lies within the band.
bool nearBorder(core::In<std::uint8_t> inside, int x, int y) {
  constexpr int r = BorderStep::kBand;
  const bool own = inside(x, y) != 0;
  for (int qy = std::max(0, y - r); qy <= std::min(y + r, inside.height - 1); ++qy)
    for (int qx = std::max(0, x - r); qx <= std::min(x + r, inside.width - 1); ++qx)
      if ((inside(qx, qy) != 0) != own) return true;
  return false;
}

core::Image<std::uint8_t> sidesOf(core::In<std::uint8_t> inside) {
  core::Image<std::uint8_t> side(inside.width, inside.height);
  core::forEachPixel(inside.width, inside.height, [&](int x, int y) {
    side(x, y) = nearBorder(inside, x, y) ? (inside(x, y) ? kInside : kOutside) : kFar;
  });
  return side;
}

}  // namespace

void BorderStep::addCell(core::In<float> error, core::In<std::uint8_t> side, int x0, int y0) {
  std::array<double, 3> sum{};
  std::array<int, 3> count{};
  for (int y = y0; y < std::min(y0 + kCell, error.height); ++y)
    for (int x = x0; x < std::min(x0 + kCell, error.width); ++x)
      sum[side(x, y)] += static_cast<double>(error(x, y)), ++count[side(x, y)];
  if (count[kInside] < kLeast || count[kOutside] < kLeast) return;
  const double step = sum[kInside] / count[kInside] - sum[kOutside] / count[kOutside];
  sum_ += step * step;
  ++cells_;
}

void BorderStep::add(core::In<float> error, core::In<std::uint8_t> inside) {
  const core::Image<std::uint8_t> side = sidesOf(inside);
  for (int y = 0; y < error.height; y += kCell)
    for (int x = 0; x < error.width; x += kCell) addCell(error, side, x, y);
}

double BorderStep::meanSquare() const { return cells_ > 0 ? sum_ / static_cast<double>(cells_) : kNaN; }

void Measure::add(core::PlanesView<const float> image, core::PlanesView<const float> truth,
                  const FovealMemory& memory) {
  core::Image<float> error(image.width(), image.height());
  core::forEachPixel(error.width(), error.height(), [&](int x, int y) {
    error(x, y) = core::luminance(image.load(x, y)) - core::luminance(truth.load(x, y));
  });
  for (const Region region : kRegions) {
    const core::In<std::uint8_t> mask = memory.mask(region);
    const auto r = static_cast<std::size_t>(region);
    for (int y = 0; y < error.height(); ++y)
      for (int x = 0; x < error.width(); ++x) {
        if (!mask.empty() && !mask(x, y)) continue;
        sums_[r] += static_cast<double>(error(x, y)) * static_cast<double>(error(x, y));
        ++pixels_[r];
      }
  }
  steps_[0].add(error, memory.mask(Region::fovea));
  steps_[1].add(error, memory.mask(Region::recentlyFoveal));
}

double Measure::squaredError(Region region) const {
  const auto r = static_cast<std::size_t>(region);
  return pixels_[r] > 0 ? sums_[r] / static_cast<double>(pixels_[r]) : kNaN;
}

}  // namespace experiments::lab
