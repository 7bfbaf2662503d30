// What a pixel's noise has walked through, for predicted variances (mixing.h): the walk that a reference history makes
// beside it, the last frame's sample counts, and when it came in over the image's edge. Like histories all of them are
// carried along with the image.
#pragma once

#include "twohistory/arrivals.h"
#include "twohistory/sample_counts.h"
#include "twohistory/walk_tiles.h"

namespace twohistory {

/// Of one pixel before a frame; answers as SettledWalk does. Valid until the memory's next update.
class RememberedWalk {
 public:
  ReferenceWalk reference;
  std::array<float, 4> b, counts;  ///< of the pixel's taps; 0 where b is 0
  Arrival arrival;

  float freshNoise(const Policy& policy, float /*n*/) const {
    float sum = 0;
    for (int k = 0; k < 4; ++k) sum += b[k] * twohistory::freshNoise(policy, counts[k]);
    return sum;
  }
  OlderNoise<float> older(const TapPairs& pairs, const Remembered<float>& h, float freshShare) const {
    return reference.older(pairs, h, freshShare);
  }
  EdgeNoise<float> edge(const TapPairs& pairs, const Policy& policy, const Remembered<float>& h, float noise) const {
    return arrival.isLongAgo() ? EdgeNoise<float>{} : reference.edge(pairs, arrival, h, noisePerWeight(policy) / noise);
  }
  /// w / n of the last frame; 0 where it had no samples.
  float noisePerWeight(const Policy& policy) const {
    float sum = 0, part = 0;
    for (int k = 0; k < 4; ++k)
      if (b[k] > 0 && counts[k] > 0) sum += b[k] * (freshWeight(policy, counts[k]) / counts[k]), part += b[k];
    return part > 0 ? sum / part : 0.0f;
  }
};

class WalkMemory {
 public:
  WalkMemory() = default;
  WalkMemory(int width, int height)
      : width_(width), walks_(width, height), counts_(width, height), arrivals_(width, height) {}

  /// taps: of the frame that comes, at least one with b > 0.
  RememberedWalk operator()(const Taps& taps, const TapPairs&) const {
    const std::int32_t pixel = taps.pixel[strongest(taps)];
    RememberedWalk walk{walks_.at(pixel), taps.b, {}, arrivals_.at(taps, {pixel % width_, pixel / width_})};
    for (int k = 0; k < 4; ++k) walk.counts[k] = taps.b[k] > 0 ? counts_.at(taps.pixel[k]) : 0.0f;
    return walk;
  }
  /// Adds a frame, after everything of that frame has been gathered. taps, counts: width x height, without padding.
  void update(core::In<Taps> taps, core::In<float> counts) {
    counts_.update(counts);
    walks_.update(taps, counts_);
    arrivals_.update(taps);
  }

  std::size_t bytes() const { return walks_.bytes() + counts_.bytes() + arrivals_.bytes(); }

 private:
  int width_ = 0;
  WalkTiles walks_;
  SampleCounts counts_;
  ArrivalGrid arrivals_;
};

}  // namespace twohistory
