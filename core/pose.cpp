// Evaluates a scene's animation at an instant: tracks, node hierarchy, flicker, camera.
// Source: glTF 2.0 specification, section 3.11 and appendix C (interpolation modes).
#include <glm/gtc/matrix_transform.hpp>

#include "core/bounds.h"
#include "core/check.h"
#include "core/scene.h"

namespace core {
namespace {

constexpr float kDefaultYfov = kPi * 40 / 180;       ///< of the camera made for a scene without one
constexpr float kDefaultElevation = kPi * 15 / 180;  ///< that camera looks down by so much

quat toQuat(const vec4& v) { return {v.w, v.x, v.y, v.z}; }
vec4 toVec(const quat& q) { return {q.x, q.y, q.z, q.w}; }

/// Unit quaternion along v; the identity for a zero one.
vec4 normalizedQuaternion(const vec4& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : vec4(0, 0, 0, 1);
}

vec4 valueOfKey(const Track& track, std::size_t key) {
  return track.interpolation == Interpolation::cubic ? track.values[3 * key + 1] : track.values[key];
}

/// Cubic Hermite spline between keys k and k + 1; step: seconds between them, u in [0, 1]. [glTF 2.0, appendix C.5]
vec4 cubicSpline(const Track& track, std::size_t k, float step, float u) {
  const float u2 = u * u, u3 = u2 * u;
  const vec4 &v0 = track.values[3 * k + 1], &out0 = track.values[3 * k + 2];
  const vec4 &in1 = track.values[3 * k + 3], &v1 = track.values[3 * k + 4];
  return (2 * u3 - 3 * u2 + 1) * v0 + step * (u3 - 2 * u2 + u) * out0 + (3 * u2 - 2 * u3) * v1 + step * (u3 - u2) * in1;
}

vec4 between(const Track& track, std::size_t k, float time, bool quaternion) {
  const float step = track.times[k + 1] - track.times[k], u = (time - track.times[k]) / step;
  switch (track.interpolation) {
    case Interpolation::step:
      return track.values[k];
    case Interpolation::cubic:
      return cubicSpline(track, k, step, u);
    case Interpolation::linear:
      break;
  }
  const vec4 &a = track.values[k], &b = track.values[k + 1];
  if (!quaternion) return lerp(a, b, u);
  return toVec(glm::slerp(toQuat(normalizedQuaternion(a)), toQuat(normalizedQuaternion(b)), u));  // shortest path
}

/// The raw value; a cubic or stored quaternion may not have unit length yet.
vec4 evaluateKeys(const Track& track, float time, bool quaternion) {
  const std::size_t keys = track.times.size();
  CHECK_EQ(track.values.size(), track.interpolation == Interpolation::cubic ? 3 * keys : keys);
  if (!(time > track.times.front())) return valueOfKey(track, 0);
  if (time >= track.times.back()) return valueOfKey(track, keys - 1);
  const auto next = std::upper_bound(track.times.begin(), track.times.end(), time);
  return between(track, static_cast<std::size_t>(next - track.times.begin()) - 1, time, quaternion);
}

mat4 localMatrix(const Node& node, float time) {
  const bool animated = !node.translationTrack.empty() || !node.rotationTrack.empty() || !node.scaleTrack.empty();
  if (node.hasMatrix && !animated) return node.matrix;
  vec3 translation = node.translation, scale = node.scale;
  quat rotation = node.rotation;
  if (!node.translationTrack.empty()) translation = vec3(evaluate(node.translationTrack, time, false));
  if (!node.rotationTrack.empty()) rotation = toQuat(evaluate(node.rotationTrack, time, true));
  if (!node.scaleTrack.empty()) scale = vec3(evaluate(node.scaleTrack, time, false));
  return glm::scale(glm::translate(mat4(1), translation) * glm::mat4_cast(rotation), scale);
}

std::vector<mat4> nodesToWorld(const Scene& scene, float time) {
  std::vector<mat4> toWorld;
  toWorld.reserve(scene.nodes.size());
  for (const Node& node : scene.nodes) {
    CHECK_LT(node.parent, static_cast<int>(toWorld.size()));  // parents come first
    const mat4 local = localMatrix(node, time);
    toWorld.push_back(node.parent < 0 ? local : toWorld[node.parent] * local);
  }
  return toWorld;
}

std::vector<float> emissionFactors(const Scene& scene, float time) {
  std::vector<float> factors;
  factors.reserve(scene.materials.size());
  for (const Material& material : scene.materials) {
    const bool flickers = material.flicker >= 0 && !scene.flickers[material.flicker].empty();
    factors.push_back(flickers ? std::max(0.0f, evaluate(scene.flickers[material.flicker], time, false).x) : 1.0f);
  }
  return factors;
}

/// Sees the whole bounding sphere, from the side of +z and slightly above.
Camera framingCamera(const Bounds& bounds) {
  const vec3 centre = 0.5f * (bounds.low + bounds.high);
  const float radius = std::max(0.5f * glm::length(bounds.high - bounds.low), 1e-6f);
  const float distance = radius / std::sin(0.5f * kDefaultYfov);
  const mat4 tilt = glm::rotate(mat4(1), -kDefaultElevation, vec3(1, 0, 0));
  Camera camera = cameraFromMatrix(tilt, kDefaultYfov);
  camera.position = centre - distance * camera.forward;
  return camera;
}

bool isUsable(const Camera& camera) {
  return isFinite(camera.position) && isFinite(camera.right) && isFinite(camera.up) && isFinite(camera.forward);
}

Camera cameraOf(const Scene& scene, const std::vector<mat4>& toWorld, int index) {
  if (scene.cameras.empty()) return framingCamera(sceneBounds(scene, meshBounds(scene), nodesToWorld(scene, 0)));
  const int count = static_cast<int>(scene.cameras.size());
  if (index < 0 || index >= count)
    throw UsageError(scene.name, "camera " + std::to_string(index) + " does not exist",
                     "choose 0 to " + std::to_string(count - 1));
  const SceneCamera& choice = scene.cameras[index];
  const Camera camera = cameraFromMatrix(toWorld[choice.node], choice.yfov);
  if (!isUsable(camera))
    throw Error(scene.name, "camera " + std::to_string(index) + " has a transform without directions",
                "give its node and its parents finite values and a scale other than 0");
  return camera;
}

/// False also for tracks whose values all agree, as exporters like to write.
bool changes(const Track& track) {
  return std::any_of(track.values.begin(), track.values.end(), [&](const vec4& v) { return v != track.values[0]; });
}

bool moves(const Node& node) {
  return changes(node.translationTrack) || changes(node.rotationTrack) || changes(node.scaleTrack);
}

bool flickers(const Scene& scene, const Material& material) {
  return material.emits() && material.flicker >= 0 && changes(scene.flickers[material.flicker]);
}

}  // namespace

vec4 evaluate(const Track& track, float time, bool quaternion) {
  CHECK(!track.empty());
  const vec4 value = evaluateKeys(track, time, quaternion);
  return quaternion ? normalizedQuaternion(value) : value;
}

SceneMotion motionOf(const Scene& scene) {
  SceneMotion motion;
  for (const Node& node : scene.nodes)
    motion.nodeMoves.push_back(moves(node) || (node.parent >= 0 && motion.nodeMoves[node.parent]));
  for (const Instance& instance : scene.instances) {
    const Material& material = scene.materials[scene.meshes[instance.mesh].material];
    const bool moving = motion.nodeMoves[instance.node];
    motion.instances = motion.instances || moving;
    motion.lights = motion.lights || (moving && material.emits()) || flickers(scene, material);
  }
  for (const PunctualLight& light : scene.punctual) motion.lights = motion.lights || motion.nodeMoves[light.node];
  return motion;
}

Pose poseAt(const Scene& scene, double time, int camera) {
  Pose pose;
  pose.time = time;
  pose.nodeToWorld = nodesToWorld(scene, static_cast<float>(time));
  pose.materialEmission = emissionFactors(scene, static_cast<float>(time));
  pose.camera = cameraOf(scene, pose.nodeToWorld, camera);
  return pose;
}

}  // namespace core
