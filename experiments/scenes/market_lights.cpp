#include "experiments/scenes/market_lights.h"

#include "experiments/scenes/patterns.h"
#include "experiments/scenes/shapes.h"

namespace experiments {
namespace {

using core::vec3;
using core::vec4;

float wave(float time, float period) { return std::sin(2 * core::kPi * time / period); }

/// Smooth pulsing between 0.2 and 1.8.
core::Track pulse(float period) {
  return sampled(kMarketSeconds, 10, [=](float time) { return vec4(1 + 0.8f * wave(time, period), 0, 0, 0); });
}

/// On or off for fifths of a second.
core::Track blink(std::uint32_t stream) {
  const auto state = [=](float time) {
    return vec4(hashed(static_cast<std::uint32_t>(5 * time + 0.5f), stream) < 0.6f ? 1 : 0.05f, 0, 0, 0);
  };
  return sampled(kMarketSeconds, 5, state, core::Interpolation::step);
}

/// A candle: random between 0.6 and 1.3, smoothed by interpolation.
core::Track candle(std::uint32_t stream) {
  return sampled(kMarketSeconds, 12, [=](float time) {
    return vec4(0.6f + 0.7f * hashed(static_cast<std::uint32_t>(12 * time + 0.5f), stream), 0, 0, 0);
  });
}

/// A chase: lit for one of every three half seconds.
core::Track chase(int offset) {
  const auto state = [=](float time) {
    return vec4((static_cast<int>(2 * time + 0.5f) + offset) % 3 == 0 ? 1.8f : 0.25f, 0, 0, 0);
  };
  return sampled(kMarketSeconds, 2, state, core::Interpolation::step);
}

int flickering(SceneBuilder& scene, core::Material material, core::Track track) {
  material.flicker = scene.flicker(std::move(track));
  return scene.material(std::move(material));
}

/// Strings sag across the street; their bulbs take turns in colour.
void addBulbs(SceneBuilder& scene) {
  constexpr int kStrings = 6, kBulbs = 12;
  const int materials[] = {scene.material(emitter("warm bulb", {60, 38, 16})),
                           flickering(scene, emitter("red bulb", {50, 5, 3}), chase(0)),
                           scene.material(emitter("amber bulb", {28, 15, 3})),
                           flickering(scene, emitter("green bulb", {6, 36, 8}), chase(1)),
                           scene.material(emitter("pale bulb", {14, 13, 11})),
                           flickering(scene, emitter("blue bulb", {6, 14, 60}), chase(2))};
  int meshes[6];
  for (int i = 0; i < 6; ++i) meshes[i] = scene.mesh("bulb", sphereMesh(0), materials[i]);
  for (int string = 0; string < kStrings; ++string)
    for (int bulb = 0; bulb < kBulbs; ++bulb) {
      const float t = 2 * (static_cast<float>(bulb) + 0.5f) / kBulbs - 1;  // -1 .. 1 across the street
      const vec3 position(kStreetHalf * t, 2.75f + 0.6f * t * t, -1.5f - 3.4f * static_cast<float>(string));
      scene.add("bulb", meshes[(bulb + string) % 6], {position, vec3(0.12f)});
    }
}

/// Paper lanterns under the awnings' fronts; every other one swings.
void addLanterns(SceneBuilder& scene) {
  const int materials[] = {scene.material(emitter("paper lantern", {14, 8.4f, 3.6f})),
                           flickering(scene, emitter("candle lantern", {12, 5.6f, 1.6f}), candle(1)),
                           scene.material(emitter("red lantern", {12, 1.4f, 0.8f})),
                           flickering(scene, emitter("teal lantern", {1, 7, 7.4f}), pulse(2.4f))};
  int meshes[4];
  for (int i = 0; i < 4; ++i) meshes[i] = scene.mesh("lantern", sphereMesh(1), materials[i]);
  for (int i = 0; i < 2 * kStalls; ++i) {
    const float side = i % 2 ? 1 : -1, z = stallZ(i) + 0.5f;
    const int hook = scene.node("hook", {{side * (kStreetHalf - 0.25f), kAwningHeight + 0.1f, z}});
    if (i % 4 < 2)
      scene.nodeAt(hook).rotationTrack =
          swing(kMarketSeconds, 14, 1.6f, hashed(i, 5), normalize(vec3(1, 0, hashed(i, 6))));
    scene.add("lantern", meshes[(i + i / 4) % 4], {{0, -0.45f, 0}, {0.38f, 0.44f, 0.38f}, turn(0), hook});
  }
}

/// A bare strip under every awning lights the goods.
void addStrips(SceneBuilder& scene) {
  const vec3 tints[] = {{22, 19, 14}, {17, 19, 21}, {20, 14, 8}};
  int strips[3];
  for (int i = 0; i < 3; ++i) strips[i] = scene.mesh("strip", quadMesh(), scene.material(emitter("strip", tints[i])));
  for (int i = 0; i < 2 * kStalls; ++i) {
    const vec3 position((i % 2 ? 1 : -1) * (kStreetHalf + 0.9f), kAwningHeight - 0.1f, stallZ(i));
    scene.add("strip", strips[i % 3], {position, {0.12f, 1.1f, 1}, turn(90, {1, 0, 0})});
  }
}

/// One sign: tubes around a dark board.
void addSign(SceneBuilder& scene, int tube, int board, const vec3& centre, float yaw) {
  const int sign = scene.node("sign", {centre, vec3(1), turn(yaw)});
  scene.add("board", board, {{0, 0, -0.06f}, {1.5f, 0.7f, 0.05f}, turn(0), sign});
  for (float side : {-1.0f, 1.0f}) {
    scene.add("tube", tube, {{0, 0.28f * side, 0}, {1.3f, 0.04f, 0.04f}, turn(0), sign});
    scene.add("tube", tube, {{0.63f * side, 0, 0}, {0.04f, 0.5f, 0.04f}, turn(0), sign});
    scene.add("tube", tube, {{0.25f * side, 0, 0}, {0.035f, 0.38f, 0.035f}, turn(30 * side, {0, 0, 1}), sign});
  }
}

void addSigns(SceneBuilder& scene) {
  const int board = scene.mesh("board", boxMesh(), scene.material(matte("board", vec3(0.04f), 0.4f)));
  const int materials[] = {scene.material(emitter("pink neon", {20, 3, 10})),
                           flickering(scene, emitter("cyan neon", {1.5f, 13, 16}), blink(2)),
                           scene.material(emitter("violet neon", {7, 2, 18})),
                           flickering(scene, emitter("yellow neon", {14, 10, 1.5f}), pulse(1.3f))};
  int tubes[4];
  for (int i = 0; i < 4; ++i) tubes[i] = scene.mesh("tube", boxMesh(), materials[i]);
  for (int i = 0; i < 8; ++i) {
    const float side = i % 2 ? -1 : 1, z = -2 - 2.7f * static_cast<float>(i);
    addSign(scene, tubes[i % 4], board, {side * 2.6f, 3.1f + 0.5f * hashed(i, 8), z}, -side * 62);
  }
}

/// Somebody who walks along the street at 1.1 m/s with a lamp.
void addWalker(SceneBuilder& scene, int coat, int lamp, const vec3& start, float direction) {
  const int body = scene.node("walker", {start});
  scene.nodeAt(body).translationTrack = sampled(kMarketSeconds, 10, [=](float time) {
    return vec4(start + vec3(0, 0.03f * std::abs(wave(time, 1.1f)), direction * 1.1f * time), 0);
  });
  scene.add("walker", coat, {vec3(0), vec3(1), turn(0), body});
  scene.add("carried lamp", lamp, {{0.35f, 1.05f, 0.25f * direction}, {0.16f, 0.22f, 0.16f}, turn(0), body});
}

void addWalkers(SceneBuilder& scene) {
  core::Mesh figure;
  append(figure, cylinderMesh(12), {0, 0.75f, 0}, {0.42f, 1.4f, 0.3f});
  append(figure, sphereMesh(2), {0, 1.6f, 0}, {0.22f, 0.27f, 0.24f});
  const int coat = scene.mesh("walker", figure, scene.material(matte("coat", {0.25f, 0.2f, 0.3f})));
  const int warm = flickering(scene, emitter("carried candle", {26, 14, 4}), candle(9));
  const int white = scene.material(emitter("carried lamp", {16, 17, 20}));
  addWalker(scene, coat, scene.mesh("carried candle", sphereMesh(1), warm), {-0.9f, 0, -12}, 1);
  addWalker(scene, coat, scene.mesh("carried lamp", sphereMesh(1), white), {1.1f, 0, -4.5f}, -1);
}

void addPunctual(SceneBuilder& scene) {
  core::PunctualLight spot;
  spot.type = core::PunctualLight::Type::spot;
  spot.intensity = {14, 11, 7};
  spot.innerAngle = 0.2f;
  spot.outerAngle = 0.5f;
  const vec3 pole(-1.8f, 4.5f, -8);
  scene.light(spot, scene.node("street lamp", {pole, vec3(1), lookAt(pole, {0.3f, 0, -8.5f})}));
  core::PunctualLight moon;
  moon.type = core::PunctualLight::Type::directional;
  moon.intensity = {0.22f, 0.28f, 0.4f};
  scene.light(moon, scene.node("moon", {{0, 20, 0}, vec3(1), lookAt({6, 20, 9}, {0, 0, 0})}));
}

}  // namespace

void addMarketLights(SceneBuilder& scene) {
  addBulbs(scene);
  addLanterns(scene);
  addStrips(scene);
  addSigns(scene);
  addWalkers(scene);
  addPunctual(scene);
}

}  // namespace experiments
