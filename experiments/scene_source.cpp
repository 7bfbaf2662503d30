#include "experiments/scene_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "core/check.h"
#include "core/glb.h"
#include "core/gltf.h"
#include "core/random.h"
#include "experiments/scenes/builtin.h"

namespace experiments {
namespace {

/// FNV-1a, 64 bits, from a start of its own.
std::uint64_t fnv(std::string_view bytes, std::uint64_t hash) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return hash;
}

std::uint64_t sceneHash(const std::string& glb, const core::Environment* environment, std::uint64_t start) {
  std::uint64_t hash = fnv(glb, start);
  if (environment) {
    const auto texels = environment->texels();
    hash = fnv(std::to_string(environment->width()), hash);
    hash = fnv({reinterpret_cast<const char*>(texels.data()), texels.size_bytes()}, hash);
  }
  return core::mixBits(hash);
}

core::Scene loadBuiltin(const std::string& name, std::filesystem::path folder) {
  if (folder.empty()) folder = std::filesystem::temp_directory_path();
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const auto file = folder / (name + ".glb");
  core::saveGlb(builtinScene(name), file);
  return core::loadGltf(file);
}

}  // namespace

std::shared_ptr<const core::Environment> environmentOf(const SceneParameters& p) {
  if (p.environment.empty()) return nullptr;
  auto environment = core::loadEnvironment(p.environment, p.environmentScale);
  if (environment->negatives() > 0)
    fmt::print(stderr, "twofold: {}: {} pixels have negative values, which count as 0\n", p.environment,
               environment->negatives());
  if (environment->black()) fmt::print(stderr, "twofold: {}: it is black: it gives no light\n", p.environment);
  return environment;
}

core::Scene loadScene(const std::string& nameOrFile, const std::filesystem::path& folder,
                      std::shared_ptr<const core::Environment> environment) {
  const bool builtin = isBuiltin(nameOrFile);
  if (!builtin && !std::filesystem::path(nameOrFile).has_extension()) {
    std::string known;
    for (const auto& name : builtinSceneNames()) known += (known.empty() ? "" : ", ") + name;
    throw core::Error(nameOrFile, "neither a built-in scene nor a glTF file",
                      "give a .gltf or .glb file, or one of " + known);
  }
  core::Scene scene = builtin ? loadBuiltin(nameOrFile, folder) : core::loadGltf(nameOrFile);
  scene.environment = std::move(environment);
  const bool lit = !scene.punctual.empty() || (scene.environment && !scene.environment->black()) ||
                   std::any_of(scene.instances.begin(), scene.instances.end(), [&](const core::Instance& i) {
                     return scene.materials[scene.meshes[i.mesh].material].emits();
                   });
  if (!lit) scene.warnings.push_back("it has no light: its frames are black");
  for (const auto& warning : scene.warnings) fmt::print(stderr, "twofold: {}: {}\n", nameOrFile, warning);
  return scene;
}

std::string sceneLabel(const std::string& nameOrFile) {
  return isBuiltin(nameOrFile) ? nameOrFile : std::filesystem::path(nameOrFile).stem().string();
}

std::string contentHash(const core::Scene& scene) {
  const std::string bytes = core::glbBytes(scene);
  const core::Environment* environment = scene.environment.get();
  return fmt::format("{:016x}{:016x}", sceneHash(bytes, environment, 0xcbf29ce484222325ull),
                     sceneHash(bytes, environment, 0x9e3779b97f4a7c15ull));
}

}  // namespace experiments
