// glTF metallic-roughness reflection: Lambert and GGX with visible-normal sampling, for one surface and viewer.
//
// With F0 = lerp(0.04, base colour, metallic), alpha = roughness^2 and F(c) = F0 + (1 - F0)(1 - c)^5:
//   [bsdf 1]  f = D(h) V(l, v) F(v.h)  +  (1 - F(min(n.l, n.v))) (1 - metallic) base colour / pi
//   [bsdf 2]  D = 1 / (pi alpha^2 ((hx^2 + hy^2) / alpha^2 + hz^2)^2)
//   [bsdf 3]  V = 1 / (2 (n.l S(n.v) + n.v S(n.l))),  S(c) = sqrt(alpha^2 + (1 - alpha^2) c^2), height-correlated Smith
// glTF's example code dims the diffuse lobe by F(v.h), which returns up to 1.9 times the light at grazing angles; the
// angle above keeps the sum below 1 and is as reciprocal. [bsdf 2] has no cancelling 1 - (n.h)^2, so it is accurate in
// float down to the least roughness. Below kLeastRoughness a surface is taken as that rough.
//
// Sources: glTF 2.0 specification, appendix B; Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based
// BRDFs" (JCGT 2014); Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps" (HPG 2023).
#pragma once

#include "core/surface.h"

namespace core {

inline constexpr float kLeastRoughness = 0.03f;

struct BsdfSample {
  vec3 direction{0};  ///< unit, world space, away from the surface
  float pdf = 0;      ///< solid angle; 0 = no sample
};

struct BsdfValue {
  vec3 f{0};      ///< f(direction, viewer) |cos theta|, RGB, 1/sr
  float pdf = 0;  ///< density with which sample() returns the direction, 1/sr
};

/// Reflection at one surface towards one viewer. Cheap to make (once per pixel), no virtual calls.
/// A viewer below the geometric or shading horizon, or a surface that was not hit, reflects nothing.
class Bsdf {
 public:
  /// toViewer: unit vector from the surface to the viewer.
  Bsdf(const Surface& surface, const vec3& toViewer);
  /// Both 0 below the geometric or shading horizon. direction: unit.
  BsdfValue value(const vec3& direction) const;
  vec3 evaluate(const vec3& direction) const { return value(direction).f; }
  float pdf(const vec3& direction) const { return value(direction).pdf; }
  /// u: three uniform numbers in [0, 1); u.z chooses the lobe.
  BsdfSample sample(const vec3& u) const;

 private:
  static float smithRoot(float alpha2, float cosine) { return std::sqrt(alpha2 + (1 - alpha2) * cosine * cosine); }
  vec3 fresnel(float cosine) const {
    const float a = std::max(1 - cosine, 0.0f), a2 = a * a;
    return f0_ + (vec3(1) - f0_) * (a2 * a2 * a);
  }
  float normalDistribution(const vec3& h) const {
    const float t = (h.x * h.x + h.y * h.y) / alpha2_ + h.z * h.z;
    return 1 / (kPi * alpha2_ * t * t);  // [bsdf 2]
  }
  vec3 sampleVisibleNormal(vec2 u) const;

  Frame frame_;
  vec3 geometricNormal_, viewer_;  // viewer_ in the shading frame; z = 0 reflects nothing
  vec3 diffuse_, f0_;              // diffuse_ = (1 - metallic) base colour / pi
  float alpha_, alpha2_, viewerRoot_;
  float specularProbability_;
};

inline BsdfValue Bsdf::value(const vec3& direction) const {
  const vec3 l = frame_.toLocal(direction), &v = viewer_;
  if (!(l.z > 0 && v.z > 0 && dot(geometricNormal_, direction) > 0)) return {};
  const vec3 h = normalize(l + v);
  const float d = normalDistribution(h);
  const float visibility = 0.5f / (l.z * viewerRoot_ + v.z * smithRoot(alpha2_, l.z));  // [bsdf 3]
  const vec3 specular = d * visibility * fresnel(dot(v, h));
  const vec3 diffuse = (vec3(1) - fresnel(std::min(l.z, v.z))) * diffuse_;
  const float visiblePdf = 0.5f * d / (v.z + viewerRoot_);  // Dupuy and Benyoub: D(h) G1(v) / (4 n.v)
  return {l.z * (specular + diffuse),                       // [bsdf 1]
          lerp(l.z * (1 / kPi), visiblePdf, specularProbability_)};
}

}  // namespace core
