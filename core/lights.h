// Everything that shines at one instant: emissive triangles and punctual lights, drawn by power.
#pragma once

#include <cstdint>
#include <vector>

#include "core/alias_table.h"
#include "core/random.h"
#include "core/scene.h"

namespace core {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

/// A point on a light. uv are uniform numbers that a triangle maps to barycentric coordinates; unused by punctual
/// lights.
struct LightSample {
  std::uint32_t light = kNoLight;
  vec2 uv{0};
  bool valid() const { return light != kNoLight; }
};

/// An emissive triangle at an instant: one cache line.
struct TriangleLight {
  vec3 origin{0}, edge1{0}, edge2{0};
  vec3 radiance{0};                      ///< emission factor times flicker; a texture multiplies it
  std::uint32_t mesh = 0, triangle = 0;  ///< for texture coordinates
  float area = 0;
  std::uint32_t flags = 0;  ///< kDoubleSided, kTextured
  static constexpr std::uint32_t kDoubleSided = 1, kTextured = 2;
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
  float distance = 0;  ///< infinity for directional lights
  vec3 radiance{0};    ///< L_e (triangles), intensity with cone (point, spot), irradiance (directional)
  float geometry = 0;  ///< cos_light / d^2 (triangles), 1 / d^2 (point, spot), 1 (directional)
  /// radiance * geometry; times f cos it is the integrand in the light's own measure (area or counting).
  vec3 flux() const { return geometry * radiance; }
};

/// Which kinds of light and texture a scene has; kernels are compiled for each set so that what is absent costs
/// nothing.
struct LightFeatures {
  bool punctual = true, textured = true;
};

/// All lights of a scene at an instant. Light i < triangles().size() is a triangle, the rest are punctual.
class Lights {
 public:
  Lights() = default;
  Lights(const Scene& scene, const Pose& pose);

  std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size() + punctual_.size()); }
  std::uint32_t triangleCount() const { return static_cast<std::uint32_t>(triangles_.size()); }
  bool empty() const { return table_.empty(); }
  LightFeatures features() const { return features_; }

  /// Draws a light by power and a uniform point on it; invalid only if there is no light.
  LightSample sample(Rng& rng) const;
  /// Density with which sample() gives this point: per area for triangles, a probability for punctual lights.
  float pdf(const LightSample& s) const;
  /// True for lights that a ray can hit.
  bool isArea(std::uint32_t light) const { return light < triangles_.size(); }

  /// Light arriving at position from s, ignoring occlusion. F: what the scene has (compile-time).
  template <LightFeatures F>
  Incident incident(const LightSample& s, const vec3& position) const;

  /// Position of an area sample in world space.
  vec3 pointOn(const LightSample& s) const;
  /// Light index of triangle `primitive` of instance `instance`, kNoLight if it does not emit.
  std::uint32_t lightOf(std::uint32_t instance, std::uint32_t primitive) const {
    const std::uint32_t first = firstOfInstance_[instance];
    return first == kNoLight ? kNoLight : first + primitive;
  }
  /// The LightSample of a ray hit with barycentric coordinates (b1, b2).
  static LightSample sampleFromBarycentric(std::uint32_t light, vec2 b);

 private:
  const Scene* scene_ = nullptr;
  std::vector<TriangleLight> triangles_;
  std::vector<PunctualState> punctual_;
  std::vector<std::uint32_t> firstOfInstance_;
  AliasTable table_;
  LightFeatures features_;
};

}  // namespace core
