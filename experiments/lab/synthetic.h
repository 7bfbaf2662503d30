// Frames without a renderer: a plane that carries a known signal, seen by a moving camera through noise.
#pragma once

#include <string>

#include "experiments/lab/motion.h"
#include "experiments/lab/noise.h"
#include "experiments/lab/pattern.h"
#include "experiments/lab/signal.h"
#include "experiments/pipeline.h"
#include "twohistory/reprojection.h"

namespace experiments::lab {

/// One case of the laboratory: what is true, how it is seen, and whether a spatial filter stands around the histories.
struct Case {
  std::string name;
  SignalParameters signal;
  NoiseParameters noise;
  MotionParameters motion;
  PatternParameters pattern;
  bool filter = false;  ///< spatial filter whose first level is fed back; else histories alone
};

template <class V>
void describe(V& v, Case& p) {
  v("name", p.name, "as in tables");
  v("signal", p.signal, "the truth");
  v("noise", p.noise, "what samples add to it");
  v("motion", p.motion, "of the camera");
  v("pattern", p.pattern, "samples per pixel");
  v("filter", p.filter, "spatial filter around the histories, its first level fed back");
}

/// The frames of one case and seed, in order from 0.
class Synthetic {
 public:
  Synthetic(const Case& c, std::uint64_t seed, int width, int height,
            const twohistory::ReprojectionParameters& reprojection = {});

  /// The next frame. Its views stay valid until the next call.
  Shaded next();
  core::PlanesView<const float> truth() const { return truth_; }
  core::In<std::uint8_t> fovea() const { return fovea_; }
  int frame() const { return frame_; }

 private:
  void fillGuide(core::GuideImages& guide) const;
  void fillTruth();
  void fillCheck();

  Case case_;
  std::uint64_t seed_;
  twohistory::ReprojectionParameters reprojection_;
  int frame_ = -1, now_ = 0;
  Pattern pattern_;
  NoiseField noise_;
  std::array<core::GuideImages, 2> guides_;
  core::Planes radiance_, truth_, albedo_, emission_, check_;
  core::Image<float> samples_;
  core::Image<std::uint8_t> fovea_;
  core::Image<twohistory::Taps> taps_;
};

}  // namespace experiments::lab
