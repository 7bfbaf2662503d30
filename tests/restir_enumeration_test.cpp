// The tiny world without chance: every draw and every choice enumerated with its probability, so that the expectation
// of each way to merge is exact but for float's rounding. Unbiased modes give the light that is there to 1e-6, constant
// weights what their closed form predicts.
#include "tests/tiny_world.h"

namespace {

using namespace tests::tiny;

constexpr double kRounding = 1e-6;  // relative: weights are kept in float

struct Outcome {
  double probability;
  Reservoir reservoir;
};
/// All reservoirs that may come of something; probabilities sum to 1.
using Outcomes = std::vector<Outcome>;

/// Adds an outcome to those that are the same reservoir.
void addTo(Outcomes& outcomes, double probability, const Reservoir& r) {
  for (Outcome& o : outcomes)
    if (o.reservoir.sample.light == r.sample.light && o.reservoir.unbiasedWeight == r.unbiasedWeight) {
      o.probability += probability;
      return;
    }
  outcomes.push_back({probability, r});
}

struct Candidate {
  LightSample y;
  float target;
  double weight;
};

/// Calls body(probability, reservoir) for everything that the stream of candidates may choose, in proportion to their
/// weights. factor(y, target): on W of the chosen one.
template <class Factor, class Body>
void forEachChoice(const std::vector<Candidate>& candidates, float confidence, Factor&& factor, Body&& body) {
  double sum = 0;
  for (const Candidate& c : candidates) sum += c.weight;
  if (!(sum > 0)) return body(1.0, Reservoir{{}, 0, confidence, 0});
  for (const Candidate& c : candidates)
    if (c.weight > 0)
      body(c.weight / sum, Reservoir{c.y, static_cast<float>(factor(c.y, c.target) * sum / c.target), confidence, 0});
}

/// What `count` candidates of a target give. Where sees: hidden samples then become null, as with targets that include
/// visibility.
Outcomes freshOutcomes(const Table& target, int count, const Table& sees) {
  Outcomes outcomes;
  std::vector<Candidate> candidates(count);
  for (int draws = 0; draws < 1 << (2 * count); ++draws) {  // two bits a candidate
    double probability = 1;
    for (int i = 0; i < count; ++i) {
      const LightSample y{static_cast<std::uint32_t>(draws >> (2 * i)) % kLights, {}};
      probability *= kPower[y.light];
      candidates[i] = {y, target(y), candidateWeight(target, y, count)};
    }
    const auto one = [](const LightSample&, float) { return 1.0; };
    forEachChoice(candidates, static_cast<float>(count), one, [&](double p, Reservoir r) {
      if (r.unbiasedWeight > 0 && sees(r.sample) == 0) r = {{}, 0, r.confidence, 0};
      addTo(outcomes, probability * p, r);
    });
  }
  return outcomes;
}

struct Input {
  Outcomes outcomes;
  Table target;
};

/// Calls body(probability, sources) for every combination of the inputs' outcomes.
template <class Body>
void forEachCombination(const std::vector<Input>& inputs, Body&& body) {
  std::vector<std::size_t> at(inputs.size());
  std::vector<Source> sources(inputs.size());
  for (std::size_t i = 0; i < at.size();) {
    double probability = 1;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      const Outcome& o = inputs[k].outcomes[at[k]];
      sources[k] = {o.reservoir, inputs[k].target};
      probability *= o.probability;
    }
    body(probability, std::span<const Source>(sources));
    for (i = 0; i < at.size() && ++at[i] == inputs[i].outcomes.size(); ++i) at[i] = 0;
  }
}

/// Calls body(probability, reservoir) for everything that a merge may choose from these sources, and checks that what
/// the library's own stream chooses is among it.
template <class Body>
void forEachMerge(std::span<const Source> sources, Mis mis, Body&& body) {
  std::vector<Candidate> candidates;
  restir::forEachWeighted<Table>(sources, mis, [&](const LightSample& y, float target, double weight) {
    candidates.push_back({y, target, target * weight});
  });
  core::Rng rng(1, core::Pass::lab, 0, 0);
  const Reservoir chosen = restir::mergeReservoirs<Table>(sources, mis, 0, rng);
  bool among = false;
  const auto factor = [&](const LightSample& y, float target) {
    return restir::normalisation(mis, sources, y, target);
  };
  forEachChoice(candidates, restir::sumConfidence(sources), factor, [&](double p, const Reservoir& r) {
    among |= r.sample.light == chosen.sample.light && r.unbiasedWeight == chosen.unbiasedWeight &&
             r.confidence == chosen.confidence;
    body(p, r);
  });
  EXPECT_TRUE(among);
}

Outcomes mergedOutcomes(const std::vector<Input>& inputs, Mis mis) {
  Outcomes outcomes;
  forEachCombination(inputs, [&](double probability, std::span<const Source> sources) {
    forEachMerge(sources, mis, [&](double p, const Reservoir& r) { addTo(outcomes, probability * p, r); });
  });
  return outcomes;
}

/// Expectations of a pixel's light: of the sample that a merge chooses, and of all of them shaded in its place.
struct Expected {
  double chosen = 0, all = 0;
};
Expected expectedOf(int pixel, const std::vector<Input>& inputs, Mis mis) {
  Expected e;
  forEachCombination(inputs, [&](double probability, std::span<const Source> sources) {
    forEachMerge(sources, mis,
                 [&](double p, const Reservoir& r) { e.chosen += probability * p * shadePixel(pixel, r); });
    restir::forEachMerged<Table>(sources, mis, [&](const LightSample& y, float weight) {
      e.all += probability * shadePixel(pixel, {y, weight, 1, 0});
    });
  });
  return e;
}

