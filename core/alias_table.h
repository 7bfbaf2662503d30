// Sampling an index in proportion to weights, in constant time.
// Source: Walker 1977; Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution" (1991).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace core {

/// Built in O(n), deterministic; entries of weight 0 are never drawn, all others can be.
///
/// Bins hold whole numbers out of 2^32, and probability() is what those numbers give, not what the weights asked for:
/// rounding costs nothing in bias, even for weights many decades apart.
class AliasTable {
 public:
  AliasTable() = default;
  /// weights: finite, >= 0, fewer than 2^32. All zero (or empty) gives an empty table.
  explicit AliasTable(std::span<const float> weights);

  bool empty() const { return bins_.empty(); }
  std::size_t size() const { return bins_.size(); }
  /// binBits choose the bin, keepBits whether its own index or its alias; 32 random bits each.
  std::uint32_t sample(std::uint32_t binBits, std::uint32_t keepBits) const {
    const auto bin = static_cast<std::uint32_t>((std::uint64_t{binBits} * bins_.size()) >> 32);
    return keepBits < bins_[bin].keep ? bin : bins_[bin].alias;
  }
  /// Probability of index i.
  float probability(std::uint32_t i) const { return bins_[i].probability; }

 private:
  struct Bin {
    std::uint32_t keep = 0;   ///< how many keepBits of 2^32 return the bin's own index
    std::uint32_t alias = 0;  ///< the others return this; the bin's own index where it is always returned
    float probability = 0;
  };
  void pair(std::vector<double>& scaled);
  void settle(std::uint32_t bin, double keep, std::uint32_t alias);
  void countProbabilities();

  std::vector<Bin> bins_;
};

}  // namespace core
