// Making a Bsdf and sampling it; its hot half is in the header.
#include "core/material.h"

namespace core {
namespace {

/// Viewers closer to the horizon than this are lifted to it, so that no half vector has length 0.
constexpr float kLeastViewerCosine = 1e-5f;

/// Share of samples for the specular lobe: its reflectance over both. A black surface samples it alone.
float specularShare(const vec3& specular, const vec3& diffuse) {
  const float s = luminance(specular), d = luminance(diffuse);
  return d > 0 ? s / (s + d) : 1.0f;
}

vec3 cosineDirection(vec2 u) {
  const float radius = std::sqrt(u.x), angle = 2 * kPi * u.y;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - u.x)};
}

}  // namespace

Bsdf::Bsdf(const Surface& surface, const vec3& toViewer)
    : frame_(surface.normal),
      geometricNormal_(surface.geometricNormal),
      viewer_(frame_.toLocal(toViewer)),
      diffuse_((1 - surface.metallic) / kPi * surface.baseColor),
      f0_(lerp(vec3(0.04f), surface.baseColor, surface.metallic)) {
  const float roughness = std::max(surface.roughness, kLeastRoughness);
  alpha_ = roughness * roughness;
  alpha2_ = alpha_ * alpha_;
  const bool visible = surface.hit() && viewer_.z > 0 && dot(geometricNormal_, toViewer) > 0;
  viewer_.z = visible ? std::max(viewer_.z, kLeastViewerCosine) : 0.0f;
  viewerRoot_ = smithRoot(alpha2_, viewer_.z);
  const vec3 f = fresnel(viewer_.z);
  specularProbability_ = specularShare(f, (vec3(1) - f) * diffuse_ * kPi);
}

/// Half vector in the shading frame, with density D(h) G1(v) max(v.h, 0) / n.v.
vec3 Bsdf::sampleVisibleNormal(vec2 u) const {
  const vec3 stretched = normalize(vec3(alpha_ * viewer_.x, alpha_ * viewer_.y, viewer_.z));
  const float angle = 2 * kPi * u.x, depth = u.y * (1 + stretched.z);  // of a point on the cap, below its pole
  const float radius = std::sqrt(std::max(depth * (2 - depth), 0.0f));
  const vec3 h = vec3(radius * std::cos(angle), radius * std::sin(angle), 1 - depth) + stretched;
  return normalize(vec3(alpha_ * h.x, alpha_ * h.y, std::max(h.z, 0.0f)));
}

BsdfSample Bsdf::sample(const vec3& u) const {
  if (!(viewer_.z > 0)) return {};
  vec3 local;
  if (u.z < specularProbability_) {
    const vec3 h = sampleVisibleNormal({u.x, u.y});
    local = normalize(2 * dot(viewer_, h) * h - viewer_);
  } else {
    local = cosineDirection({u.x, u.y});
  }
  const vec3 direction = frame_.toWorld(local);
  return {direction, pdf(direction)};
}

}  // namespace core
