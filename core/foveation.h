// How many samples every pixel gets: uniform, many around the gaze and few elsewhere, or a map from a file.
// Source of the defaults: [Tu24], evaluation: 8 samples within 200 of 720 lines around the gaze, else 1.
#pragma once

#include <string>

#include "core/image.h"

namespace core {

inline constexpr float kMaxSamples = 4096;  ///< per pixel and frame

enum class FoveationKind : std::uint8_t { uniform, circle, smooth, map };
enum class Rounding : std::uint8_t { nearest, stochastic };

struct FoveationParameters {
  FoveationKind kind = FoveationKind::circle;
  float radius = 200.0f / 720;    ///< of the fovea, fraction of the image's height
  float inside = 8, outside = 1;  ///< samples per pixel in the fovea and beyond it
  float fallOff = 200.0f / 720;   ///< smooth: width of the ring in which counts fall, fraction of the image's height
  float samples = 1;              ///< uniform: samples per pixel
  std::string file;               ///< map: OpenEXR image with one channel
  float scale = 1;                ///< map: factor on its values
  Rounding rounding = Rounding::nearest;
};

template <class V>
void describe(V& v, FoveationParameters& p) {
  v.choice("kind", p.kind,
           {{"uniform", FoveationKind::uniform},
            {"circle", FoveationKind::circle},
            {"smooth", FoveationKind::smooth},
            {"map", FoveationKind::map}},
           "how samples are placed");
  v("radius", p.radius, "of the fovea, fraction of the image height", 0.0, 10.0);
  v("inside", p.inside, "samples per pixel in the fovea", 0.0, kMaxSamples);
  v("outside", p.outside, "samples per pixel beyond the fovea", 0.0, kMaxSamples);
  v("fallOff", p.fallOff, "smooth: width of the ring in which counts fall, fraction of the image height", 0.0, 10.0);
  v("samples", p.samples, "uniform: samples per pixel", 0.0, kMaxSamples);
  v("file", p.file, "map: OpenEXR file with one channel, samples per pixel before scale");
  v("scale", p.scale, "map: factor on its values", 0.0, 1e6);
  v.choice("rounding", p.rounding, {{"nearest", Rounding::nearest}, {"stochastic", Rounding::stochastic}},
           "of counts to whole numbers; stochastic keeps their mean");
}

/// Places samples. Counts depend on parameters, gaze, seed and frame alone, never on a rendered value, so reuse with
/// them stays unbiased.
class Foveation {
 public:
  /// Reads the map if there is one; throws Error where it is not a single channel of counts in [0, 4096] after scale.
  explicit Foveation(const FoveationParameters& parameters);

  /// Writes whole counts in [0, 4096] and a mask of the fovea (1 inside, 0 outside), both of one size.
  /// gaze in pixels. The fovea is the circle around it; of a map, the pixels with at least `inside` samples.
  void place(vec2 gaze, std::uint64_t seed, std::uint32_t frame, ImageView<float> counts,
             ImageView<std::uint8_t> fovea) const;

 private:
  float mapped(int x, int y, int width, int height) const;
  float wanted(float distance, float height) const;

  FoveationParameters parameters_;
  Image<float> map_;
};

}  // namespace core
