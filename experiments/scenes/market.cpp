// A night market: two rows of stalls along a wet street, seen by a camera that moves down the middle.
#include "experiments/scenes/builtin.h"
#include "experiments/scenes/market_lights.h"
#include "experiments/scenes/patterns.h"
#include "experiments/scenes/shapes.h"

namespace experiments {
namespace {

using core::vec2;
using core::vec3;
using core::vec4;

constexpr float kStreetLength = 34, kStreetMiddle = -12;  // metres, along z

void addStreet(SceneBuilder& scene) {
  core::Material wet = matte("wet paving", vec3(0.8f));
  wet.baseColorTexture = scene.texture(pavingTexture());
  wet.metallicRoughnessTexture = scene.texture(wetnessTexture());
  const int street = scene.mesh("street", quadMesh({12, 34}), scene.material(wet));
  core::Material brick = matte("brick", vec3(1), 0.9f);
  brick.baseColorTexture = scene.texture(brickTexture());
  const int wall = scene.mesh("house wall", quadMesh({24, 5}), scene.material(brick));
  scene.add("street", street, {{0, 0, kStreetMiddle}, {12, kStreetLength, 1}, turn(-90, {1, 0, 0})});
  for (float side : {-1.0f, 1.0f})
    scene.add("houses", wall, {{side * 4.8f, 3, kStreetMiddle}, {kStreetLength, 6, 1}, turn(-90 * side)});
  scene.add("end of the street", wall, {{0, 3, kStreetMiddle - kStreetLength / 2}, {kStreetLength, 6, 1}});
}

/// Meshes that all stalls share.
struct StallParts {
  int wood = 0, cloth[3] = {}, crate = 0, goods[4] = {};
};

/// Twelve fruits on a tray of one by one metre.
core::Mesh pile() {
  core::Mesh mesh;
  for (std::uint32_t i = 0; i < 12; ++i) {
    const float x = (static_cast<float>(i % 4) + 0.5f) / 4 - 0.5f, z = (static_cast<float>(i / 4) + 0.5f) / 3 - 0.5f;
    append(mesh, sphereMesh(1), {x, 0.1f + 0.06f * hashed(i, 20), z}, vec3(0.22f + 0.06f * hashed(i, 21)));
  }
  return mesh;
}

StallParts makeParts(SceneBuilder& scene) {
  StallParts parts;
  core::Material planks = matte("planks", vec3(1), 0.7f);
  planks.baseColorTexture = scene.texture(plankTexture());
  parts.wood = scene.mesh("plank box", boxMesh(), scene.material(planks));
  parts.crate = scene.mesh("crate", boxMesh(), scene.material(matte("crate", {0.4f, 0.28f, 0.16f}, 0.8f)));
  const vec3 cloths[] = {{0.7f, 0.1f, 0.08f}, {0.1f, 0.3f, 0.55f}, {0.15f, 0.45f, 0.2f}};
  for (int i = 0; i < 3; ++i) {
    core::Material cloth = matte("awning", vec3(1), 0.95f);
    cloth.baseColorTexture = scene.texture(stripeTexture(cloths[i], vec3(0.75f, 0.72f, 0.65f)));
    parts.cloth[i] = scene.mesh("awning", boxMesh({6, 1}), scene.material(cloth));
  }
  const vec3 fruits[] = {{0.75f, 0.3f, 0.05f}, {0.6f, 0.06f, 0.05f}, {0.35f, 0.55f, 0.1f}, {0.7f, 0.6f, 0.12f}};
  for (int i = 0; i < 4; ++i)
    parts.goods[i] = scene.mesh("fruit", pile(), scene.material(matte("fruit", fruits[i], 0.35f)));
  return parts;
}

/// A stall of 2.4 x 1.3 metres whose local +z faces the street.
void addStall(SceneBuilder& scene, const StallParts& parts, int index, const core::Node& at) {
  const int stall = scene.node("stall", {at.translation, vec3(1), at.rotation});
  const auto place = [&](const vec3& position, const vec3& size, float tilt = 0) {
    return Place{position, size, turn(tilt, {1, 0, 0}), stall};
  };
  scene.add("table", parts.wood, place({0, 0.42f, 0.2f}, {2.3f, 0.84f, 0.7f}));
  scene.add("shelf", parts.wood, place({0, 1.0f, -0.75f}, {2.3f, 2.0f, 0.08f}));
  for (float x : {-1.15f, 1.15f}) scene.add("post", parts.wood, place({x, 1.15f, 0.5f}, {0.07f, 2.3f, 0.07f}));
  scene.add("awning", parts.cloth[index % 3], place({0, kAwningHeight + 0.12f, -0.1f}, {2.6f, 0.03f, 1.6f}, 14));
  scene.add("valance", parts.cloth[index % 3], place({0, kAwningHeight - 0.2f, 0.67f}, {2.6f, 0.26f, 0.02f}));
  for (int i = 0; i < 3; ++i) {
    const float x = 0.76f * static_cast<float>(i - 1);
    scene.add("fruit", parts.goods[(index + i) % 4], place({x, 0.84f, 0.2f}, {0.66f, 0.9f, 0.6f}));
  }
  for (int i = 0; i < 2; ++i) {
    const float x = 1.4f * hashed(10 * index + i, 30) - 0.7f, size = 0.34f + 0.12f * hashed(10 * index + i, 31);
    scene.add("crate", parts.crate, place({x, size / 2, 0.85f}, vec3(size)));
  }
}

void addStalls(SceneBuilder& scene) {
  const StallParts parts = makeParts(scene);
  for (int i = 0; i < 2 * kStalls; ++i) {
    const float side = i % 2 ? 1 : -1;
    core::Node at;
    at.translation = {side * (kStreetHalf + 0.9f), 0, stallZ(i)};
    at.rotation = turn(-90 * side);
    addStall(scene, parts, i, at);
  }
}

/// A cart that rolls down the street at 0.6 m/s, its wheels turning.
void addCart(SceneBuilder& scene) {
  constexpr float kSpeed = 0.6f, kRadius = 0.3f;
  const int paint = scene.material(matte("cart", {0.55f, 0.12f, 0.1f}, 0.3f));
  const int body = scene.mesh("cart", boxMesh(), paint);
  const int wheel = scene.mesh("wheel", cylinderMesh(20), scene.material(matte("rubber", vec3(0.08f), 0.8f)));
  const vec3 start(0.2f, 0, -5), end = start + vec3(0, 0, -kSpeed * kMarketSeconds);
  const int cart = scene.node("cart", {start});
  scene.nodeAt(cart).translationTrack = glide(kMarketSeconds, start, end);
  scene.add("cart box", body, {{0, 0.62f, 0}, {0.8f, 0.5f, 1.2f}, turn(0), cart});
  scene.add("cart handle", body, {{0, 0.8f, 0.9f}, {0.6f, 0.05f, 0.7f}, turn(0), cart});
  for (float side : {-1.0f, 1.0f}) {
    const int hub = scene.node("hub", {{0.47f * side, kRadius, 0}, vec3(1), turn(0), cart});
    scene.nodeAt(hub).rotationTrack = sampled(kMarketSeconds, 4, [](float time) {
      const float angle = -kSpeed * time / kRadius;
      return vec4(std::sin(angle / 2), 0, 0, std::cos(angle / 2));
    });
    scene.add("wheel", wheel, {vec3(0), {2 * kRadius, 0.08f, 2 * kRadius}, turn(90, {0, 0, 1}), hub});
  }
}

/// Moves down the street at 0.8 m/s and looks a little to both sides.
void addCamera(SceneBuilder& scene) {
  const vec3 start(-0.3f, 1.6f, 3);
  const int camera = scene.node("camera", {start});
  scene.nodeAt(camera).translationTrack = glide(kMarketSeconds, start, start + vec3(0.4f, 0, -0.8f * kMarketSeconds));
  scene.nodeAt(camera).rotationTrack = swing(kMarketSeconds, 5, 6, 0.1f, {0, 1, 0});
  scene.camera(camera, 50);
}

}  // namespace

core::Scene marketScene() {
  SceneBuilder scene("market");
  addStreet(scene);
  addStalls(scene);
  addCart(scene);
  addMarketLights(scene);
  addCamera(scene);
  return scene.take();
}

}  // namespace experiments
