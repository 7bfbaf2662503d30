// What reuse leaves behind, for people to look at: how old samples are, how far they are trusted, how often they occur
// and what they are worth. Read from the reservoirs after a frame's passes; nothing is paid where nobody asks.
#pragma once

#include "restir/restir.h"

namespace restir {

/// Images of one frame, in sequence order. Where there is no surface all are 0, and age is -1.
class Diagnostics {
 public:
  static constexpr int kReach = 5;  ///< neighbours that duplicates are counted among: (2 kReach + 1)^2 - 1

  Diagnostics(int width, int height);

  /// To be called once a frame, in order, after reuseSpatiallyAndShade() with parameters.tellAll set.
  void update(const RestirParameters& parameters, const Frame& frame, const RestirState& state);

  /// Frames since the sample that the pixel's reservoir holds was drawn; -1 where it holds none.
  In<float> age() const { return age_; }
  /// c of that reservoir, in samples or frames, as its policy weighs.
  In<float> confidence() const { return confidence_; }
  /// How many of the (2 kReach + 1)^2 - 1 nearest pixels hold the very same sample.
  In<float> duplicates() const { return duplicates_; }
  /// N_eff: independent samples that the frame's radiance is worth in a long mean, [told]; n without reuse.
  In<float> effective() const { return effective_; }

 private:
  float ageOf(const RestirState& state, const Reservoir& r, int x, int y) const;

  Image<float> age_, ageBefore_, confidence_, duplicates_, effective_;
};

}  // namespace restir
