#include "core/camera.h"

namespace core {

Projection::Projection(const Camera& camera, int width, int height) : camera_(camera), size_(width, height) {
  const float pixel = 2 * camera.tanHalfFovY / static_cast<float>(height);
  stepX_ = pixel * camera.right;
  stepY_ = -pixel * camera.up;
  corner_ = camera.forward - 0.5f * size_.x * stepX_ - 0.5f * size_.y * stepY_;
}

vec2 Projection::project(const vec3& world) const {
  const vec3 offset = world - camera_.position;
  const float scale = 0.5f * size_.y / (camera_.tanHalfFovY * dot(offset, camera_.forward));
  return 0.5f * size_ + scale * vec2(dot(offset, camera_.right), -dot(offset, camera_.up));
}

Camera cameraFromMatrix(const mat4& toWorld, float yfov) {
  Camera camera;
  camera.position = vec3(toWorld[3]);
  camera.forward = -normalize(vec3(toWorld[2]));
  camera.right = normalize(cross(camera.forward, vec3(toWorld[1])));
  camera.up = cross(camera.right, camera.forward);
  camera.tanHalfFovY = std::tan(0.5f * yfov);
  return camera;
}

}  // namespace core