/// Who saw which light in the frame before: an occluder moves.
constexpr std::array<Table, kPixels> kSaw{{{{1, 1, 0, 1}}, {{0, 0, 1, 1}}, {{1, 1, 1, 0}}}};

/// Targets, with visibility or without, and what may be merged.
struct World {
  bool visibility;

  Table target(const Table& unshadowed, const Table& sees) const {
    Table t = unshadowed;
    for (int y = 0; y < kLights && visibility; ++y) t.values[y] *= sees.values[y];
    return t;
  }
  Table now(int q) const { return target(kNow[q], kSees[q]); }
  Table before(int q) const { return target(kBefore[q], kSaw[q]); }

  Outcomes freshOf(const Table& unshadowed, const Table& sees, int count) const {
    return freshOutcomes(unshadowed, count, visibility ? sees : Table{{1, 1, 1, 1}});
  }
  std::vector<Input> inTime(int q, int countNow, int countBefore) const {
    return {{freshOf(kNow[q], kSees[q], countNow), now(q)}, {freshOf(kBefore[q], kSaw[q], countBefore), before(q)}};
  }
  template <class OutcomesOf>
  std::vector<Input> inSpace(int pixel, OutcomesOf&& outcomesOf) const {
    std::vector<Input> inputs{{outcomesOf(pixel), now(pixel)}};
    for (int q = 0; q < kPixels; ++q)
      if (q != pixel) inputs.push_back({outcomesOf(q), now(q)});
    return inputs;
  }
};

/// How often, in the mean, a reservoir with constant weights counts each light.
using Shares = std::array<double, kLights>;
Shares sharesOf(const Table& target) {
  Shares shares{};
  for (int y = 0; y < kLights; ++y) shares[y] = target.values[y] > 0;
  return shares;
}
/// Of inputs (confidence, shares), merged for a target.
Shares sharesOf(const Table& target, const std::vector<std::pair<double, Shares>>& inputs) {
  Shares shares{};
  double confidence = 0;
  for (const auto& [c, its] : inputs) {
    confidence += c;
    for (int y = 0; y < kLights; ++y) shares[y] += c * its[y] * (target.values[y] > 0);
  }
  for (double& s : shares) s /= confidence;
  return shares;
}
double lightOf(int pixel, const Shares& shares) {
  double sum = 0;
  for (int y = 0; y < kLights; ++y) sum += shares[y] * double(kNow[pixel].values[y]) * kSees[pixel].values[y];
  return sum;
}

class Enumerated : public testing::TestWithParam<std::tuple<Mis, bool>> {
 protected:
  const Mis mis_ = std::get<Mis>(GetParam());
  const World world_{std::get<bool>(GetParam())};

  /// predicted: by constant weights. Returns whether those are biased there by more than kLeastBias.
  bool expectLight(int pixel, const std::vector<Input>& inputs, const Shares& predicted) const {
    const Expected e = expectedOf(pixel, inputs, mis_);
    const double truth = exact(pixel), constant = lightOf(pixel, predicted);
    const double light = mis_ == Mis::constant ? constant : truth;
    EXPECT_NEAR(e.chosen, light, kRounding * truth) << pixel;
    EXPECT_NEAR(e.all, light, kRounding * truth) << pixel;
    return constant < (1 - kLeastBias) * truth;
  }
};

TEST_P(Enumerated, InTime) {
  int lost = 0;  // pixels whose constant weights lose light: without V, what two of them see they saw before
  for (int p = 0; p < kPixels; ++p)
    lost += expectLight(p, world_.inTime(p, 2, 5),
                        sharesOf(world_.now(p), {{2, sharesOf(world_.now(p))}, {5, sharesOf(world_.before(p))}}));
  EXPECT_EQ(lost, world_.visibility ? 3 : 1);
}

TEST_P(Enumerated, InSpace) {
  for (int p = 0; p < kPixels; ++p) {
    std::vector<std::pair<double, Shares>> shares;
    for (int q = 0; q < kPixels; ++q) shares.push_back({1 + q, sharesOf(world_.now(q))});
    const auto outcomesOf = [&](int q) { return world_.freshOf(kNow[q], kSees[q], 1 + q); };
    EXPECT_TRUE(expectLight(p, world_.inSpace(p, outcomesOf), sharesOf(world_.now(p), shares)));
  }
}

TEST_P(Enumerated, InTimeAndSpace) {
  for (int p = 0; p < kPixels; ++p) {
    std::vector<std::pair<double, Shares>> shares;
    for (int q = 0; q < kPixels; ++q) {
      const auto now = sharesOf(world_.now(q)), before = sharesOf(world_.before(q));
      shares.push_back({3, sharesOf(world_.now(q), {{1, now}, {2, before}})});
    }
    const auto outcomesOf = [&](int q) { return mergedOutcomes(world_.inTime(q, 1, 2), mis_); };
    EXPECT_TRUE(expectLight(p, world_.inSpace(p, outcomesOf), sharesOf(world_.now(p), shares)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    TinyWorld, Enumerated,
    testing::Combine(testing::Values(Mis::constant, Mis::contribution, Mis::balance, Mis::pairwise), testing::Bool()));

}  // namespace
