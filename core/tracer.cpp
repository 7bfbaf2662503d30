#include "core/tracer.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <bit>
#include <vector>

#include "core/check.h"
#include "core/parallel.h"

namespace core {
namespace {

/// A failed allocation or an unsupported processor is not a logic error: it becomes an exception with Embree's words.
void throwOnError(RTCDevice device) {
  const RTCError code = rtcGetDeviceError(device);
  if (code != RTC_ERROR_NONE)
    throw Error("Embree", "error " + std::to_string(static_cast<int>(code)), "check memory and processor");
}

/// Builds with one thread, so that a tree (and which of two coincident triangles is hit) never depends on their number.
void commitDeterministically(RTCScene scene) {
  tbb::task_arena arena(1);
  arena.execute([scene] { rtcJoinCommitScene(scene); });
}

RTCRayHit makeRay(const vec3& origin, const vec3& direction, float minimum, float maximum) {
  RTCRayHit r{};
  r.ray.org_x = origin.x, r.ray.org_y = origin.y, r.ray.org_z = origin.z;
  r.ray.dir_x = direction.x, r.ray.dir_y = direction.y, r.ray.dir_z = direction.z;
  r.ray.tnear = minimum, r.ray.tfar = maximum;
  r.ray.mask = ~0u;
  r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return r;
}

Hit toHit(const RTCRayHit& r) {
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {r.ray.tfar, r.hit.instID[0], r.hit.primID, {r.hit.u, r.hit.v}, {r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z}};
}

Hit nearest(RTCScene scene, const vec3& origin, const vec3& direction, float minimum, float maximum) {
  RTCRayHit ray = makeRay(origin, direction, minimum, maximum);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
  return toHit(ray);
}

RTCScene newScene(RTCDevice device, RTCBuildQuality quality) {
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);  // watertight: no light through shared edges
  rtcSetSceneBuildQuality(scene, quality);
  return scene;
}

}  // namespace

/// One committed Embree scene a mesh. Vertices are copied: Embree pads them for its vector loads.
class MeshTrees {
 public:
  explicit MeshTrees(const Scene& scene) : device_(rtcNewDevice(nullptr)), trees_(scene.meshes.size()) {
    if (!device_) throwOnError(nullptr);
    forEachIndex(trees_.size(), [&](std::size_t i) { trees_[i] = build(scene.meshes[i]); });
    throwOnError(device_);
  }
  ~MeshTrees() {
    for (RTCScene tree : trees_) rtcReleaseScene(tree);
    rtcReleaseDevice(device_);
  }
  MeshTrees(const MeshTrees&) = delete;
  MeshTrees& operator=(const MeshTrees&) = delete;

  RTCDevice device() const { return device_; }
  RTCScene tree(int mesh) const { return trees_[mesh]; }

 private:
  RTCScene build(const Mesh& mesh) const {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3),
                                             mesh.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(uvec3),
                                            mesh.triangles.size());
    if (vertices) std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<vec3*>(vertices));
    if (indices) std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<uvec3*>(indices));
    rtcCommitGeometry(geometry);
    const RTCScene tree = newScene(device_, RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometryByID(tree, geometry, 0);
    rtcReleaseGeometry(geometry);
    commitDeterministically(tree);
    return tree;
  }

  RTCDevice device_;
  std::vector<RTCScene> trees_;
};

std::shared_ptr<const MeshTrees> buildMeshTrees(const Scene& scene) { return std::make_shared<MeshTrees>(scene); }

struct Tracer::Impl {
  std::shared_ptr<const MeshTrees> trees;
  RTCScene all, lights;

  Impl(std::shared_ptr<const MeshTrees> shared, const Scene& scene, const Pose& pose)
      : trees(std::move(shared)),
        all(newScene(trees->device(), RTC_BUILD_QUALITY_MEDIUM)),
        lights(newScene(trees->device(), RTC_BUILD_QUALITY_MEDIUM)) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const Instance& instance = scene.instances[i];
      const mat4& toWorld = pose.nodeToWorld[instance.node];
      attach(all, i, instance.mesh, toWorld);
      if (scene.materials[scene.meshes[instance.mesh].material].emits()) attach(lights, i, instance.mesh, toWorld);
    }
    commitDeterministically(all);
    commitDeterministically(lights);
    throwOnError(trees->device());
  }
  ~Impl() {
    rtcReleaseScene(all);
    rtcReleaseScene(lights);
  }

  void attach(RTCScene scene, std::size_t id, int mesh, const mat4& toWorld) const {
    const RTCGeometry geometry = rtcNewGeometry(trees->device(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, trees->tree(mesh));
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &toWorld);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(id));
    rtcReleaseGeometry(geometry);
  }
};

Tracer::Tracer(std::shared_ptr<const MeshTrees> trees, const Scene& scene, const Pose& pose)
    : impl_(std::make_unique<Impl>(std::move(trees), scene, pose)) {}
Tracer::~Tracer() = default;

Hit Tracer::intersect(const vec3& origin, const vec3& direction, float minimum, float maximum) const {
  return nearest(impl_->all, origin, direction, minimum, maximum);
}

Hit Tracer::intersectLights(const vec3& origin, const vec3& direction, float minimum) const {
  return nearest(impl_->lights, origin, direction, minimum, kInfinity);
}

void Tracer::intersectPacket(const vec3& origin, const vec3* directions, int count, Hit* hits) const {
  RTCRayHit8 r;
  alignas(32) int valid[kPacket];
  for (int i = 0; i < kPacket; ++i) {
    const vec3& d = directions[std::min(i, count - 1)];
    valid[i] = i < count ? -1 : 0;
    r.ray.org_x[i] = origin.x, r.ray.org_y[i] = origin.y, r.ray.org_z[i] = origin.z;
    r.ray.dir_x[i] = d.x, r.ray.dir_y[i] = d.y, r.ray.dir_z[i] = d.z;
    r.ray.tnear[i] = 0, r.ray.tfar[i] = kInfinity, r.ray.time[i] = 0;
    r.ray.mask[i] = ~0u, r.ray.id[i] = 0, r.ray.flags[i] = 0;
    r.hit.geomID[i] = r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, impl_->all, &context, &r);
  for (int i = 0; i < count; ++i) {
    const bool hit = r.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    hits[i] = hit ? Hit{r.ray.tfar[i],
                        r.hit.instID[0][i],
                        r.hit.primID[i],
                        {r.hit.u[i], r.hit.v[i]},
                        {r.hit.Ng_x[i], r.hit.Ng_y[i], r.hit.Ng_z[i]}}
                  : Hit{};
  }
}

bool Tracer::occluded(const vec3& origin, const vec3& direction, float maximum) const {
  RTCRay ray = makeRay(origin, direction, 0, maximum).ray;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->all, &context, &ray);
  return ray.tfar < 0;
}

vec3 offsetOrigin(const vec3& p, const vec3& n) {
  constexpr float kNearZero = 1.0f / 32, kSmall = 1.0f / 65536, kUlps = 256;
  vec3 result;
  for (int i = 0; i < 3; ++i) {
    const auto step = static_cast<std::int32_t>(kUlps * n[i]);
    const auto bits = std::bit_cast<std::int32_t>(p[i]);
    const float moved = std::bit_cast<float>(bits + (p[i] < 0 ? -step : step));
    result[i] = std::abs(p[i]) < kNearZero ? p[i] + kSmall * n[i] : moved;
  }
  return result;
}

}  // namespace core
