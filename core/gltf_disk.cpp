#include "core/gltf_disk.h"

#include <filesystem>

#include "core/check.h"
#include "core/files.h"

namespace core {

bool gltfFileExists(const std::string& path, void* user) {
  const GltfFolder& folder = *static_cast<const GltfFolder*>(user);
  const std::string uri = path.substr(folder.path.size() + 1);
  if (uri.rfind("data:", 0) == 0)
    throw Error(folder.where, "has a data: URI that cannot be decoded", "repair the file or export it again");
  if (uri.empty() || uri[0] == '/' || uri.find(':') < uri.find('/'))
    throw Error(folder.where, "refers to '" + uri.substr(0, 80) + "'", "refer to files by a path relative to it");
  if (!std::filesystem::is_regular_file(path))
    throw Error(folder.where, "its file " + uri + " is missing", "put it at " + path);
  return true;
}

std::string gltfFilePath(const std::string& path, void*) { return path; }

bool readGltfFile(std::vector<unsigned char>* out, std::string*, const std::string& path, void*) {
  const std::string bytes = readFile(path);
  out->assign(bytes.begin(), bytes.end());
  return true;
}

}  // namespace core
