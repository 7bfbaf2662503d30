#include "experiments/stage.h"

namespace experiments {

Stage::Stage(const core::Scene& scene)
    : scene_(scene),
      motion_(core::motionOf(scene)),
      features_(core::featuresOf(scene, motion_)),
      trees_(core::buildMeshTrees(scene)) {}

void Stage::pose(std::uint32_t frame, const Instant* before, Instant& out) const {
  out.frame = frame;
  out.pose = core::poseAt(scene_, frame / kFramesPerSecond);
  const bool sameLights = before && before->lights && !motion_.lights;
  const bool sameTracer = before && before->tracer && !motion_.instances;
  out.lights = sameLights ? before->lights
                          : std::make_shared<core::Lights>(scene_, out.pose, before ? before->lights.get() : nullptr);
  out.tracer = sameTracer ? before->tracer : std::make_shared<core::Tracer>(trees_, scene_, out.pose);
}

void Stage::trace(const core::Pose& before, Features features, int tile, Instant& out) const {
  const core::SurfaceFeatures compiled = features == Features::all ? core::SurfaceFeatures{true, true} : features_;
  core::traceGBuffer(scene_, out.pose, before, *out.tracer, compiled, out.gbuffer, tile);
}

}  // namespace experiments
