// Scenes from glTF 2.0 files, .gltf or .glb, through tinygltf.
#pragma once

#include <filesystem>

#include "core/scene.h"

namespace core {

/// Reads the file's default scene, named after the file. All animations play together. What is not supported but can be
/// left out is told in Scene::warnings, one line each kind; the flicker of a material is read from its
/// extras.twofold.emission {times, factors, interpolation}. Throws Error (one line: file, what, what to do) for files
/// that are missing, broken, or need what is not supported; nothing outside the bytes of its buffers is ever read.
Scene loadGltf(const std::filesystem::path& path);

}  // namespace core
