#include "core/files.h"

#include <unistd.h>

#include <atomic>
#include <fstream>

#include "core/check.h"

namespace core {
namespace fs = std::filesystem;

namespace {

/// A name no other writer uses: of this process, by its id, of this program, by a counter.
fs::path temporaryName(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  fs::path name = target;
  name += ".tmp" + std::to_string(getpid()) + "-" + std::to_string(counter++);
  return name;
}

}  // namespace

std::string readFile(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw Error(path.string(), "no such file", "check the name");
  if (!fs::is_regular_file(status)) throw Error(path.string(), "is not a regular file", "name a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string(), "cannot be opened", "check its permissions");
  const std::uintmax_t size = fs::file_size(path, error);
  std::string bytes(error ? 0 : size, '\0');
  if (error || !file.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw Error(path.string(), "cannot be read to its end", "check the disk and the file's permissions");
  return bytes;
}

void writeFileAtomically(const fs::path& path, std::string_view bytes) {
  PendingFile pending(path);
  std::ofstream file(pending.temporary(), std::ios::binary);
  if (!file) throw Error(path.string(), "cannot be created", "check the folder's permissions");
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw Error(path.string(), "could not be written to its end", "check the space left on the disk");
  pending.commit();
}

PendingFile::PendingFile(const fs::path& target) : target_(target), temporary_(temporaryName(target)) {
  std::error_code error;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    throw Error(target.string(), "its folder does not exist", "create " + folder.string());
  if (!target.has_filename() || fs::is_directory(target, error))
    throw Error(target.string(), "is a folder", "name a file inside it");
}

PendingFile::~PendingFile() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void PendingFile::commit() {
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) throw Error(target_.string(), "cannot be created (" + error.message() + ")", "check the folder");
  temporary_.clear();
}

}  // namespace core
