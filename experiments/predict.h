// What a history of given sample counts would know, without rendering: weights, power sums, ages, the least-variance
// blend and its variance, for the slides' pair (one decay, weighted by frames and by samples). [Tu24]
#pragma once

#include <string>
#include <vector>

#include "experiments/settings.h"
#include "twohistory/ledger.h"

namespace experiments {

/// The two histories of one pixel, followed in double precision.
class Prediction {
 public:
  /// decay in [0, 1].
  explicit Prediction(double decay);
  /// One frame of n >= 0 samples.
  void advance(double n);

  double weight(twohistory::Weighting w) const;
  /// S_exponent, exponent -1, 0 or 1.
  double powerSum(int exponent) const;
  /// Mean age in frames; NaN while the weight is 0.
  double age(twohistory::Weighting w) const;
  /// p: least-variance weight of the frames history, in [0, 1]; NaN while the weight is 0.
  double blendWeight() const;
  /// Predicted variances in units of one sample's; NaN while the weight is 0.
  double variance(twohistory::Weighting w) const;
  double blendVariance() const;

 private:
  bool known() const;
  double decay_;
  twohistory::Ledger<2, double> ledger_;
};

/// The frame just advanced to, as `twofold predict` prints it; numbers that are not known are null.
Json predictionJson(const Prediction& prediction, double n);

/// A decay in [0, 1], as a decimal number and nothing else. Throws core::UsageError that starts with `where`.
double parseDecay(const std::string& text, const std::string& where);

/// Counts separated by commas, spaces or lines (nothing between two commas is an error): each 0 or within [1e-6, 1e9].
/// Throws core::UsageError that starts with `where`.
std::vector<double> parseCounts(const std::string& text, const std::string& where);

}  // namespace experiments
