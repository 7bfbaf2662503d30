// Everything that shines at one instant: emissive triangles, punctual lights and the environment, drawn by power.
//
// Measure: a triangle's points have measure 1 in all (area / the triangle's area), a punctual light is one point of
// measure 1, the environment's points are those of its map, [0, 1)^2. A density is then the probability of the light
// alone (for the environment, times that of its map), and a LightSample means the same point with the same density at
// every instant, though its light moves or grows: reuse from frame to frame needs no Jacobian.
// Sources: Heitz, "A Low-Distortion Map Between Triangle and Square" (2019); glTF extension KHR_lights_punctual.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/alias_table.h"
#include "core/environment.h"
#include "core/random.h"
#include "core/scene.h"

namespace core {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

/// A point on a light. uv: barycentric weights of a triangle's second and third vertex; the environment's point; unused
/// by punctual lights.
struct LightSample {
  std::uint32_t light = kNoLight;
  vec2 uv{0};
  bool valid() const { return light != kNoLight; }
};

/// An emissive triangle at an instant: one cache line.
struct TriangleLight {
  vec3 origin{0}, edge1{0}, edge2{0};  ///< world space
  vec3 radiance{0};                    ///< emission factor times flicker; a texture multiplies it
  std::uint32_t mesh = 0, triangle = 0;
  float probability = 0;  ///< of this light among all
  std::uint32_t flags = 0;
  static constexpr std::uint32_t kDoubleSided = 1, kTextured = 2, kMirrored = 4;  ///< mirrored: front is clockwise

  vec3 point(vec2 b) const { return origin + b.x * edge1 + b.y * edge2; }
  vec3 cross2Area() const { return cross(edge1, edge2); }
};
static_assert(sizeof(TriangleLight) == 64);

/// A punctual light at an instant, world space.
struct PunctualState {
  PunctualLight::Type type = PunctualLight::Type::point;
  vec3 position{0}, direction{0, 0, -1};  ///< direction: unit, along which it shines
  vec3 intensity{0};
  float cosInner = 1, cosOuter = 0;
};

/// Light arriving at a point from a LightSample.
struct Incident {
  vec3 direction{0};   ///< unit, towards the light
  float distance = 0;  ///< infinity for directional lights and the environment
  vec3 radiance{0};    ///< L_e (triangles, environment), intensity with cone (point, spot), irradiance (directional)
  /// area cos_light / d^2 (triangles), 1 / d^2 (point, spot), 1 (directional), d omega / d(u, v) (environment)
  float geometry = 0;
  /// radiance * geometry; times f cos it is the integrand in the measure of this file.
  vec3 flux() const { return geometry * radiance; }
};

/// A light sample beside all that its light must tell to shine on a point: one cache line. Of triangles; other lights
/// are few, and are asked themselves.
struct PresampledLight {
  vec3 point{0}, cross2Area{0};  ///< of the triangle, world space
  vec3 radiance{0};              ///< texture included
  LightSample sample;
  float pdf = 0;            ///< Lights::pdf() of the sample
  std::uint32_t flags = 0;  ///< as TriangleLight's
};
static_assert(sizeof(PresampledLight) <= 64);

/// Which kinds of light and texture a scene has; kernels are compiled for each set so that what is absent costs
/// nothing. punctual: any light that is no triangle, the environment too.
struct LightFeatures {
  bool punctual = true, textured = true;
};

/// Calls body.template operator()<F>() with F the compile-time copy of features.
template <class Body>
void withFeatures(LightFeatures features, Body&& body) {
  if (features.punctual && features.textured) return body.template operator()<LightFeatures{true, true}>();
  if (features.punctual) return body.template operator()<LightFeatures{true, false}>();
  if (features.textured) return body.template operator()<LightFeatures{false, true}>();
  body.template operator()<LightFeatures{false, false}>();
}

/// All lights of a scene at an instant. Light i < triangleCount() is a triangle, then come the punctual ones, and the
/// environment is the last. The same index is the same light at every instant: lights of no power stay in the list and
/// are never drawn.
///
/// Power, up to a common factor: area x mean emission over the triangle (texture and flicker included) x 2 if double
/// sided; total intensity of point and spot lights; irradiance x squared radius of the scene for directional lights and
/// the environment (its radiance integrated over all directions), whose joint share is kept between 1/9 and 1/2 where
/// there are others.
class Lights {
 public:
  Lights() = default;
  /// scene must outlive this. before: lights of the same scene at another instant, whose constants are shared; or null.
  /// Throws Error where a light's power is not finite.
  Lights(const Scene& scene, const Pose& pose, const Lights* before = nullptr);

  std::uint32_t size() const { return environmentLight() + (environment_ ? 1 : 0); }
  std::uint32_t triangleCount() const { return static_cast<std::uint32_t>(triangles_.size()); }
  /// True if no light has power.
  bool empty() const { return table_.empty(); }
  LightFeatures features() const { return features_; }

