// The Cornell box in metres, wide enough that a 16:9 image shows nothing but the box.
// Source: Goral et al., "Modeling the Interaction of Light Between Diffuse Surfaces" (1984); colours approximated.
#include "experiments/scenes/builder.h"
#include "experiments/scenes/builtin.h"
#include "experiments/scenes/shapes.h"

namespace experiments {
namespace {

using core::vec3;

constexpr float kSide = 2;  // of the cube, whose floor is y = 0 and whose middle is x = z = 0

void addWall(SceneBuilder& scene, const std::string& name, int mesh, const vec3& position, const core::quat& rotation) {
  scene.add(name, mesh, {position, vec3(kSide), rotation});
}

void addWalls(SceneBuilder& scene) {
  const vec3 x(1, 0, 0), middle(0, kSide / 2, 0);
  const float half = kSide / 2;
  const int white = scene.mesh("white wall", quadMesh(), scene.material(matte("white", {0.73f, 0.71f, 0.68f})));
  const int red = scene.mesh("red wall", quadMesh(), scene.material(matte("red", {0.63f, 0.065f, 0.05f})));
  const int green = scene.mesh("green wall", quadMesh(), scene.material(matte("green", {0.14f, 0.45f, 0.09f})));
  addWall(scene, "floor", white, vec3(0), turn(-90, x));
  addWall(scene, "ceiling", white, vec3(0, kSide, 0), turn(90, x));
  addWall(scene, "back", white, middle - vec3(0, 0, half), turn(0));
  addWall(scene, "left", red, middle - vec3(half, 0, 0), turn(90));
  addWall(scene, "right", green, middle + vec3(half, 0, 0), turn(-90));
}

void addBoxes(SceneBuilder& scene) {
  const int box = scene.mesh("box", boxMesh(), scene.material(matte("box", {0.73f, 0.71f, 0.68f})));
  scene.add("tall box", box, {{-0.36f, 0.6f, -0.4f}, {0.6f, 1.2f, 0.6f}, turn(17)});
  scene.add("short box", box, {{0.4f, 0.3f, 0.0f}, {0.6f, 0.6f, 0.6f}, turn(-17)});
}

}  // namespace

core::Scene cornellScene() {
  SceneBuilder scene("cornell");
  addWalls(scene);
  addBoxes(scene);
  const int lamp = scene.mesh("lamp", quadMesh(), scene.material(emitter("lamp", {30, 22, 12})));
  scene.add("lamp", lamp, {{0, kSide - 0.005f, 0.5f}, {0.5f, 0.5f, 1}, turn(90, {1, 0, 0})});
  const vec3 eye(0, 1.1f, 2.3f);
  scene.camera(scene.node("camera", {eye, vec3(1), lookAt(eye, {0, 0.8f, -1})}), 45);
  return scene.take();
}

}  // namespace experiments
