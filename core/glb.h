// Scenes as binary glTF 2.0.
#pragma once

#include <filesystem>
#include <string>

#include "core/scene.h"

namespace core {

/// The scene as a .glb file's bytes, equal for equal scenes: one glTF primitive a mesh, textures embedded as PNG,
/// emission by KHR_materials_emissive_strength, lights by KHR_lights_punctual, flicker as a material's
/// extras.twofold.emission {times, factors, interpolation}. loadGltf() gives the same scene back; what hangs on a node
/// that already holds one of its kind gets a child node. Throws Error for a scene that glTF cannot hold (a mesh without
/// triangles).
std::string glbBytes(const Scene& scene);

/// Writes under a temporary name and renames. Throws Error.
void saveGlb(const Scene& scene, const std::filesystem::path& path);

}  // namespace core
