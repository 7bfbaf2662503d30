// Scenes by name or file.
#pragma once

#include <filesystem>
#include <string>

#include "core/environment.h"
#include "core/scene.h"

namespace experiments {

/// What every scene gets beside what its own file says.
struct SceneParameters {
  std::string environment;     ///< OpenEXR or Radiance HDR map of all directions; empty = none
  float environmentScale = 1;  ///< of its radiance
};

template <class V>
void describe(V& v, SceneParameters& p) {
  v("environment", p.environment,
    "latitude-longitude map (OpenEXR or Radiance HDR) that lights every scene; a relative name starts at the working "
    "directory; empty = none");
  v("environmentScale", p.environmentScale, "factor on the map's radiance", 1e-9, 1e9);
}

/// The map that the parameters name, null for none. Prints warnings: black, negative values. Throws core::Error.
std::shared_ptr<const core::Environment> environmentOf(const SceneParameters& p);

/// A glTF file, or a built-in scene. A built-in one is written to folder as .glb and loaded from there, so that it goes
/// the way of every other scene; an empty folder uses the system's temporary one. Prints the scene's warnings once.
/// environment: lights the scene too; null = none. Throws core::Error.
core::Scene loadScene(const std::string& nameOrFile, const std::filesystem::path& folder = {},
                      std::shared_ptr<const core::Environment> environment = nullptr);

/// A name for tables and files: the built-in name, or the file's stem.
std::string sceneLabel(const std::string& nameOrFile);

/// 32 hexadecimal digits that depend on everything in the scene, its environment included.
std::string contentHash(const core::Scene& scene);

}  // namespace experiments
