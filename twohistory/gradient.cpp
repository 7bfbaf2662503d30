#include "twohistory/gradient.h"

#include "twohistory/mean.h"

namespace twohistory {
namespace {

using core::ivec2;
using core::vec3;

template <class View>
vec3 gatherMean(const View& before, const Taps& taps) {
  Step step;
  step.taps = taps;
  return Mean<vec3>{}.gather(before, step);
}

/// 3x3 edge-aware mean around (x, y).
vec3 filtered(const core::Guide& guide, const core::EdgeParameters& edges, core::PlanesView<const float> image, int x,
              int y) {
  vec3 sum(0);
  float total = 0;
  for (int j = std::max(0, y - 1); j <= std::min(y + 1, guide.height() - 1); ++j) {
    for (int i = std::max(0, x - 1); i <= std::min(x + 1, guide.width() - 1); ++i) {
      const float w = core::edgeWeight(guide, edges, {x, y}, {i, j});
      sum += w * image.load(i, j);
      total += w;
    }
  }
  return total > 0 ? sum / total : vec3(0);
}

/// Whether a tap's history holds anything that the frame could differ from.
template <int K>
bool knowsAnything(const Taps& t, LedgerView<K> before, int history) {
  for (int k = 0; k < 4; ++k)
    if (t.b[k] > 0 && before.at(t.pixel[k]).weight[history] > 0) return true;
  return false;
}

}  // namespace

void GradientState::fit(int width, int height) {
  if (gradient.width() == width && gradient.height() == height) return;
  gradient = unfiltered = signal = core::Planes(width, height);
}

template <int K>
void updateGradient(const GradientParameters& p, const core::Guide& guide, In<Taps> taps, In<float> n,
                    LedgerView<K> ledgerBefore, int history, const HistoryView& before,
                    core::PlanesView<const float> fresh, GradientState& state) {
  const int width = guide.width(), height = guide.height();
  const core::PlanesView<const float> gradient = state.gradient, signal = state.signal;
  core::forEachPixel(width, height, [&](int x, int y) {
    const Taps& t = taps(x, y);
    vec3 g(0);
    if (t.valid()) {
      g = gatherMean(gradient, t);
      if (n(x, y) > 0 && knowsAnything<K>(t, ledgerBefore, history)) {
        const vec3 past = p.source == GradientSource::filtered
                              ? gatherMean(before, premultiplied<K>(t, ledgerBefore, history))
                              : gatherMean(signal, t);
        g = core::lerp(g, fresh.load(x, y) - past, p.rate);
      }
    }
    state.unfiltered.view().store(x, y, g);
  });
  // The signal of a pixel without samples is what its history says: nothing changed.
  if (p.source == GradientSource::signal) {
    core::Planes& next = state.gradient;  // free until the filter below writes it
    core::forEachPixel(width, height, [&](int x, int y) {
      const Taps& t = taps(x, y);
      next.view().store(x, y, n(x, y) > 0 ? fresh.load(x, y) : gatherMean(signal, t));
    });
    std::swap(state.signal, state.gradient);
  }
  core::forEachPixel(width, height, [&](int x, int y) {
    state.gradient.view().store(x, y, filtered(guide, p.edges, state.unfiltered, x, y));
  });
}

template void updateGradient(const GradientParameters&, const core::Guide&, In<Taps>, In<float>, LedgerView<1>, int,
                             const HistoryView&, core::PlanesView<const float>, GradientState&);
template void updateGradient(const GradientParameters&, const core::Guide&, In<Taps>, In<float>, LedgerView<2>, int,
                             const HistoryView&, core::PlanesView<const float>, GradientState&);
template void updateGradient(const GradientParameters&, const core::Guide&, In<Taps>, In<float>, LedgerView<3>, int,
                             const HistoryView&, core::PlanesView<const float>, GradientState&);

}  // namespace twohistory
