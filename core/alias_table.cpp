// Vose's pairing of light bins with heavy ones, in whole numbers out of 2^32.
#include "core/alias_table.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace core {

AliasTable::AliasTable(std::span<const float> weights) {
  double sum = 0;
  for (float w : weights) {
    CHECK(w >= 0 && std::isfinite(w));
    sum += w;
  }
  if (!(sum > 0)) return;
  std::vector<double> scaled(weights.size());
  const double scale = static_cast<double>(weights.size()) / sum;
  for (std::size_t i = 0; i < weights.size(); ++i) scaled[i] = weights[i] * scale;
  bins_.resize(weights.size());
  pair(scaled);
  countProbabilities();
}

/// Vose's pairing: every bin below average is filled up by one above it. scaled: weights of mean 1, used up.
void AliasTable::pair(std::vector<double>& scaled) {
  std::vector<std::uint32_t> small, large;
  small.reserve(scaled.size());
  for (std::uint32_t i = 0; i < scaled.size(); ++i) (scaled[i] < 1 ? small : large).push_back(i);
  const auto heaviest = static_cast<std::uint32_t>(std::max_element(scaled.begin(), scaled.end()) - scaled.begin());
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back(), l = large.back();
    small.pop_back();
    settle(s, scaled[s], l);
    scaled[l] -= 1 - scaled[s];
    if (scaled[l] < 1) {
      large.pop_back();
      small.push_back(l);
    }
  }
  for (std::uint32_t l : large) settle(l, 1, l);
  // Only rounding leaves a small bin without partner; an entry of weight 0 must not inherit the rest.
  for (std::uint32_t s : small) settle(s, scaled[s] > 0 ? 1 : 0, heaviest);
}

/// keep in [0, 1] is rounded up to a multiple of 2^-32, so that no positive weight vanishes.
void AliasTable::settle(std::uint32_t bin, double keep, std::uint32_t alias) {
  const double count = std::ceil(std::clamp(keep, 0.0, 1.0) * 0x1p32);
  const bool whole = count >= 0x1p32;
  bins_[bin].alias = whole ? bin : alias;
  bins_[bin].keep = whole ? 0xffffffffu : static_cast<std::uint32_t>(count);
}

void AliasTable::countProbabilities() {
  std::vector<double> counts(bins_.size(), 0.0);
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    counts[i] += bins_[i].keep;
    counts[bins_[i].alias] += 0x1p32 - bins_[i].keep;
  }
  const double scale = 0x1p-32 / static_cast<double>(bins_.size());
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i].probability = static_cast<float>(counts[i] * scale);
}

}  // namespace core
