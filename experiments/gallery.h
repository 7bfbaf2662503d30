// The images of an experiment on disk, and the report's figures made of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/config.h"
#include "experiments/report.h"
#include "experiments/sequence.h"

namespace experiments {

/// Frames whose images are kept: those asked for, else up to three spread over those with a reference.
std::vector<int> galleryFrames(const Config& config);

/// Writes and finds images: folder/SCENE/VARIANT.FRAME.exr, .png, and .error.png for the error map; raw.FRAME.age.png
/// and so on for what reuse leaves behind.
class Gallery {
 public:
  Gallery(const Config& config, std::filesystem::path folder);

  void add(const std::string& scene, const FrameImage& image) const;
  void addDiagnostics(const std::string& scene, int frame, const restir::Diagnostics& diagnostics) const;
  void addReference(const std::string& scene, int frame, core::PlanesView<const float> image) const;
  /// Figures of one scene from what lies on disk; panels that are missing are left out.
  std::vector<Figure> figures(const std::string& scene, const std::vector<std::string>& variants) const;

 private:
  std::filesystem::path fileOf(const std::string& scene, const std::string& variant, int frame,
                               const char* ending) const;
  void write(const std::string& scene, const std::string& variant, int frame, core::PlanesView<const float> image,
             const core::vec2* gaze) const;
  std::vector<Figure> reuseFigures(const std::string& scene) const;
  Panel panel(const std::string& label, const std::filesystem::path& file) const;

  const Config& config_;
  std::filesystem::path folder_;
};

}  // namespace experiments
