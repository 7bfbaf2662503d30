#include "experiments/compare.h"

#include <map>

#include "core/exr.h"
#include "experiments/json_text.h"

namespace experiments {

std::vector<std::pair<std::string, double>> namedMetrics(const Metrics& m) {
  return {{"relMSE", m.relMse},     {"relMSE_trimmed", m.relMseTrimmed},
          {"SSIM", m.ssim},         {"energy_ratio", m.energyRatio},
          {"MSE", m.mse},           {"bias", m.bias},
          {"max_error", m.maxError}};
}

std::string metricMeaning(const std::string& name) {
  static const std::map<std::string, std::string> meanings{
      {"relMSE",
       "mean over pixels and channels of (y - r)\u00b2 / (r\u00b2 + 0.01); with two independent halves of the "
       "reference the numerator is (y - r1)(y - r2), so that the reference's own noise does not count. "
       "Lower is better"},
      {"relMSE_trimmed", "relMSE without the 0.1 % of pixels that are worst. Lower is better"},
      {"SSIM",
       "structural similarity (Gaussian window 11x11, sigma 1.5) on x / (1 + x) with the sRGB curve, 5-pixel "
       "border left out. Higher is better, 1 is equal"},
      {"energy_ratio", "mean luminance over that of the reference. 1 is right"},
      {"clamped_energy", "luminance that the firefly clamp took away, as a share of the unfiltered frames'"},
      {"milliseconds", "wall-clock time a frame of the passes that sample light, median over frames. Lower is better"},
      {"bytes_per_pixel", "memory that a variant keeps or reuses between frames"},
      {"energy_over_raw", "mean luminance over that of the unfiltered frame, both over the whole sequence. 1 is right"},
      {"MSE", "mean of (y - r1)(y - r2). Lower is better"},
      {"MSE_rgb", "the same over channels, where MSE is of luminance. Lower is better"},
      {"bias", "mean of y - r. 0 is right"},
      {"border_step",
       "squared step of the mean error across the border of the region: what an eye sees of it. Lower is better"},
      {"border_noise", "noise outside over noise inside, next to the border of the region"},
      {"border_contrast2",
       "squared Weber contrast of the step that the mean image has across the border of the region, from all seeds "
       "together; visible from about 1e-4 (1 %). Lower is better"},
      {"max_error", "largest |y - r| of any channel. Lower is better"}};
  const auto found = meanings.find(name);
  return found == meanings.end() ? "" : found->second;
}

Json compareFiles(const std::string& referenceFile, const std::string& testFile, const std::string& layer) {
  const core::Planes reference = core::rgbOf(core::readExr(referenceFile), layer, referenceFile);
  const core::Planes test = core::rgbOf(core::readExr(testFile), layer, testFile);
  const Comparison comparison(test.view(), Reference(reference.view(), referenceFile), testFile);
  Json json;
  for (const auto& [name, value] : namedMetrics(comparison.in())) json[name] = numberOrNull(value);
  return json;
}

}  // namespace experiments
