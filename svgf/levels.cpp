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
    s.history.base.view().store(x, y, s.accumulated.base.view().load(x, y));
    for (int j = 0; j < K - 1; ++j)
      for (int p = 0; p < core::kPlanes<core::Stored>; ++p)
        s.history.difference[j].view().plane[p](x, y) = s.accumulated.difference[j].view().plane[p](x, y);
    s.filteredVariance(x, y) = s.variance(x, y);
  });
}

/// Twins whose neighbours are none are none after a filter of `radius` pixels.
void updateTwins(FilterState<2>& s, int radius) {
  Image<StoredLedger<2>>& ledger = s.ledger[s.now];
  core::forEachTile(
      ledger.width(), ledger.height(),
      [&](int x0, int y0, int x1, int y1) {
        const bool twins = s.accumulatedTwins.all(x0 - radius, y0 - radius, x1 + radius, y1 + radius);
        s.twins.of(x0, y0) = twins;
        if (twins) return;
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) ledger(x, y).unmarkTwin();
      },
      twohistory::TwinTiles::kSide);
}

}  // namespace

template <int K>
void filterHistories(const FilterParameters& parameters, const Guide& guide, FilterState<K>& s) {
  const bool filters = parameters.levels > 0, hasTwins = !s.accumulatedTwins.empty();
  if constexpr (K == 2)
    if (hasTwins) updateTwins(s, filters ? kAtrousRadius : 0);
  if (!filters) return keepHistories(s);
  std::vector<In<core::Stored>> differences;
  std::vector<ImageView<core::Stored>> differencesOut;
  for (int j = 0; j < K - 1; ++j) {
    const PlanesView<const core::Stored> in = s.accumulated.difference[j];
    const PlanesView<core::Stored> out = s.history.difference[j];
    differences.insert(differences.end(), in.plane.begin(), in.plane.end());
    differencesOut.insert(differencesOut.end(), out.plane.begin(), out.plane.end());
  }
  fillLuminance(s.accumulated.base, s.luminance);
  atrous({1, parameters.phiColour, parameters.edges, s.accumulated.base, s.history.base, s.variance, s.filteredVariance,
          s.luminance, s.tolerance, differences, differencesOut, hasTwins ? &s.accumulatedTwins : nullptr},
         guide);
}

int filterFurther(const FilterParameters& parameters, const Guide& guide, LevelBuffers& b) {
  int from = 0;
  for (int level = 1; level < parameters.levels; ++level, from = 1 - from) {
    const PlanesView<const float> in = b.colour[from];
    const PlanesView<float> out = b.colour[1 - from];
    fillLuminance(in, b.luminance);
    atrous({1 << level, parameters.phiColour, parameters.edges, in, out, b.variance[from], b.variance[1 - from],
            b.luminance, b.tolerance},
           guide);
  }
  return from;
}

template void filterHistories(const FilterParameters&, const Guide&, FilterState<1>&);
template void filterHistories(const FilterParameters&, const Guide&, FilterState<2>&);
template void filterHistories(const FilterParameters&, const Guide&, FilterState<3>&);

}  // namespace svgf
