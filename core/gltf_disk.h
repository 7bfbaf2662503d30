// The disk as a glTF parser may see it. tinygltf's own functions also search the working directory, and allocate what a
// file claims before they check it.
#pragma once

#include <string>
#include <vector>

namespace core {

/// The folder of a glTF file, handed to the functions below as their user pointer.
struct GltfFolder {
  std::string where;  ///< the glTF file, for messages
  std::string path;   ///< its folder
};

/// path: folder.path / URI. Throws Error unless the URI is a relative path to a file that is there.
bool gltfFileExists(const std::string& path, void* folder);
std::string gltfFilePath(const std::string& path, void* folder);
bool readGltfFile(std::vector<unsigned char>* out, std::string* error, const std::string& path, void* folder);

}  // namespace core
