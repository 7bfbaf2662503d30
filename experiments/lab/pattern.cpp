#include "experiments/lab/pattern.h"

#include "core/parallel.h"
#include "core/random.h"
#include "experiments/stage.h"

namespace experiments::lab {

float Pattern::countAt(std::uint64_t seed, std::uint32_t frame, int x, int y, int width) const {
  const float most = parameters_.most;
  if (parameters_.kind == PatternKind::checkerboard)
    return (static_cast<std::uint32_t>(x + y) + frame) % 2 == 0 ? most : 0.0f;
  if (parameters_.kind == PatternKind::random) {
    core::Rng rng(seed, core::Pass::foveation, static_cast<std::uint32_t>(y * width + x), frame);
    return static_cast<float>(rng.below(static_cast<std::uint32_t>(most) + 1));
  }
  return most;
}

void Pattern::place(std::uint64_t seed, std::uint32_t frame, core::ImageView<float> n,
                    core::ImageView<std::uint8_t> fovea) const {
  if (parameters_.kind == PatternKind::fovea)
    return foveation_.place(gaze_.at(frame / kFramesPerSecond, n.width, n.height), seed, frame, n, fovea);
  core::forEachPixel(n.width, n.height, [&](int x, int y) {
    n(x, y) = countAt(seed, frame, x, y, n.width);
    fovea(x, y) = 0;
  });
}

}  // namespace experiments::lab
