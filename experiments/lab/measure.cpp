#include "experiments/lab/measure.h"

#include "core/maths.h"
#include "core/parallel.h"

namespace experiments::lab {
void Measure::add(core::PlanesView<const float> image, core::PlanesView<const float> truth,
                  const FovealMemory& memory) {
  core::Image<float> error(image.width(), image.height()), seen(error), level(error), colour(error);
  core::forEachPixel(error.width(), error.height(), [&](int x, int y) {
    seen(x, y) = core::luminance(image.load(x, y)), level(x, y) = core::luminance(truth.load(x, y));
    error(x, y) = seen(x, y) - level(x, y);
    const core::vec3 difference = image.load(x, y) - truth.load(x, y);
    colour(x, y) = dot(difference, difference) / 3;
  });
  for (const Region region : kRegions) {
    const core::In<std::uint8_t> mask = memory.mask(region);
    const auto r = static_cast<std::size_t>(region);
    for (int y = 0; y < error.height(); ++y)
      for (int x = 0; x < error.width(); ++x) {
        if (!mask.empty() && !mask(x, y)) continue;
        sums_[r] += static_cast<double>(error(x, y)) * static_cast<double>(error(x, y));
        colour_[r] += static_cast<double>(colour(x, y));
        ++pixels_[r];
      }
  }
  steps_[0].add(seen, {level, level}, memory.mask(Region::fovea));
  steps_[1].add(seen, {level, level}, memory.mask(Region::recentlyFoveal));
}

double Measure::mean(const std::array<double, kRegions.size()>& sums, Region region) const {
  const auto r = static_cast<std::size_t>(region);
  return pixels_[r] > 0 ? sums[r] / static_cast<double>(pixels_[r]) : core::kNaN;
}

double Measure::squaredError(Region region) const { return mean(sums_, region); }

double Measure::squaredColourError(Region region) const { return mean(colour_, region); }

}  // namespace experiments::lab
