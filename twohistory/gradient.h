// The seed method's temporal gradient, kept for comparison: lag regression needs none of it.
// Source: [Tu24] "Gradient Estimation"; constants as its author shipped it (docs/decisions.md names the differences).
#pragma once

#include "core/edge_weight.h"
#include "twohistory/history.h"
#include "twohistory/history_view.h"
#include "twohistory/packed_ledger.h"

namespace twohistory {

/// filtered: g <- 0.8 gather(g) + 0.2 (x - gathered fed-back I_u), as shipped.
/// signal: g <- beta gather(g) + (1 - beta) (x - gathered x of the frame before), as on the slide.
enum class GradientSource { filtered, signal };

struct GradientParameters {
  GradientSource source = GradientSource::filtered;
  float rate = 0.2f;  ///< share of the fresh difference
  core::EdgeParameters edges;
};

/// Planes kept between frames.
struct GradientState {
  core::Planes gradient, unfiltered, signal;
  void fit(int width, int height);
  std::size_t bytes() const { return gradient.bytes() + unfiltered.bytes() + signal.bytes(); }
};

/// One frame of the gradient: update, then a 3x3 edge-aware filter whose result is fed back. Where n = 0 the gradient
/// stays; after a reset it is 0. before: the fed-back first history; fresh: demodulated radiance.
template <int K>
void updateGradient(const GradientParameters& parameters, const core::Guide& guide, In<Taps> taps, In<float> n,
                    LedgerView<K> ledgerBefore, int history, const HistoryView& before,
                    core::PlanesView<const float> fresh, GradientState& state);

}  // namespace twohistory