  /// Draws a light by power and a uniform point on it; invalid only if empty().
  LightSample sample(Rng& rng) const {
    const std::uint32_t binBits = rng.bits(), keepBits = rng.bits(), x = rng.bits();
    return sampleAt(binBits, keepBits, {x, rng.bits()}, rng);
  }
  /// The same from numbers that the caller made: 32 uniform bits each for the light, and where on it. rng: asked for
  /// more where the environment was drawn.
  LightSample sampleAt(std::uint32_t binBits, std::uint32_t keepBits, std::array<std::uint32_t, 2> where,
                       Rng& rng) const;
  /// Probability of drawing this light.
  float probability(std::uint32_t light) const {
    return isArea(light) ? triangles_[light].probability : table_.empty() ? 0.0f : table_.probability(light);
  }
  /// Density with which sample() gives this point, in the measure of this file.
  float pdf(const LightSample& y) const { return probability(y.light) * pdfWithin(y); }
  /// The same, its light given: 1 but for the environment.
  float pdfWithin(const LightSample& y) const { return isEnvironment(y.light) ? environment_->pdf(y.uv) : 1.0f; }
  bool isArea(std::uint32_t light) const { return light < triangles_.size(); }
  bool isEnvironment(std::uint32_t light) const { return environment_ && light == environmentLight(); }
  /// True for lights that a ray can find: triangles, and the environment.
  bool isHittable(std::uint32_t light) const { return isArea(light) || isEnvironment(light); }
  bool anyHittable() const { return !triangles_.empty() || environment_; }
  /// The environment where a ray in this direction (any length above 0) meets it; invalid if there is none.
  LightSample environmentAt(const vec3& direction) const {
    return environment_ ? LightSample{environmentLight(), Environment::uvOf(direction)} : LightSample{};
  }
  const TriangleLight& triangle(std::uint32_t light) const { return triangles_[light]; }
  /// Light `light` is punctual.
  const PunctualState& punctual(std::uint32_t light) const { return punctual_[light - triangles_.size()]; }
  /// True for lights that have a direction but no place.
  bool isInfinite(std::uint32_t light) const {
    return isEnvironment(light) || (!isArea(light) && punctual(light).type == PunctualLight::Type::directional);
  }
  /// A point of a light, drawn with density pdfWithin(). where: 32 uniform bits each; rng: as for sampleAt().
  LightSample pointOn(std::uint32_t light, std::array<std::uint32_t, 2> where, Rng& rng) const;

  /// Light arriving at position from s, ignoring occlusion; radiance 0 where s cannot shine there. F: what the scene
  /// has.
  template <LightFeatures F>
  Incident incident(const LightSample& s, const vec3& position) const;
  /// The same, bit for bit, from what presample() packed: incident(presample(s), p) = incident(s, p).
  template <LightFeatures F>
  Incident incident(const PresampledLight& s, const vec3& position) const;
  /// s: valid.
  template <LightFeatures F>
  PresampledLight presample(const LightSample& s) const;

  /// Light index of triangle `primitive` of instance `instance`, kNoLight if it does not emit.
  std::uint32_t lightOf(std::uint32_t instance, std::uint32_t primitive) const {
    const std::uint32_t first = firstOfInstance_[instance];
    return first == kNoLight ? kNoLight : first + primitive;
  }

 private:
  struct Constants;  // what no animation changes

  void listTriangles(const Pose& pose, std::vector<float>& power);
  void fillTriangles(std::size_t instance, const Pose& pose, std::span<float> power);
  void listPunctual(const Pose& pose, std::vector<float>& power);
  void balanceInfinite(const Pose& pose, std::vector<float>& power) const;
  float infinitePower(std::uint32_t light) const;
  void drawBy(const std::vector<float>& power);
  static Incident fromTriangle(const vec3& point, const vec3& cross2Area, const vec3& radiance, std::uint32_t flags,
                               const vec3& position);
  Incident fromOther(const LightSample& s, const vec3& position) const;
  Incident fromPunctual(const PunctualState& light, const vec3& position) const;
  vec3 emissionTexel(const TriangleLight& light, vec2 b) const;

  std::uint32_t environmentLight() const { return static_cast<std::uint32_t>(triangles_.size() + punctual_.size()); }

  const Scene* scene_ = nullptr;
  const Environment* environment_ = nullptr;  // the scene's
  std::shared_ptr<const Constants> constants_;
  std::vector<TriangleLight> triangles_;
  std::vector<PunctualState> punctual_;
  std::vector<std::uint32_t> firstOfInstance_;
  AliasTable table_;
  LightFeatures features_{false, false};
};

inline Incident Lights::fromTriangle(const vec3& point, const vec3& cross2Area, const vec3& radiance,
                                     std::uint32_t flags, const vec3& position) {
  const vec3 offset = point - position;
  const float distance2 = dot(offset, offset);
  float facing = -0.5f * dot(cross2Area, offset);  // area cos_light d
  if (flags & TriangleLight::kMirrored) facing = -facing;
  if (flags & TriangleLight::kDoubleSided) facing = std::abs(facing);
  if (!(facing > 0 && distance2 > 0)) return {};
  const float distance = std::sqrt(distance2);
  return {offset / distance, distance, radiance, facing / (distance * distance2)};
}

template <LightFeatures F>
Incident Lights::incident(const LightSample& s, const vec3& position) const {
  if constexpr (F.punctual)
    if (!isArea(s.light)) return fromOther(s, position);
  const TriangleLight& light = triangles_[s.light];
  Incident result = fromTriangle(light.point(s.uv), light.cross2Area(), light.radiance, light.flags, position);
  if constexpr (F.textured)
    if (light.flags & TriangleLight::kTextured && result.geometry > 0) result.radiance *= emissionTexel(light, s.uv);
  return result;
}

template <LightFeatures F>
Incident Lights::incident(const PresampledLight& s, const vec3& position) const {
  if constexpr (F.punctual)
    if (!isArea(s.sample.light)) return incident<F>(s.sample, position);
  return fromTriangle(s.point, s.cross2Area, s.radiance, s.flags, position);
}

template <LightFeatures F>
PresampledLight Lights::presample(const LightSample& s) const {
  if (!isArea(s.light)) return {.sample = s, .pdf = pdf(s)};
  const TriangleLight& light = triangles_[s.light];
  PresampledLight p{light.point(s.uv), light.cross2Area(), light.radiance, s, light.probability, light.flags};
  if constexpr (F.textured)
    if (light.flags & TriangleLight::kTextured) p.radiance *= emissionTexel(light, s.uv);
  return p;
}

}  // namespace core
