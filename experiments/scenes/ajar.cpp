// A room that is lit through the slit of a door: nearly all light points are hidden from nearly all surfaces.
// After the idea of Veach's scene "ajar" (Robust Monte Carlo Methods for Light Transport Simulation, 1997), for direct
// light alone: a bright window of the next room is seen through the slit.
#include "experiments/scenes/builder.h"
#include "experiments/scenes/builtin.h"
#include "experiments/scenes/patterns.h"
#include "experiments/scenes/shapes.h"

namespace experiments {
namespace {

using core::vec2;
using core::vec3;

constexpr float kWidth = 5, kHeight = 2.6f, kDepth = 6;  // of the room; its floor is centred at the origin
constexpr float kDoorWidth = 0.9f, kDoorHeight = 2.0f;   // in the wall z = -kDepth / 2, centred at x = 0
constexpr float kDoorZ = -kDepth / 2, kWallThickness = 0.12f;
constexpr float kSeconds = 12, kAjar = 32, kSwing = 5, kPeriod = 6;  // degrees, seconds

void addRoom(SceneBuilder& scene) {
  core::Material planks = matte("planks", vec3(1), 0.6f);
  planks.baseColorTexture = scene.texture(plankTexture());
  const int floor = scene.mesh("floor", quadMesh({5, 12}), scene.material(planks));
  const int plaster = scene.material(matte("plaster", {0.7f, 0.66f, 0.58f}));
  const int wall = scene.mesh("wall", quadMesh(), plaster), block = scene.mesh("block", boxMesh(), plaster);
  const vec3 x(1, 0, 0);
  const float half = kWidth / 2, middle = kHeight / 2, pier = half - kDoorWidth / 2;
  scene.add("floor", floor, {{0, 0, -2}, {7, kDepth + 6, 1}, turn(-90, x)});
  scene.add("ceiling", wall, {{0, kHeight, -2}, {7, kDepth + 6, 1}, turn(90, x)});
  scene.add("left wall", wall, {{-half, middle, 0}, {kDepth, kHeight, 1}, turn(90)});
  scene.add("right wall", wall, {{half, middle, 0}, {kDepth, kHeight, 1}, turn(-90)});
  scene.add("front wall", wall, {{0, middle, kDepth / 2}, {kWidth, kHeight, 1}, turn(180)});
  scene.add("left pier", block, {{-half + pier / 2, middle, kDoorZ}, {pier, kHeight, kWallThickness}});
  scene.add("right pier", block, {{half - pier / 2, middle, kDoorZ}, {pier, kHeight, kWallThickness}});
  scene.add("lintel", block,
            {{0, (kHeight + kDoorHeight) / 2, kDoorZ}, {kDoorWidth, kHeight - kDoorHeight, kWallThickness}});
  scene.add("next room", wall, {{0, middle, -7.5f}, {7, kHeight, 1}});
}

/// Hinged at its left edge; opens into the next room.
void addDoor(SceneBuilder& scene) {
  core::Material painted = matte("painted door", {0.3f, 0.42f, 0.4f}, 0.4f);
  const int panel = scene.mesh("door panel", boxMesh(), scene.material(painted));
  core::Material brass = matte("brass", {0.9f, 0.65f, 0.25f}, 0.3f);
  brass.metallic = 1;
  const int knob = scene.mesh("knob", sphereMesh(2), scene.material(brass));
  const int hinge = scene.node("hinge", {{-kDoorWidth / 2, 0, kDoorZ}, vec3(1), turn(kAjar)});
  scene.nodeAt(hinge).rotationTrack = sampled(kSeconds, 10, [](float time) {
    const float angle = glm::radians(kAjar + kSwing * std::sin(2 * core::kPi * time / kPeriod));
    return core::vec4(0, std::sin(angle / 2), 0, std::cos(angle / 2));
  });
  scene.add("door", panel,
            {{kDoorWidth / 2, kDoorHeight / 2, 0}, {kDoorWidth, kDoorHeight - 0.01f, 0.04f}, turn(0), hinge});
  scene.add("knob", knob, {{kDoorWidth - 0.08f, 1, 0.06f}, vec3(0.07f), turn(0), hinge});
}

/// Panes of the next room's window, of different tints, turned towards the slit.
void addWindow(SceneBuilder& scene) {
  const vec3 tints[] = {{1, 0.9f, 0.72f}, {1, 0.82f, 0.6f}, {0.85f, 0.9f, 1}};
  const int window = scene.node("window", {{1.6f, 1.3f, -4.8f}, vec3(1), turn(-30)});
  for (int row = 0; row < 3; ++row) {
    const int pane = scene.mesh("pane", quadMesh(), scene.material(emitter("pane", 325.0f * tints[row])));
    for (int column = 0; column < 2; ++column)
      scene.add("pane", pane, {{0.3f * (column - 0.5f), 0.44f * (row - 1), 0}, {0.27f, 0.4f, 1}, turn(0), window});
  }
}

/// So that what the slit does not light is not black: weak against the window.
void addCeilingLamp(SceneBuilder& scene) {
  const int lamp = scene.mesh("ceiling lamp", quadMesh(), scene.material(emitter("ceiling lamp", {20, 23, 28})));
  scene.add("ceiling lamp", lamp, {{0.3f, kHeight - 0.02f, 0}, {0.5f, 0.5f, 1}, turn(90, {1, 0, 0})});
}

/// What stands in the fan of light.
void addObjects(SceneBuilder& scene) {
  const int wood = scene.material(matte("wood", {0.45f, 0.27f, 0.13f}, 0.7f));
  const int crate = scene.mesh("crate", boxMesh(), wood), column = scene.mesh("column", cylinderMesh(24), wood);
  const int clay = scene.mesh("clay ball", sphereMesh(3), scene.material(matte("clay", {0.7f, 0.3f, 0.2f}, 0.8f)));
  const int glaze = scene.mesh("glazed ball", sphereMesh(3), scene.material(matte("glaze", {0.1f, 0.25f, 0.5f}, 0.2f)));
  core::Material steel = matte("steel", {0.8f, 0.8f, 0.82f}, 0.25f);
  steel.metallic = 1;
  const int ball = scene.mesh("steel ball", sphereMesh(3), scene.material(steel));
  scene.add("column", column, {{-1.15f, 0.35f, -0.9f}, {0.35f, 0.7f, 0.35f}});
  scene.add("glazed ball", glaze, {{-1.15f, 0.88f, -0.9f}, vec3(0.36f)});
  scene.add("crate", crate, {{-1.9f, 0.25f, 0.15f}, vec3(0.5f), turn(25)});
  scene.add("clay ball", clay, {{-1.9f, 0.65f, 0.15f}, vec3(0.3f)});
  scene.add("steel ball", ball, {{-1.55f, 0.16f, -0.5f}, vec3(0.32f)});
}

}  // namespace

core::Scene ajarScene() {
  SceneBuilder scene("ajar");
  addRoom(scene);
  addDoor(scene);
  addWindow(scene);
  addCeilingLamp(scene);
  addObjects(scene);
  const vec3 eye(1.7f, 1.5f, 2.5f);
  scene.camera(scene.node("camera", {eye, vec3(1), lookAt(eye, {-0.9f, 0.8f, -1.3f})}), 48);
  return scene.take();
}

}  // namespace experiments
