// Sampling an index in proportion to weights, in constant time.
// Source: Walker 1977; Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution" (1991).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace core {

/// Built in O(n), deterministic; entries of weight 0 are never drawn.
class AliasTable {
 public:
  AliasTable() = default;
  /// weights: finite, >= 0. All zero (or empty) gives an empty table.
  explicit AliasTable(std::span<const float> weights);

  bool empty() const { return bins_.empty(); }
  std::size_t size() const { return bins_.size(); }
  /// u uniform in [0, 1); 32 random bits choose the bin so that tables beyond 2^24 entries are drawn from fully.
  std::uint32_t sample(std::uint32_t bits, float u) const {
    const auto bin = static_cast<std::uint32_t>((std::uint64_t{bits} * bins_.size()) >> 32);
    return u < bins_[bin].keep ? bin : bins_[bin].alias;
  }
  /// Probability of index i.
  float probability(std::uint32_t i) const { return bins_[i].probability; }

 private:
  struct Bin {
    float keep, probability;
    std::uint32_t alias;
  };
  std::vector<Bin> bins_;
};

}  // namespace core
