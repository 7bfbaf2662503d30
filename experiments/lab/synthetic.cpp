#include "experiments/lab/synthetic.h"

#include "core/parallel.h"

namespace experiments::lab {
namespace {

using core::vec2;
using core::vec3;

/// Position of a pixel's centre, from the image's centre.
vec2 centred(int x, int y, int width, int height) {
  return vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) - 0.5f * vec2(width, height);
}

}  // namespace

Synthetic::Synthetic(const Case& c, std::uint64_t seed, int width, int height,
                     const twohistory::ReprojectionParameters& reprojection)
    : case_(c),
      seed_(seed),
      reprojection_(reprojection),
      pattern_(c.pattern),
      noise_(c.noise, seed, width, height),
      guides_{core::GuideImages(width, height), core::GuideImages(width, height)},
      radiance_(width, height),
      truth_(width, height),
      albedo_(width, height, 1),
      emission_(width, height, 0),
      check_(width, height),
      samples_(width, height),
      fovea_(width, height),
      taps_(width, height) {
  for (core::GuideImages& g : guides_) {
    g.depth.fill(4);
    g.depthSlope.fill(0.01f);
    core::forEachPixel(width, height, [&](int x, int y) { g.normal.view().store(x, y, vec3(0, 0, 1)); });
  }
}

void Synthetic::fillGuide(core::GuideImages& guide) const {
  const View now(case_.motion, frame_), before(case_.motion, frame_ - 1);
  const int width = guide.id.width(), height = guide.id.height();
  core::forEachPixel(width, height, [&](int x, int y) {
    const vec2 here = centred(x, y, width, height), plane = now.toPlane(here);
    guide.id(x, y) = surfaceAt(case_.signal, plane);
    guide.motion(x, y) = before.toImage(plane) - here;
  });
}

void Synthetic::fillTruth() {
  const View now(case_.motion, frame_);
  const int width = truth_.width(), height = truth_.height();
  core::forEachPixel(width, height, [&](int x, int y) {
    const vec2 plane = now.toPlane(centred(x, y, width, height));
    truth_.view().store(x, y, colourAt(case_.signal, plane, frame_));
  });
}

/// One independent result in a block of 2x2 pixels, as the renderer gives.
void Synthetic::fillCheck() {
  const auto frame = static_cast<std::uint32_t>(frame_);
  core::forEachPixel(check_.width(), check_.height(), [&](int x, int y) {
    const float n = samples_(x, y);
    const bool checked = n > 0 && static_cast<std::uint32_t>((x & 1) + 2 * (y & 1)) == frame % 4;
    const vec3 truth = truth_.view().load(x, y);
    check_.view().store(x, y, checked ? noise_.independent(x, y, n, frame) * truth : vec3(-1));
  });
}

Shaded Synthetic::next() {
  ++frame_;
  now_ = 1 - now_;
  const auto frame = static_cast<std::uint32_t>(frame_);
  fillGuide(guides_[now_]);
  const core::Guide now = guides_[now_].view(), before = guides_[frame_ > 0 ? 1 - now_ : now_].view();
  if (frame_ > 0)
    twohistory::reproject(now, before, reprojection_, taps_);
  else
    taps_.fill({});
  fillTruth();
  pattern_.place(seed_, frame, samples_, fovea_);
  noise_.advance(samples_, taps_, frame);
  core::forEachPixel(now.width(), now.height(),
                     [&](int x, int y) { radiance_.view().store(x, y, noise_.at(x, y) * truth_.view().load(x, y)); });
  const bool reused = noise_.isReused();
  if (reused) fillCheck();
  return {radiance_, albedo_, emission_, samples_, now, before, reused ? check_.view() : core::PlanesView<float>{},
          taps_};
}

}  // namespace experiments::lab
