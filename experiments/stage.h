// A scene made ready to render: its trees are built once, and every frame gets only what changes.
#pragma once

#include <memory>

#include "core/gbuffer.h"
#include "core/lights.h"
#include "core/moment.h"
#include "core/scene.h"
#include "core/tracer.h"

namespace experiments {

inline constexpr double kFramesPerSecond = 30;

/// auto: kernels are compiled for what the scene has. all: for everything, to measure what that would cost.
enum class Features { automatic, all };

/// Pose, lights, rays and surfaces of one frame. Lights and tracer are shared with the frame before where nothing
/// moves.
struct Instant {
  std::uint32_t frame = 0;
  core::Pose pose;
  std::shared_ptr<const core::Lights> lights;
  std::shared_ptr<const core::Tracer> tracer;
  core::GBuffer gbuffer;

  core::Moment moment() const {
    return {frame, pose.camera.position, lights, tracer, gbuffer.surfaces, gbuffer.guide.view()};
  }
};

/// A scene and its trees; immutable, so any number of seeds can render it.
class Stage {
 public:
  /// scene must outlive the stage.
  explicit Stage(const core::Scene& scene);

  /// Pose, lights and tracer of a frame, without G-buffer. before: a neighbouring frame to share from, or null.
  void pose(std::uint32_t frame, const Instant* before, Instant& out) const;
  /// Traces out's G-buffer, which must have its size. before: the pose of the frame before.
  void trace(const core::Pose& before, Features features, int tile, Instant& out) const;

  const core::Scene& scene() const { return scene_; }
  const core::SceneMotion& motion() const { return motion_; }

 private:
  const core::Scene& scene_;
  core::SceneMotion motion_;
  core::SurfaceFeatures features_;
  std::shared_ptr<const core::MeshTrees> trees_;
};

}  // namespace experiments
