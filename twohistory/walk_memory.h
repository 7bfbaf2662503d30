// What a pixel's noise has walked through, for predicted variances (mixing.h): the steps of past frames' taps, and when
// it came in over the image's edge. Like both of them it is carried along with the image.
#pragma once

#include "twohistory/arrivals.h"
#include "twohistory/steps.h"

namespace twohistory {

class WalkMemory {
 public:
  WalkMemory() = default;
  WalkMemory(int width, int height) : width_(width), steps_(width, height), arrivals_(width, height) {}

  /// taps: of the frame that comes, at least one with b > 0.
  Walk<float> operator()(const Taps& taps, const TapPairs&) const {
    const std::int32_t pixel = taps.pixel[strongest(taps)];
    return {steps_.at(pixel), arrivals_.at(taps, {pixel % width_, pixel / width_})};
  }
  /// Adds a frame, after everything of that frame has been gathered. taps: width x height, without padding.
  void update(core::In<Taps> taps) {
    steps_.update(taps);
    arrivals_.update(taps);
  }

  std::size_t bytes() const { return steps_.bytes() + arrivals_.bytes(); }

 private:
  int width_ = 0;
  StepTiles steps_;
  ArrivalGrid arrivals_;
};

}  // namespace twohistory
