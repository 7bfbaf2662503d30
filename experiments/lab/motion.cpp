#include "experiments/lab/motion.h"

#include <cmath>

namespace experiments::lab {

using core::vec2;

View::View(const MotionParameters& m, int frame) : offset_(vec2(m.x, m.y) * static_cast<float>(frame)) {
  const double angle = static_cast<double>(m.rotation) * frame * static_cast<double>(core::kPi) / 180;
  cosine_ = static_cast<float>(std::cos(angle));
  sine_ = static_cast<float>(std::sin(angle));
}

vec2 View::toPlane(vec2 p) const { return vec2(cosine_ * p.x - sine_ * p.y, sine_ * p.x + cosine_ * p.y) + offset_; }

vec2 View::toImage(vec2 plane) const {
  const vec2 p = plane - offset_;
  return {cosine_ * p.x + sine_ * p.y, cosine_ * p.y - sine_ * p.x};
}

}  // namespace experiments::lab
