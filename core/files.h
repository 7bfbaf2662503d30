// Whole files in and out; a result appears under its name only when it is complete.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace core {

/// All bytes of a regular file. Throws Error where it is missing, not a file, or unreadable.
std::string readFile(const std::filesystem::path& path);

/// Writes bytes under a temporary name in the same folder and renames. Throws Error; leaves nothing half-written.
void writeFileAtomically(const std::filesystem::path& path, std::string_view bytes);

/// A result file while it is being written: whoever writes uses temporary(), then commit() gives it its name.
/// Without commit() the temporary file is removed.
class PendingFile {
 public:
  /// Throws Error where the folder of target does not exist or target is a folder itself.
  explicit PendingFile(const std::filesystem::path& target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::filesystem::path& temporary() const { return temporary_; }
  /// Renames temporary() to the target, replacing what was there. Throws Error.
  void commit();

 private:
  std::filesystem::path target_, temporary_;
};

}  // namespace core
