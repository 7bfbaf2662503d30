// Listing lights at an instant, weighing them by power, drawing them.
#include "core/lights.h"

#include <array>
#include <optional>

#include "core/bounds.h"
#include "core/check.h"
#include "core/parallel.h"
#include "core/texture.h"
#include "core/texture_mean.h"

namespace core {
namespace {

constexpr std::size_t kGrain = 4096;  // triangles a task
constexpr float kLeastInfinite = 1.0f / 9, kMostInfinite = 0.5f;

const Material& materialOf(const Scene& scene, const Instance& instance) {
  return scene.materials[scene.meshes[instance.mesh].material];
}

std::array<vec2, 3> cornersOf(const Mesh& mesh, std::size_t triangle) {
  if (mesh.uvs.empty()) return {};
  const uvec3 t = mesh.triangles[triangle];
  return {mesh.uvs[t.x], mesh.uvs[t.y], mesh.uvs[t.z]};
}

/// Uniform on the triangle of barycentric weights, continuous. Source: Heitz 2019.
vec2 toBarycentric(vec2 u) {
  return u.y > u.x ? vec2(0.5f * u.x, u.y - 0.5f * u.x) : vec2(u.x - 0.5f * u.y, 0.5f * u.y);
}

/// Mean texture colour over every triangle of a mesh.
std::vector<vec3> textureMeans(const Mesh& mesh, const TextureMean& mean) {
  std::vector<vec3> means(mesh.triangles.size());
  forEachIndex(
      means.size(), [&](std::size_t i) { means[i] = mean.over(cornersOf(mesh, i)); }, kGrain);
  return means;
}

}  // namespace

struct Lights::Constants {
  std::vector<std::vector<vec3>> textureMeans;  // per mesh; empty where emission has no texture
  std::vector<Bounds> bounds;                   // per mesh; empty without infinitely distant lights

  explicit Constants(const Scene& scene) : textureMeans(scene.meshes.size()) {
    std::vector<std::optional<TextureMean>> means(scene.textures.size());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      const Material& material = scene.materials[scene.meshes[m].material];
      if (!material.emits() || material.emissionTexture < 0) continue;
      auto& mean = means[material.emissionTexture];
      if (!mean) mean.emplace(scene.textures[material.emissionTexture]);
      textureMeans[m] = core::textureMeans(scene.meshes[m], *mean);
    }
    const auto directional = [](const PunctualLight& l) { return l.type == PunctualLight::Type::directional; };
    if (!scene.environment && std::none_of(scene.punctual.begin(), scene.punctual.end(), directional)) return;
    bounds = meshBounds(scene);
  }

  /// Squared radius of the sphere around the scene's bounding box.
  float radius2(const Scene& scene, const Pose& pose) const {
    const Bounds all = sceneBounds(scene, bounds, pose.nodeToWorld);
    const vec3 half = 0.5f * (all.high - all.low);
    return dot(half, half);
  }
};

Lights::Lights(const Scene& scene, const Pose& pose, const Lights* before)
    : scene_(&scene), environment_(scene.environment.get()) {
  const bool same = before && before->scene_ == &scene;
  constants_ = same ? before->constants_ : std::make_shared<const Constants>(scene);
  std::vector<float> power;
  listTriangles(pose, power);
  listPunctual(pose, power);
  balanceInfinite(pose, power);
  drawBy(power);
}

void Lights::listTriangles(const Pose& pose, std::vector<float>& power) {
  const Scene& scene = *scene_;
  firstOfInstance_.assign(scene.instances.size(), kNoLight);
  std::size_t count = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Material& material = materialOf(scene, scene.instances[i]);
    if (!material.emits()) continue;
    firstOfInstance_[i] = static_cast<std::uint32_t>(count);
    count += scene.meshes[scene.instances[i].mesh].triangles.size();
    features_.textured |= material.emissionTexture >= 0;
  }
  triangles_.resize(count);
  power.resize(count + scene.punctual.size() + (scene.environment ? 1 : 0));
  forEachIndex(scene.instances.size(), [&](std::size_t i) {
    if (firstOfInstance_[i] != kNoLight) fillTriangles(i, pose, power);
  });
}

void Lights::fillTriangles(std::size_t i, const Pose& pose, std::span<float> power) {
  const Instance& instance = scene_->instances[i];
  const Mesh& mesh = scene_->meshes[instance.mesh];
  const Material& material = scene_->materials[mesh.material];
  const mat4& toWorld = pose.nodeToWorld[instance.node];
  const vec3 radiance = material.emission * pose.materialEmission[mesh.material];
  const std::vector<vec3>& means = constants_->textureMeans[instance.mesh];
  const std::uint32_t flags = (material.doubleSided ? TriangleLight::kDoubleSided : 0) |
                              (means.empty() ? 0 : TriangleLight::kTextured) |
                              (determinant(glm::mat3(toWorld)) < 0 ? TriangleLight::kMirrored : 0);
  const float sides = material.doubleSided ? 2.0f : 1.0f;
  forEachIndex(
      mesh.triangles.size(),
      [&, first = firstOfInstance_[i]](std::size_t t) {
        const auto corner = [&](std::uint32_t v) { return vec3(toWorld * vec4(mesh.positions[v], 1)); };
        const uvec3 v = mesh.triangles[t];
        const vec3 a = corner(v.x), b = corner(v.y), c = corner(v.z);
        TriangleLight& light = triangles_[first + t];
        light = {a, b - a, c - a, radiance, static_cast<std::uint32_t>(instance.mesh), static_cast<std::uint32_t>(t),
                 0, flags};
        const vec3 mean = means.empty() ? radiance : radiance * means[t];
        power[first + t] = sides * 0.5f * length(light.cross2Area()) * luminance(mean);
      },
      kGrain);
}

