// What errors are measured against: unfiltered frames of many samples, as two independent halves.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "experiments/config.h"
#include "experiments/metrics.h"
#include "experiments/stage.h"

namespace experiments {

/// Two independent images of one frame, emission included. Their product form keeps the reference's own noise out of
/// errors; their mean is the better image.
struct ReferenceFrame {
  core::Planes first, second;
  Reference view() const { return {first, second}; }
  core::Planes mean() const;
};

/// Mean of `samples` light-sampling estimates a pixel, without reuse. stream: independent images have different ones.
void renderReference(const Instant& instant, int samples, std::uint64_t stream, int tile, core::PlanesView<float> out);

/// References of one scene: rendered when first asked for, kept on disk under the content of scene and settings.
class References {
 public:
  References(const Stage& stage, const Config& config, std::string sceneHash);
  /// The reference of a frame. A cached file that cannot be read is rendered anew.
  const ReferenceFrame& at(int frame);

 private:
  std::filesystem::path fileOf(int frame) const;
  ReferenceFrame render(int frame) const;

  const Stage& stage_;
  const Config& config_;
  std::string sceneHash_;
  std::map<int, ReferenceFrame> kept_;
};

}  // namespace experiments
