#include "experiments/variant.h"

#include <algorithm>
#include <cctype>

#include "core/check.h"

namespace experiments {
namespace {

using twohistory::BlendMode;
using twohistory::BlendParameters;
using twohistory::Forgetting;
using twohistory::NoiseEstimate;
using twohistory::Policy;
using twohistory::Weighting;

Policy frames(double decay) { return {Weighting::frames, Forgetting::decay, decay}; }
Policy samples(double decay) { return {Weighting::samples, Forgetting::decay, decay}; }

Variant make(const char* name, std::vector<Policy> histories, BlendMode mode = BlendMode::first) {
  Variant v;
  v.name = name;
  v.histories = std::move(histories);
  v.blend.mode = mode;
  return v;
}

Variant lag(const char* name, std::vector<Policy> histories, float lowest, float highest, NoiseEstimate noise) {
  Variant v = make(name, std::move(histories), BlendMode::lag);
  v.blend.lowest = lowest;
  v.blend.highest = highest;
  v.blend.noise = noise;
  return v;
}

std::vector<Variant>& extensions() {
  static std::vector<Variant> all;
  return all;
}

/// Lag regression over U, W and F. A blend whose lag is taken away can afford a longer W and profits from a faster F;
/// if no history weighs samples, none lags less where there are more of them, so that no step of the mean shows where
/// counts change.
std::vector<Variant> threeHistories(const Policy& u, const Policy& w, const Policy& f) {
  Variant all = lag("lag-uwf", {u, w, f}, -0.5f, 1.5f, NoiseEstimate::safe);
  all.blend.mode = BlendMode::lagAll;
  all.blend.pair = {0, 2};
  Variant checked = all;
  checked.name = "lag-checked";
  checked.blend.validation.on = true;
  Variant bold = checked;
  bold.name = "lag-bold";
  bold.histories[1] = samples(0.97);
  Variant debiased = checked;
  debiased.name = "lag-debiased";
  debiased.histories = {u, samples(0.98), samples(0.6)};
  debiased.blend.correction = 1;
  Variant even = debiased;
  even.name = "lag-even";
  even.histories = {u, frames(0.98), frames(0.5)};
  even.blend.validation.agreement = 0.1f;
  return {all, checked, bold, debiased, even};
}

/// U (0.95, frames), W (0.95, samples): the slides' pair. F (0.8, samples): the fast one.
std::vector<Variant> ownLibrary() {
  const Policy u = frames(0.95), w = samples(0.95), f = samples(0.8);
  std::vector<Variant> own{make("none", {frames(0)}),
                           make("unweighted", {u}),
                           make("unweighted-96", {frames(0.96)}),
                           make("unweighted-98", {frames(0.98)}),
                           make("weighted", {w}),
                           make("published", {u, w}, BlendMode::published),
                           make("optimal", {u, w}, BlendMode::optimal),
                           make("optimal-uwf", {u, w, f}, BlendMode::optimalAll),
                           make("seed", {u, w}, BlendMode::seed),
                           make("seed-slide", {u, w}, BlendMode::seedSlide),
                           make("consistent", {u, w}, BlendMode::consistent),
                           lag("lag-uw", {u, w}, -0.5f, 1.5f, NoiseEstimate::predicted),
                           lag("lag-wf", {w, f}, -0.5f, 1.5f, NoiseEstimate::predicted),
                           lag("lag-safe", {u, f}, -0.5f, 1.0f, NoiseEstimate::safe)};
  for (const Variant& v : threeHistories(u, w, f)) own.push_back(v);
  own.push_back(make("oracle", {u, w}, BlendMode::oracle));
  return own;
}

std::vector<Variant> library() {
  std::vector<Variant> all = ownLibrary();
  all.insert(all.end(), extensions().begin(), extensions().end());
  return all;
}

}  // namespace

Extension::Extension(Variant variant) { extensions().push_back(std::move(variant)); }

std::vector<std::string> variantNames() {
  std::vector<std::string> names;
  for (const Variant& v : library()) names.push_back(v.name);
  return names;
}

Variant variantByName(const std::string& name) {
  std::string known;
  for (const Variant& v : library()) {
    if (v.name == name) return v;
    known += (known.empty() ? "" : ", ") + v.name;
  }
  throw core::UsageError("variant '" + name + "'", "there is none of that name", "use one of " + known);
}

void requireConsistent(const Variant& v) {
  const auto fail = [&](const std::string& what, const std::string& remedy) {
    throw core::UsageError("variant '" + v.name + "'", what, remedy);
  };
  const bool plain = std::all_of(v.name.begin(), v.name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_' || c == '.' || c == '+';
  });
  if (v.name.empty() || !plain || v.name.front() == '.')
    fail("its name cannot name files", "use letters, digits, - _ + . and do not begin with a dot");
  if (v.histories.empty() || v.histories.size() > 3)
    fail(std::to_string(v.histories.size()) + " histories", "give one, two or three");
  for (const Policy& p : v.histories)
    if (p.weighting == Weighting::custom && !p.weight)
      fail("a custom weighting without a function", "start from an extension's variant; see docs/extending.md");
  if (v.blend.mode == BlendMode::custom && !v.blend.custom)
    fail("a custom blend without a function", "start from an extension's variant; see docs/extending.md");
  for (const Policy& p : v.histories)
    if (p.forgetting == Forgetting::decay && p.amount > 1)
      fail("a decay of " + std::to_string(p.amount), "a decay lies in [0, 1]");
  const int count = static_cast<int>(v.histories.size());
  const bool pairs = twohistory::usesPair(v.blend.mode);
  if (v.blend.pair[0] >= count || (pairs && v.blend.pair[1] >= count))
    fail("its blend names a history that it does not have", "blend.first and blend.second count histories from 0");
  if (v.blend.correction > 0 && v.blend.mode != BlendMode::lagAll)
    fail("a correction without an estimate of lag", "give blend.mode lagAll, or blend.correction 0");
  if (pairs && v.blend.pair[0] == v.blend.pair[1]) fail("it blends a history with itself", "name two histories");
}

}  // namespace experiments
