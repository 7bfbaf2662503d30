// Scenes by name or file.
#pragma once

#include <filesystem>
#include <string>

#include "core/scene.h"

namespace experiments {

/// A glTF file, or a built-in scene. A built-in one is written to folder as .glb and loaded from there, so that it goes
/// the way of every other scene; an empty folder uses the system's temporary one. Prints the scene's warnings once.
/// Throws core::Error.
core::Scene loadScene(const std::string& nameOrFile, const std::filesystem::path& folder = {});

/// A name for tables and files: the built-in name, or the file's stem.
std::string sceneLabel(const std::string& nameOrFile);

/// 32 hexadecimal digits that depend on everything in the scene.
std::string contentHash(const core::Scene& scene);

}  // namespace experiments
