// Which images each à-trous level filters: all histories at the first, the blended image at the others.
#include <vector>

#include "svgf/atrous.h"
#include "svgf/svgf.h"

namespace svgf {
namespace {

void fillLuminance(PlanesView<const float> colour, ImageView<float> out) {
  core::forEachPixel(out.width, out.height, [&](int x, int y) { out(x, y) = core::luminance(colour.load(x, y)); });
}

/// Without a spatial filter the accumulated histories are fed back and blended as they are.
template <int K>
void keepHistories(FilterState<K>& s) {
  core::forEachPixel(s.variance.width(), s.variance.height(), [&](int x, int y) {
    for (int j = 0; j < K; ++j) s.history[j].view().store(x, y, s.accumulated[j].view().load(x, y));
    s.filteredVariance(x, y) = s.variance(x, y);
  });
}

}  // namespace

template <int K>
void filterHistories(const FilterParameters& parameters, const Guide& guide, FilterState<K>& s) {
  if (parameters.levels == 0) return keepHistories(s);
  std::array<In<float>, 3 * K> inputs;
  std::array<ImageView<float>, 3 * K> outputs;
  for (int j = 0; j < K; ++j) {
    const PlanesView<const float> in = s.accumulated[j];
    const PlanesView<float> out = s.history[j];
    for (int c = 0; c < 3; ++c) inputs[3 * j + c] = in.plane[c], outputs[3 * j + c] = out.plane[c];
  }
  fillLuminance(s.accumulated[0], s.luminance);
  atrous({1, parameters.phiColour, parameters.edges, inputs, outputs, s.variance, s.filteredVariance, s.luminance,
          s.tolerance},
         guide);
}

int filterFurther(const FilterParameters& parameters, const Guide& guide, LevelBuffers& b) {
  int from = 0;
  for (int level = 1; level < parameters.levels; ++level, from = 1 - from) {
    const PlanesView<const float> in = b.colour[from];
    const PlanesView<float> out = b.colour[1 - from];
    const std::array<In<float>, 3> inputs{in.plane[0], in.plane[1], in.plane[2]};
    const std::array<ImageView<float>, 3> outputs{out.plane[0], out.plane[1], out.plane[2]};
    fillLuminance(in, b.luminance);
    atrous({1 << level, parameters.phiColour, parameters.edges, inputs, outputs, b.variance[from], b.variance[1 - from],
            b.luminance, b.tolerance},
           guide);
  }
  return from;
}

template void filterHistories(const FilterParameters&, const Guide&, FilterState<1>&);
template void filterHistories(const FilterParameters&, const Guide&, FilterState<2>&);
template void filterHistories(const FilterParameters&, const Guide&, FilterState<3>&);

}  // namespace svgf
