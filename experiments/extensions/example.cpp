// An extension in one small file: a weighting, a blend, a variant that uses both, and a remembered value. The text of
// docs/extending.md is made of these lines; tests/extending_test.cpp runs them.
#include <algorithm>
#include <cmath>

#include "experiments/variant.h"
#include "twohistory/history.h"

namespace {

// [weighting]
/// Between frames (n^0) and samples (n^1): trusts eight samples as much as the square root of eight.
double rootOfSamples(double n) { return std::sqrt(n); }
// [end]

// [blend]
/// Weighs each history by its precision, and takes no notice of what they share.
std::array<float, 3> byPrecision(const twohistory::PixelHistories& pixel) {
  std::array<float, 3> weights{};
  float total = 0;
  for (int j = 0; j < pixel.count; ++j)
    if (pixel.covariance[j][j] > 0) total += weights[j] = 1 / pixel.covariance[j][j];
  if (!(total > 0)) return {1, 0, 0};
  for (float& w : weights) w /= total;
  return weights;
}
// [end]

// [variant]
experiments::Variant exampleVariant() {
  experiments::Variant v;
  v.name = "example";
  v.histories = {{twohistory::Weighting::custom, twohistory::Forgetting::decay, 0.95, rootOfSamples},
                 {twohistory::Weighting::samples, twohistory::Forgetting::decay, 0.8}};
  v.blend.mode = twohistory::BlendMode::custom;
  v.blend.custom = byPrecision;
  return v;
}
const experiments::Extension example(exampleVariant());
// [end]

}  // namespace

namespace example {

// [value]
/// Remembers the brightest sample of a pixel's surface, fading with the weight of the history that saw it.
struct Brightest {
  /// step.taps are premultiplied by what their histories weigh; of several taps the brightest counts.
  template <class Before>
  float gather(const Before& before, const twohistory::Step& step) const {
    float most = 0;
    for (int k = 0; k < 4; ++k)
      if (step.taps.b[k] > 0) most = std::max(most, before.at(step.taps.pixel[k]));
    return most;
  }
  /// kept and fresh are the weights of the history and of the new value; fresh = 0 means that there is none.
  float merge(float old, float fresh, const twohistory::Step& step) const {
    return step.fresh > 0 ? std::max(fresh, (1 - step.alpha()) * old) : old;
  }
};
static_assert(twohistory::Merge<Brightest, core::In<float>, float, float>);
// [end]

}  // namespace example
