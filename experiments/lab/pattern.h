// Where the laboratory places samples.
#pragma once

#include "core/foveation.h"
#include "core/gaze.h"

namespace experiments::lab {

enum class PatternKind { fovea, checkerboard, random, constant };

struct PatternParameters {
  PatternKind kind = PatternKind::fovea;
  core::GazeParameters gaze;
  core::FoveationParameters foveation;  ///< fovea: 8 inside, 1 outside
  float most = 2;                       ///< checkerboard: this and 0 in turn; random: 0 .. this; constant: this
};

template <class V>
void describe(V& v, PatternParameters& p) {
  v.choice("kind", p.kind,
           {{"fovea", PatternKind::fovea},
            {"checkerboard", PatternKind::checkerboard},
            {"random", PatternKind::random},
            {"constant", PatternKind::constant}},
           "samples per pixel");
  v("gaze", p.gaze, "fovea: where it moves");
  v("foveation", p.foveation, "fovea: how it falls off");
  v("most", p.most, "checkerboard: this and 0 in turn; random: 0 to this; constant: this", 0.0, 4096.0);
}

class Pattern {
 public:
  explicit Pattern(const PatternParameters& p) : parameters_(p), gaze_(p.gaze), foveation_(p.foveation) {}
  /// Counts of a frame at 30 a second, and the mask of the fovea (0 everywhere for other patterns).
  void place(std::uint64_t seed, std::uint32_t frame, core::ImageView<float> n,
             core::ImageView<std::uint8_t> fovea) const;

 private:
  float countAt(std::uint64_t seed, std::uint32_t frame, int x, int y, int width) const;

  PatternParameters parameters_;
  core::Gaze gaze_;
  core::Foveation foveation_;
};

}  // namespace experiments::lab
