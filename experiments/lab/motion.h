// How the laboratory's camera moves over its plane.
#pragma once

#include "core/maths.h"

namespace experiments::lab {

struct MotionParameters {
  float x = 0, y = 0;  ///< pixels a frame
  float rotation = 0;  ///< degrees a frame, around the image's centre
};

template <class V>
void describe(V& v, MotionParameters& p) {
  v("x", p.x, "pixels a frame", -1e3, 1e3);
  v("y", p.y, "pixels a frame", -1e3, 1e3);
  v("rotation", p.rotation, "degrees a frame around the centre", -360.0, 360.0);
}

/// Where an image position lies on the plane, and back; both in pixels, the image's from its centre.
class View {
 public:
  View(const MotionParameters& motion, int frame);
  core::vec2 toPlane(core::vec2 image) const;
  core::vec2 toImage(core::vec2 plane) const;

 private:
  core::vec2 offset_;
  float cosine_, sine_;
};

}  // namespace experiments::lab
