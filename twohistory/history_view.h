// Colours of several histories: history 0 as floats, every other as its difference from history 0 in two bytes a
// channel. Differences are small where histories agree, so their rounding is too; and they decay, so they never stall.
#pragma once

#include "core/image.h"
#include "core/stored.h"

namespace twohistory {

using Differences = core::PlanesOf<core::Stored>;

/// Reads one history.
struct HistoryView {
  core::PlanesView<const float> base;               ///< history 0
  core::PlanesView<const core::Stored> difference;  ///< from it; empty = history 0 itself

  core::vec3 load(int x, int y) const {
    return difference.empty() ? base.load(x, y) : base.load(x, y) + difference.load(x, y);
  }
  core::vec3 at(std::ptrdiff_t i) const { return difference.empty() ? base.at(i) : base.at(i) + difference.at(i); }
  /// What lies between this history and history 0.
  core::vec3 fromBase(int x, int y) const { return difference.empty() ? core::vec3(0) : difference.load(x, y); }
};

/// Writes one history; history 0 of a pixel goes first.
struct HistorySink {
  core::PlanesView<float> base;
  core::PlanesView<core::Stored> difference;

  void store(int x, int y, const core::vec3& value) const {
    if (difference.empty()) return base.store(x, y, value);
    difference.store(x, y, value - base.load(x, y));
  }
};

/// K histories of one image and their owner.
template <int K>
struct HistoryColours {
  core::Planes base;
  std::array<Differences, K - 1> difference;

  HistoryColours() = default;
  HistoryColours(int width, int height) : base(width, height) {
    for (Differences& d : difference) d = Differences(width, height);
  }
  std::array<HistoryView, K> views() const {
    std::array<HistoryView, K> all{HistoryView{base, {}}};
    for (int j = 1; j < K; ++j) all[j] = {base, difference[j - 1]};
    return all;
  }
  std::array<HistorySink, K> sinks() {
    std::array<HistorySink, K> all{HistorySink{base, {}}};
    for (int j = 1; j < K; ++j) all[j] = {base, difference[j - 1]};
    return all;
  }
  std::size_t bytes() const {
    std::size_t sum = base.bytes();
    for (const Differences& d : difference) sum += d.bytes();
    return sum;
  }
};

}  // namespace twohistory