/// Total intensity over pi, the unit of area times radiance; infinitely distant lights come in balanceInfinite().
void Lights::listPunctual(const Pose& pose, std::vector<float>& power) {
  features_.punctual = !scene_->punctual.empty() || environment_;
  for (std::size_t i = 0; i < scene_->punctual.size(); ++i) {
    const PunctualLight& light = scene_->punctual[i];
    const mat4& toWorld = pose.nodeToWorld[light.node];
    const float inner = std::cos(light.innerAngle), outer = std::cos(light.outerAngle);
    punctual_.push_back({light.type, vec3(toWorld[3]), -normalize(vec3(toWorld[2])), light.intensity, inner, outer});
    const float directions = light.type == PunctualLight::Type::spot ? 2 - inner - outer : 4.0f;
    power[triangles_.size() + i] = directions * luminance(light.intensity);
  }
}

/// What an infinitely distant light sends through a square of side 1, over all directions; negative for other lights.
float Lights::infinitePower(std::uint32_t light) const {
  if (isArea(light)) return -1;
  if (isEnvironment(light)) return static_cast<float>(4 * double{kPi} * environment_->meanLuminance());
  const PunctualState& punctual = punctual_[light - triangles_.size()];
  return punctual.type == PunctualLight::Type::directional ? luminance(punctual.intensity) : -1.0f;
}

void Lights::balanceInfinite(const Pose& pose, std::vector<float>& power) const {
  if (constants_->bounds.empty()) return;
  const float radius2 = constants_->radius2(*scene_, pose);
  double local = 0, infinite = 0;
  for (std::uint32_t i = 0; i < power.size(); ++i) {
    const float through = infinitePower(i);
    if (through >= 0) power[i] = radius2 * through;
    (through >= 0 ? infinite : local) += power[i];
  }
  if (!(local > 0 && infinite > 0)) return;
  const double share = infinite / (local + infinite);
  const double wanted = std::clamp<double>(share, kLeastInfinite, kMostInfinite);
  const auto scale = static_cast<float>(wanted / (1 - wanted) * local / infinite);
  for (std::uint32_t i = triangleCount(); i < power.size(); ++i)
    if (infinitePower(i) >= 0) power[i] *= scale;
}

void Lights::drawBy(const std::vector<float>& power) {
  for (std::size_t i = 0; i < power.size(); ++i)
    if (!(power[i] >= 0 && std::isfinite(power[i])))
      throw Error(scene_->name, "light " + std::to_string(i) + " has no finite power",
                  "check its emission, size and transform");
  table_ = AliasTable(power);
  if (table_.empty()) return;
  forEachIndex(
      triangles_.size(),
      [&](std::size_t i) { triangles_[i].probability = table_.probability(static_cast<std::uint32_t>(i)); }, kGrain);
}

LightSample Lights::sampleAt(std::uint32_t binBits, std::uint32_t keepBits, std::array<std::uint32_t, 2> where,
                             Rng& rng) const {
  if (table_.empty()) return {};
  return pointOn(table_.sample(binBits, keepBits), where, rng);
}

LightSample Lights::pointOn(std::uint32_t light, std::array<std::uint32_t, 2> where, Rng& rng) const {
  if (!isEnvironment(light)) return {light, toBarycentric({unitFloat(where[0]), unitFloat(where[1])})};
  const std::uint32_t keepColumn = rng.bits();
  return {light, environment_->sample(where, {keepColumn, rng.bits()})};
}

Incident Lights::fromOther(const LightSample& s, const vec3& position) const {
  if (!isEnvironment(s.light)) return fromPunctual(punctual_[s.light - triangles_.size()], position);
  return {Environment::directionOf(s.uv), kInfinity, environment_->radiance(s.uv), Environment::solidAngle(s.uv)};
}

Incident Lights::fromPunctual(const PunctualState& light, const vec3& position) const {
  if (light.type == PunctualLight::Type::directional) return {-light.direction, kInfinity, light.intensity, 1};
  const vec3 offset = light.position - position;
  const float distance2 = dot(offset, offset);
  if (!(distance2 > 0)) return {};
  const float distance = std::sqrt(distance2);
  Incident result{offset / distance, distance, light.intensity, 1 / distance2};
  if (light.type == PunctualLight::Type::spot) {
    const float cosine = -dot(result.direction, light.direction);
    const float range = std::max(light.cosInner - light.cosOuter, 1e-3f);
    const float fallOff = std::clamp((cosine - light.cosOuter) / range, 0.0f, 1.0f);
    result.radiance *= fallOff * fallOff;  // KHR_lights_punctual, "Inner and Outer Cone Angles"
  }
  return result;
}

vec3 Lights::emissionTexel(const TriangleLight& light, vec2 b) const {
  const Mesh& mesh = scene_->meshes[light.mesh];
  const Texture& texture = scene_->textures[scene_->materials[mesh.material].emissionTexture];
  const std::array<vec2, 3> uv = cornersOf(mesh, light.triangle);
  return vec3(sampleSrgb(texture, (1 - b.x - b.y) * uv[0] + b.x * uv[1] + b.y * uv[2]));
}

}  // namespace core
