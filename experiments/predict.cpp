#include "experiments/predict.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>

#include "core/maths.h"
#include "experiments/json_text.h"
#include "twohistory/combination.h"

namespace experiments {

using twohistory::Weighting;

namespace {

constexpr double kFewest = 1e-6, kMost = 1e9;  ///< samples in one frame, beyond 0

constexpr int kFrames = 0, kSamples = 1;  ///< histories of the pair
int historyOf(Weighting w) { return w == Weighting::frames ? kFrames : kSamples; }

/// The decimal number that a word is; NaN where it is none.
double numberIn(const std::string& word) {
  double x = core::kNaN;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  return error == std::errc() && end == word.data() + word.size() ? x : core::kNaN;
}

double parseCount(const std::string& word, const std::string& where) {
  const double n = numberIn(word);
  if (n == 0 || (n >= kFewest && n <= kMost)) return std::abs(n);
  throw core::UsageError(where, fmt::format("\"{}\" is not a sample count", word.substr(0, 40)),
                         fmt::format("give 0 or numbers from {:g} to {:g}", kFewest, kMost));
}

}  // namespace

double parseDecay(const std::string& text, const std::string& where) {
  const double decay = numberIn(text);
  if (decay >= 0 && decay <= 1) return decay;
  throw core::UsageError(where, fmt::format("\"{}\" is not a number in [0, 1]", text.substr(0, 40)),
                         "give the share kept every frame");
}

Prediction::Prediction(double decay) : decay_(decay) { CHECK(decay >= 0 && decay <= 1); }

void Prediction::advance(double n) {
  const double fresh[] = {twohistory::freshWeight(Weighting::frames, n),
                          twohistory::freshWeight(Weighting::samples, n)};
  twohistory::Advance<2, double> change;
  for (int j = 0; j < 2; ++j) {
    change.fresh[j] = fresh[j];
    change.factor[j] = twohistory::forgetFactor(twohistory::Forgetting::decay, decay_, ledger_.weight[j], fresh[j]);
  }
  ledger_ = twohistory::advance(ledger_, change, n);
}

double Prediction::weight(Weighting w) const { return ledger_.weight[historyOf(w)]; }

double Prediction::powerSum(int exponent) const {
  CHECK(exponent >= -1 && exponent <= 1);
  // C_uu = S_-1, C_uw = S_0, C_ww = S_1 [ledger 3].
  constexpr std::array<int, 3> pairs{twohistory::pairIndex<2>(kFrames, kFrames),
                                     twohistory::pairIndex<2>(kFrames, kSamples),
                                     twohistory::pairIndex<2>(kSamples, kSamples)};
  return ledger_.powerSums[pairs[exponent + 1]];
}

/// Weights so small that their squares vanish in double precision count as 0.
bool Prediction::known() const {
  return ledger_.covariance(kFrames, kFrames) > 0 && ledger_.covariance(kSamples, kSamples) > 0;
}

double Prediction::age(Weighting w) const { return weight(w) > 0 ? ledger_.age(historyOf(w)) : core::kNaN; }

double Prediction::blendWeight() const {
  return known() ? twohistory::leastVarianceWeight(twohistory::pairOf(ledger_, kFrames, kSamples)) : core::kNaN;
}

double Prediction::variance(Weighting w) const {
  return known() ? ledger_.covariance(historyOf(w), historyOf(w)) : core::kNaN;
}

double Prediction::blendVariance() const {
  return known() ? twohistory::pairOf(ledger_, kFrames, kSamples).blend(blendWeight()) : core::kNaN;
}

Json predictionJson(const Prediction& p, double n) {
  constexpr auto frames = Weighting::frames, samples = Weighting::samples;
  Json json;
  json["n"] = n == std::floor(n) ? Json(static_cast<std::int64_t>(n)) : Json(n);
  json["weight"] = {{"frames", p.weight(frames)}, {"samples", p.weight(samples)}};
  json["power_sums"] = {{"-1", p.powerSum(-1)}, {"0", p.powerSum(0)}, {"1", p.powerSum(1)}};
  json["age"] = {{"frames", numberOrNull(p.age(frames))}, {"samples", numberOrNull(p.age(samples))}};
  json["p"] = numberOrNull(p.blendWeight());
  json["variance"] = {{"unweighted", numberOrNull(p.variance(frames))},
                      {"weighted", numberOrNull(p.variance(samples))},
                      {"blend", numberOrNull(p.blendVariance())}};
  return json;
}

std::vector<double> parseCounts(const std::string& text, const std::string& where) {
  std::vector<double> counts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    std::istringstream field(text.substr(begin, end - begin));
    const std::size_t before = counts.size();
    for (std::string word; field >> word;) counts.push_back(parseCount(word, where));
    if (counts.size() == before)
      throw core::UsageError(where, "holds no sample count where one should be", "give a list such as 1,1,8,0,1");
    begin = end + 1;
  }
  return counts;
}

}  // namespace experiments
