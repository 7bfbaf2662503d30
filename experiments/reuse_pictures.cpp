#include "experiments/reuse_pictures.h"

#include "core/exr.h"
#include "core/files.h"

namespace experiments {

const std::array<ReuseQuantity, 4>& reuseQuantities() {
  using restir::Diagnostics;
  static constexpr std::array<ReuseQuantity, 4> kQuantities{{
      {"age", "age of the pixel's sample in frames (grey: new, or none)", {1, 64}, &Diagnostics::age},
      {"confidence", "confidence of the pixel's reservoir", {1, 256}, &Diagnostics::confidence},
      {"duplicates",
       "how many of the 120 nearest pixels hold the same sample (grey: none)",
       {1, 64},
       &Diagnostics::duplicates},
      {"effective",
       "N_eff, independent samples that the frame is worth in a long mean",
       {0.03125, 8},
       &Diagnostics::effective},
  }};
  return kQuantities;
}

Picture reusePicture(const ReuseQuantity& quantity, const restir::Diagnostics& diagnostics) {
  return scalarPicture((diagnostics.*quantity.values)(), quantity.scale);
}

void writeReusePictures(const std::filesystem::path& stem, const restir::Diagnostics& diagnostics, bool exr) {
  core::ExrImage image;
  for (const ReuseQuantity& q : reuseQuantities()) {
    std::filesystem::path file = stem;
    file += std::string(".") + q.name + ".png";
    core::writeFileAtomically(file, pngBytes(reusePicture(q, diagnostics)));
    image.add(q.name, (diagnostics.*q.values)());
  }
  if (!exr) return;
  std::filesystem::path file = stem;
  file += ".reuse.exr";
  core::writeExr(file, image);
}

}  // namespace experiments
