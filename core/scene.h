// A scene as data: what a glTF file says, without acceleration structures. poseAt() evaluates it at an instant.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/maths.h"

namespace core {

class Environment;

/// 8-bit RGBA texels; row 0 is the top (v = 0), as in glTF.
struct Texture {
  enum class Wrap : std::uint8_t { repeat, mirror, clamp };
  int width = 0, height = 0;
  std::vector<std::uint8_t> texels;  ///< 4 x width x height
  Wrap wrapU = Wrap::repeat, wrapV = Wrap::repeat;
};

/// glTF metallic-roughness material. Texture indices refer to Scene::textures, -1 = none.
struct Material {
  std::string name;
  vec3 baseColor{1};
  float metallic = 1, roughness = 1;
  vec3 emission{0};  ///< radiance (W / m^2 / sr, taken as glTF's nit times emissive strength)
  bool doubleSided = false;
  int baseColorTexture = -1;          ///< sRGB
  int metallicRoughnessTexture = -1;  ///< linear; green roughness, blue metallic
  int emissionTexture = -1;           ///< sRGB
  int normalTexture = -1;             ///< linear, tangent space
  float normalScale = 1;
  int flicker = -1;  ///< index into Scene::flickers, -1 = constant emission
  bool emits() const { return maxComponent(emission) > 0; }
};

enum class Interpolation : std::uint8_t { linear, step, cubic };

/// Keyframes of a value of N floats. cubic holds (in-tangent, value, out-tangent) per key, as glTF does.
struct Track {
  std::vector<float> times;  ///< seconds, ascending; empty = not animated
  std::vector<vec4> values;  ///< xyz, or a quaternion as xyzw, or a scalar in x
  Interpolation interpolation = Interpolation::linear;
  bool empty() const { return times.empty(); }
};

/// One primitive: triangles of one material.
struct Mesh {
  std::string name;
  std::vector<vec3> positions, normals;  ///< normals empty = flat
  std::vector<vec2> uvs;                 ///< empty = none
  std::vector<uvec3> triangles;
  int material = 0;
};

/// A transform in the hierarchy; local = matrix if hasMatrix, else translation * rotation * scale.
struct Node {
  std::string name;
  int parent = -1;  ///< parents come before their children
  vec3 translation{0};
  quat rotation{1, 0, 0, 0};
  vec3 scale{1};
  bool hasMatrix = false;
  mat4 matrix{1};
  Track translationTrack, rotationTrack, scaleTrack;
};

struct Instance {
  int mesh = 0, node = 0;
};

/// KHR_lights_punctual; shines along its node's -z. candela and lux are taken as radiometric values.
struct PunctualLight {
  enum class Type : std::uint8_t { point, spot, directional };
  Type type = Type::point;
  vec3 intensity{1};                           ///< W/sr (point, spot) or W/m^2 (directional)
  float innerAngle = 0, outerAngle = kPi / 4;  ///< spot cone half angles, radians
  int node = 0;
};

struct SceneCamera {
  std::string name;
  float yfov = 0.8f;  ///< radians
  int node = 0;
};

/// A glTF file's content, or a built-in scene.
struct Scene {
  std::string name;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;
  std::vector<Instance> instances;
  std::vector<PunctualLight> punctual;
  std::vector<SceneCamera> cameras;
  std::vector<Track> flickers;                     ///< emission factors over time (scalar, x)
  std::shared_ptr<const Environment> environment;  ///< light from infinitely far away, or null
  std::vector<std::string> warnings;               ///< what of the file is not supported, one line each
};

/// What about a scene can change between frames; decided once, so that nothing is paid for what a scene lacks.
struct SceneMotion {
  std::vector<bool> nodeMoves;  ///< per node, ancestors included
  bool instances = false;       ///< any instance moves
  bool lights = false;          ///< any light moves or flickers
};
SceneMotion motionOf(const Scene& scene);

/// The scene at an instant.
struct Pose {
  double time = 0;                      ///< seconds
  std::vector<mat4> nodeToWorld;        ///< per node
  std::vector<float> materialEmission;  ///< per material, factor on emission (flicker)
  Camera camera;
};

/// Evaluates animation at time. camera: index into scene.cameras; a scene without one gets a camera that frames its
/// bounds.
Pose poseAt(const Scene& scene, double time, int camera = 0);

/// Value of a track at time, clamped to its ends; quaternions are interpolated on the sphere.
vec4 evaluate(const Track& track, float time, bool quaternion);

}  // namespace core
