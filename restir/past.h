// The instants of recent frames, for reservoirs that waited through frames without samples.
#pragma once

#include <array>
#include <memory>

#include "core/moment.h"

namespace restir {

/// What of a past frame a target needs besides the surface.
struct PastMoment {
  std::uint32_t frame = 0;
  core::vec3 viewer{0};
  std::shared_ptr<const core::Lights> lights;  ///< null: nothing remembered
  std::shared_ptr<const core::Tracer> tracer;  ///< null where no target asks who sees what
};

/// A ring of the last kFrames instants. A reservoir that waited longer is dropped, whatever it holds.
class PastMoments {
 public:
  static constexpr std::uint32_t kFrames = 16;

  /// geometry: keep the tracer too.
  void remember(const core::Moment& now, bool geometry) {
    ring_[now.frame % kFrames] = {now.frame, now.cameraPosition, now.lights, geometry ? now.tracer : nullptr};
  }
  /// The instant of a frame, or null.
  const PastMoment* find(std::uint32_t frame) const {
    const PastMoment& past = ring_[frame % kFrames];
    return past.lights && past.frame == frame ? &past : nullptr;
  }
  /// Releases the lights and tracers of frames before `frame`.
  void forgetBefore(std::uint32_t frame) {
    for (PastMoment& past : ring_)
      if (past.frame < frame) past.lights.reset(), past.tracer.reset();
  }

 private:
  std::array<PastMoment, kFrames> ring_;
};

}  // namespace restir
