// Finished sequences of an experiment on disk, so that an interrupted run goes on where it stopped.
#pragma once

#include <filesystem>
#include <optional>

#include "experiments/sequence.h"

namespace experiments {

/// Creates a folder and those above it. Throws core::Error.
void makeFolder(const std::filesystem::path& folder);

/// A file a sequence (one scene, one seed), named by everything that decides its content: a changed configuration,
/// scene or program never reuses one.
class Parts {
 public:
  /// Creates the folder. identity: all settings that results depend on, without scenes and seeds. Throws core::Error.
  Parts(std::filesystem::path folder, Json identity);

  /// Nothing where the sequence has not been finished. sceneHash: of the scene's content. Throws core::Error where a
  /// file is there but broken.
  std::optional<SequenceResult> read(const std::string& scene, const std::string& sceneHash, std::uint64_t seed) const;
  /// Throws core::Error.
  void write(const SequenceResult& result, const std::string& scene, const std::string& sceneHash,
             std::uint64_t seed) const;

 private:
  std::filesystem::path fileOf(const std::string& scene, const std::string& sceneHash, std::uint64_t seed) const;

  std::filesystem::path folder_;
  std::string identity_;
};

}  // namespace experiments
