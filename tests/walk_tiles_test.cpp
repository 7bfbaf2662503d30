// Predicted variances by the walk that a reference history makes beside every tile, and by the last frame's counts,
// against exact covariances in the plane; and what both remember.
#include "twohistory/walk_tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "core/random.h"
#include "twohistory/history.h"
#include "twohistory/mean.h"
#include "twohistory/sample_counts.h"
#include "twohistory/walk_memory.h"

namespace {

using core::vec2;
using twohistory::Forgetting;
using twohistory::Ledger;
using twohistory::Policy;
using twohistory::SampleCounts;
using twohistory::TapPairs;
using twohistory::Taps;
using twohistory::WalkMemory;
using twohistory::WalkTiles;
using twohistory::Weighting;

constexpr int kSize = 64;

/// Taps of a pixel whose content came from so far to the left and above; what comes from beyond the edge has none.
Taps from(int x, int y, vec2 moved) {
  const vec2 p = vec2(x, y) - moved;
  const int i = static_cast<int>(std::floor(p.x)), j = static_cast<int>(std::floor(p.y));
  const float a = p.x - static_cast<float>(i), b = p.y - static_cast<float>(j);
  if (i < 0 || j < 0 || i + (a > 0) >= kSize || j + (b > 0) >= kSize) return {};
  const std::int32_t corner = j * kSize + i, right = a > 0 ? 1 : 0, below = b > 0 ? kSize : 0;
  return {{corner, corner + right, corner + below, corner + right + below},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
}

core::Image<Taps> tapsOf(const std::function<vec2(int, int)>& moved) {
  core::Image<Taps> taps(kSize, kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) taps(x, y) = from(x, y, moved(x, y));
  return taps;
}
core::Image<Taps> tapsOf(vec2 moved) {
  return tapsOf([=](int, int) { return moved; });
}

SampleCounts countsOf(const core::Image<float>& n) {
  SampleCounts counts(n.width(), n.height());
  counts.update(n);
  return counts;
}
const SampleCounts& oneEach() {
  static const SampleCounts counts = countsOf(core::Image<float>(kSize, kSize, 1));
  return counts;
}

/// One frame: how far the image moves, and how many samples every pixel has.
struct Frame {
  vec2 moved{0};
  float n = 1;
};
using Course = std::vector<Frame>;

/// Exact variance of a history of samples of variance 1, where all pixels of a boundless image have the same counts:
/// the recursion of covariances of pixels i, j apart (docs/history.md, "How alike neighbours are").
double exactVariance(const Course& course, const Policy& policy) {
  constexpr int kReach = 24, kSide = 2 * kReach + 1;
  std::vector<double> now(kSide * kSide, 0.0), half = now;
  const auto at = [](int i, int j) { return static_cast<std::size_t>(j * kSide + i); };
  const auto stepOf = [](float m) {
    const double f = double(m) - std::floor(double(m));
    return 2 * f * (1 - f);
  };
  double weight = 0;
  for (const Frame& frame : course) {
    const double sx = stepOf(frame.moved.x), sy = stepOf(frame.moved.y), w = freshWeight(policy, double(frame.n));
    for (int j = 0; j < kSide; ++j)
      for (int i = 1; i < kSide - 1; ++i)
        half[at(i, j)] = (1 - sx) * now[at(i, j)] + sx / 2 * (now[at(i - 1, j)] + now[at(i + 1, j)]);
    for (int j = 1; j < kSide - 1; ++j)
      for (int i = 0; i < kSide; ++i)
        now[at(i, j)] = policy.amount * policy.amount *
                        ((1 - sy) * half[at(i, j)] + sy / 2 * (half[at(i, j - 1)] + half[at(i, j + 1)]));
    now[at(kReach, kReach)] += frame.n > 0 ? w * w / double(frame.n) : 0;
    weight = policy.amount * weight + w;
  }
  return now[at(kReach, kReach)] / (weight * weight);
}

/// Controls: who has no memory of walks, and who knows only this frame's counts.
struct NoMemory : twohistory::LikelySteps<float> {
  NoMemory(int, int) {}
  void update(core::In<Taps>, core::In<float>) {}
};
struct ThisFramesCounts : WalkMemory {
  using WalkMemory::WalkMemory;
  struct Walk : twohistory::RememberedWalk {
    float freshNoise(const Policy& policy, float n) const { return twohistory::freshNoise(policy, n); }
  };
  Walk operator()(const Taps& taps, const TapPairs& pairs) const { return {WalkMemory::operator()(taps, pairs)}; }
};

/// Whose references have one sample in every frame, as if counts never changed.
struct UniformReferences {
  int width;
  WalkTiles walks;
  SampleCounts counts, ones;
  UniformReferences(int w, int h) : width(w), walks(w, h), counts(w, h), ones(countsOf(core::Image<float>(w, h, 1))) {}
  twohistory::RememberedWalk operator()(const Taps& taps, const TapPairs&) const {
    twohistory::RememberedWalk walk{walks.at(taps.pixel[0]), taps.b, {}, {}};
    for (int k = 0; k < 4; ++k) walk.counts[k] = counts.at(taps.pixel[k]);
    return walk;
  }
  void update(core::In<Taps> taps, core::In<float> n) { counts.update(n), walks.update(taps, ones); }
};

/// Whose walks are as long as their tile's, however young they are.
struct AsOldAsTheTile : WalkMemory {
  using WalkMemory::WalkMemory;
  struct Walk : twohistory::RememberedWalk {
    twohistory::OlderNoise<float> older(const TapPairs& p, const twohistory::Remembered<float>& h, float fresh) const {
      return RememberedWalk::older(p, {h.weight, 1e9f * h.weight, h.factor}, fresh);
    }
  };
  Walk operator()(const Taps& taps, const TapPairs& pairs) const { return {WalkMemory::operator()(taps, pairs)}; }
};

/// The library's prediction well inside the image. Memory: WalkMemory, or a control. hidden: frames after which all
/// pixels lose their histories, as what comes out from behind something; the tiles know nothing of it.
template <class Memory>
double predictedVariance(const Course& course, const Policy& policy, std::size_t hidden = 0) {
  const twohistory::Policies<1> policies{policy};
  core::Image<Ledger<1>> before(kSize, kSize), now = before;
  Memory memory(kSize, kSize);
  for (const Frame& frame : course) {
    if (hidden > 0 && &frame == &course[hidden]) before = core::Image<Ledger<1>>(kSize, kSize);
    const core::Image<Taps> taps = tapsOf(frame.moved);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        now(x, y) = advance(gather<1, float>(taps(x, y), before, policies, frame.n, memory), policies, frame.n);
    memory.update(taps, core::Image<float>(kSize, kSize, frame.n));
    std::swap(before, now);
  }
  return static_cast<double>(before(kSize - 24, kSize - 24).covariance(0, 0));
}

/// Exact over predicted variance over many courses.
struct Range {
  double low = 9, high = 0;
  void add(double ratio) { low = std::min(low, ratio), high = std::max(high, ratio); }
};

template <class Memory>
Range rangeOf(const std::vector<Course>& courses, const std::vector<Policy>& policies) {
  Range range;
  for (const Course& course : courses)
    for (const Policy& p : policies) range.add(exactVariance(course, p) / predictedVariance<Memory>(course, p));
  return range;
}

Course courseOf(int rest, int motion, int after, vec2 moved) {
  Course course(static_cast<std::size_t>(rest));
  course.insert(course.end(), static_cast<std::size_t>(motion), {moved});
  course.resize(course.size() + static_cast<std::size_t>(after));
  return course;
}

const std::vector<Policy> kDecays{{Weighting::frames, Forgetting::decay, 0.5},
                                  {Weighting::frames, Forgetting::decay, 0.8},
                                  {Weighting::frames, Forgetting::decay, 0.95},
                                  {Weighting::frames, Forgetting::decay, 0.98}};
const std::vector<Policy> kLongDecays{{Weighting::frames, Forgetting::decay, 0.995},
                                      {Weighting::frames, Forgetting::decay, 1}};

TEST(ReferenceWalk, PredictsVariancesOfMotionThatBeginsKeepsOnAndEnds) {
  std::vector<Course> courses;
  for (const vec2 moved : {vec2(0.05f), vec2(0.2f), vec2(0.5f), vec2(0.5f, 0), vec2(0, 0.2f), vec2(0.5f, 0.1f)})
    for (const int frames : {1, 2, 4, 12, 30}) {
      courses.push_back(courseOf(40, frames, 0, moved));
      if (frames > 4) courses.push_back(courseOf(1, frames, 6, moved));
    }
  core::Rng rng(3, core::Pass::lab, 0, 0);
  Course wanders(1), byTurns(1);
  for (int f = 0; f < 40; ++f) {
    wanders.push_back({2.0f * rng.uniform2() - 1.0f});
    byTurns.push_back({f % 2 ? vec2(0) : vec2(0.5f)});
  }
  courses.push_back(wanders), courses.push_back(byTurns);
  const Range ours = rangeOf<WalkMemory>(courses, kDecays);
  const Range guessed = rangeOf<NoMemory>(courses, kDecays);  // control
  std::printf("exact over predicted: %.3f .. %.3f; by a guess of steps %.3f .. %.3f\n", ours.low, ours.high,
              guessed.low, guessed.high);
  EXPECT_GT(ours.low, 0.93);
  EXPECT_LT(ours.high, 1.05);
  const Range longer = rangeOf<WalkMemory>(courses, kLongDecays);
  std::printf("of longer memories: %.3f .. %.3f\n", longer.low, longer.high);
  EXPECT_GT(longer.low, 0.88);
  EXPECT_LT(longer.high, 1.12);
  EXPECT_LT(guessed.low, 0.7);
  EXPECT_GT(guessed.high, 1.1);
}

/// Counts that were `from` and are `to` in the last `since` of 40 frames of motion.
Course courseOfJump(vec2 moved, float from, float to, int since) {
  Course course = courseOf(1, 39, 0, moved);
  for (std::size_t f = 0; f < course.size(); ++f)
    course[f].n = f + static_cast<std::size_t>(since) < course.size() ? from : to;
  return course;
}

TEST(ReferenceWalk, PredictsVariancesWhereCountsHaveJumpedEverywhere) {
  std::vector<Course> jumps, pauses, blinks;
  for (const vec2 moved : {vec2(0.2f), vec2(0.5f), vec2(0.5f, 0)})
    for (const int since : {1, 5, 12, 24}) {
      jumps.push_back(courseOfJump(moved, 8, 1, since)), jumps.push_back(courseOfJump(moved, 1, 8, since));
      pauses.push_back(courseOfJump(moved, 1, 0, since)), blinks.push_back(pauses.back());
      if (since > 5)  // nothing for five frames, and then again
        for (auto frame = blinks.back().end() - since + 5; frame != blinks.back().end(); ++frame) frame->n = 1;
    }
  const std::vector<Policy> policies{
      {Weighting::frames, Forgetting::decay, 0.95},
      {Weighting::samples, Forgetting::decay, 0.95},
      {Weighting::frames, Forgetting::decay, 0.98},
      {Weighting::samples, Forgetting::decay, 0.98},
      {Weighting::custom, Forgetting::decay, 0.98, [](double n) { return std::sqrt(n); }}};
  const auto print = [](const char* who, const Range& range) {
    std::printf("exact over predicted, %s: %.3f .. %.3f\n", who, range.low, range.high);
    return range;
  };
  const Range ours = print("counts jump", rangeOf<WalkMemory>(jumps, policies));
  EXPECT_GT(ours.low, 0.93);
  EXPECT_LT(ours.high, 1.07);
  const Range none = print("no samples any more", rangeOf<WalkMemory>(pauses, policies));
  EXPECT_GT(none.low, 0.9);
  EXPECT_LT(none.high, 1.2);
  const Range again = print("and again", rangeOf<WalkMemory>(blinks, policies));
  EXPECT_GT(again.low, 0.9);
  EXPECT_LT(again.high, 1.2);
  const std::vector<Policy> one{policies[2]};
  EXPECT_LT(print("control: by this frame's counts", rangeOf<ThisFramesCounts>(jumps, one)).low, 0.75);
  EXPECT_GT(print("control: uniform references", rangeOf<UniformReferences>(jumps, one)).high, 1.35);
  EXPECT_GT(print("control: the same without samples", rangeOf<UniformReferences>(pauses, one)).high, 3);
}

TEST(ReferenceWalk, PredictsVariancesOfWhatHasJustComeOutFromBehindSomething) {
  Range ours, control;
  for (const vec2 moved : {vec2(0.1f), vec2(0.3f), vec2(0.5f, 0)})
    for (const Policy& policy : {kDecays[2], kDecays[3], kLongDecays[1]})
      for (const int since : {2, 4, 8, 20}) {
        const Course course = courseOf(1, 39, 0, moved), seen(course.end() - since, course.end());
        const std::size_t hidden = course.size() - seen.size();
        const double exact = exactVariance(seen, policy);
        ours.add(exact / predictedVariance<WalkMemory>(course, policy, hidden));
        control.add(exact / predictedVariance<AsOldAsTheTile>(course, policy, hidden));
      }
  std::printf("exact over predicted: %.3f .. %.3f; with the tile's walk %.3f .. %.3f\n", ours.low, ours.high,
              control.low, control.high);
  EXPECT_GT(ours.low, 0.95);
  EXPECT_LT(ours.high, 1.1);
  EXPECT_LT(control.low, 0.85);
}

TEST(RememberedWalks, KnowTheCountsUnderEachTap) {
  WalkMemory walks(kSize, kSize);
  core::Image<float> counts(kSize, kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) counts(x, y) = static_cast<float>((x + 5 * y) % 7);
  walks.update(tapsOf(vec2(0)), counts);
  const Taps taps = from(30, 20, {0.3f, 0.4f});
  const auto walk = walks(taps, twohistory::pairsOf(taps, kSize));
  float frames = 0, samples = 0;
  for (int k = 0; k < 4; ++k) {
    const float n = counts(taps.pixel[k] % kSize, taps.pixel[k] / kSize);
    frames += n > 0 ? taps.b[k] / n : 0, samples += taps.b[k] * n;
  }
  EXPECT_NEAR(walk.freshNoise({Weighting::frames}, 9), frames, 1e-6f);
  EXPECT_NEAR(walk.freshNoise({Weighting::samples}, 9), samples, 1e-6f);
}

TEST(RememberedWalks, ReachLedgersThroughAccumulate) {
  const twohistory::Policies<1> policies{kDecays[2]};
  core::Image<Ledger<1>> before(kSize, kSize), now = before;
  core::Image<float> value(kSize, kSize), next = value, count(kSize, kSize, 1);
  WalkMemory walks(kSize, kSize);
  const Course course = courseOf(3, 3, 0, vec2(0.4f, 0));
  for (const Frame& frame : course) {
    const core::Image<Taps> taps = tapsOf(frame.moved);
    twohistory::accumulate<1>(taps.view(), count.view(), policies, before.view(), now.view(), twohistory::Mean<float>{},
                              std::array<core::In<float>, 1>{value}, count.view(),
                              std::array<core::ImageView<float>, 1>{next}, core::kDefaultTile, walks);
    walks.update(taps, count);
    std::swap(before, now), std::swap(value, next);
  }
  const auto variance = static_cast<double>(before(kSize - 24, kSize - 24).covariance(0, 0));
  EXPECT_EQ(variance, predictedVariance<WalkMemory>(course, kDecays[2]));
  EXPECT_NE(variance, predictedVariance<NoMemory>(course, kDecays[2]));  // control
}

/// What the reference says at (x, y) of a history that forgets little and has settled.
twohistory::OlderNoise<float> olderAt(const WalkTiles& walks, int x, int y) {
  constexpr float kDecay = 0.98f;
  return walks.at(y * kSize + x).older({0.25f, 0.25f, 0.25f}, {1 / (1 - kDecay), 1e9f, kDecay}, 1 - kDecay * kDecay);
}

TEST(WalkTiles, KnowNothingInCommonBeforeAnythingMoved) {
  WalkTiles walks(kSize, kSize);
  EXPECT_EQ(olderAt(walks, 20, 20).share, 0);
  EXPECT_EQ(olderAt(walks, 20, 20).common, 0);
  for (int f = 0; f < 9; ++f) walks.update(tapsOf(vec2(f % 3, 0)), oneEach());
  EXPECT_GT(olderAt(walks, 20, 20).share, 0.8f);
  EXPECT_EQ(olderAt(walks, 20, 20).common, 0);
  EXPECT_LT(static_cast<double>(walks.bytes()) / (kSize * kSize), 8.1);
}

/// As olderAt, of a history whose noise is fresh to this share.
twohistory::OlderNoise<float> olderOf(const WalkTiles& walks, float fresh) {
  const float decay = 1 / std::sqrt(1 + 1 / 16.0f);  // on the ladder
  return walks.at(30 * kSize + 30).older({0.25f, 0.25f, 0.25f}, {1 / (1 - decay), 1e9f, decay}, fresh);
}

TEST(WalkTiles, LieBetweenBothWeightingsByWhatIsFresh) {
  WalkTiles walks(kSize, kSize);
  const SampleCounts eight = countsOf(core::Image<float>(kSize, kSize, 8));
  for (int f = 0; f < 300; ++f) walks.update(tapsOf(vec2(0.3f)), oneEach());
  EXPECT_EQ(olderOf(walks, 0).share, olderOf(walks, 1).share);  // constant counts: both are the same
  EXPECT_EQ(olderOf(walks, 0).common, olderOf(walks, 1).common);
  const float settled = olderOf(walks, 0).common;
  for (int f = 0; f < 12; ++f) walks.update(tapsOf(vec2(0.3f)), eight);
  const auto frames = olderOf(walks, 0), samples = olderOf(walks, 1);
  EXPECT_GT(frames.share, samples.share + 0.03f);  // by frames eight quiet samples add little to what is old
  EXPECT_GT(frames.common, 1.1f * settled);        // and that has walked for twelve frames more
  EXPECT_LT(samples.common, settled);
  for (const float share : {0.25f, 0.5f, 0.75f}) {
    const float fresh = 1 - samples.share - share * (frames.share - samples.share);
    EXPECT_NEAR(olderOf(walks, fresh).share, 1 - fresh, 1e-5f);
    EXPECT_LT(olderOf(walks, fresh).common, frames.common);
    EXPECT_GT(olderOf(walks, fresh).common, samples.common);
  }
  WalkTiles back = walks;
  for (int f = 0; f < 300; ++f) back.update(tapsOf(vec2(0.3f)), eight);
  EXPECT_NEAR(olderOf(back, 0).common, settled, 1e-3f);  // settled again
}

TEST(WalkTiles, MoveWithTheImageAndForgetWhatIsNew) {
  const auto mixes = [](int x, int) { return x < 32 ? vec2(0) : vec2(0.5f); };  // the right half
  WalkTiles walks(kSize, kSize);
  for (int f = 0; f < 20; ++f) walks.update(tapsOf(mixes), oneEach());
  EXPECT_GT(olderAt(walks, 56, 20).common, 0.4f);
  EXPECT_EQ(olderAt(walks, 8, 20).common, 0);
  WalkTiles moved = walks, stays = walks;
  moved.update(tapsOf(vec2(-32, 0)), oneEach()), stays.update(tapsOf(vec2(0)), oneEach());
  EXPECT_NEAR(olderAt(moved, 24, 20).common, olderAt(stays, 56, 20).common, 0.01f);
  EXPECT_GT(olderAt(moved, 24, 20).common, 0.2f);
  core::Image<Taps> taps = tapsOf(vec2(0));
  for (int y = 0; y < kSize; ++y)
    for (int x = 32; x < kSize; ++x) taps(x, y) = {};
  walks.update(taps, oneEach());
  EXPECT_EQ(olderAt(walks, 56, 20).common, 0);
  EXPECT_EQ(olderAt(walks, 56, 20).share, 0);
}

TEST(WalkTiles, AreNoLessAlikeBesideATileThatIsNew) {
  WalkTiles walks(kSize, kSize);
  for (int f = 0; f < 20; ++f) walks.update(tapsOf(vec2(0.5f)), oneEach());
  core::Image<Taps> taps = tapsOf(vec2(0.5f));
  for (int y = 0; y < kSize; ++y)
    for (int x = 32; x < 48; ++x) taps(x, y) = {};
  walks.update(taps, oneEach());
  EXPECT_NEAR(olderAt(walks, 48, 56).common, olderAt(walks, 58, 56).common, 0.01f);  // between both tiles' middles
  EXPECT_LT(olderAt(walks, 48, 56).share, 0.9f * olderAt(walks, 58, 56).share);      // control
}

/// What is left at the edge of what reached it T frames ago or earlier, in a history of decay d: sum of d^2k w^2 / n.
double leftOf(const std::vector<float>& counts, Weighting weighting, double d, std::size_t frames) {
  double sum = 0;
  for (std::size_t k = frames; k < counts.size(); ++k) {
    const double n = counts[counts.size() - 1 - k], w = freshWeight(weighting, n);
    sum += n > 0 ? std::pow(d, 2.0 * double(k)) * w * w / n : 0;
  }
  return sum;
}

TEST(WalkTiles, KnowHowNoisySamplesWereThatReachedTheEdge) {
  const float kDecay = std::sqrt(16 / 17.0f);  // on the ladder of rates
  for (const float last : {1.0f, 8.0f, 0.125f, 0.0f}) {
    std::vector<float> counts(300, 1.0f);
    counts.insert(counts.end(), 12, last);
    WalkTiles walks(kSize, kSize);
    for (const float n : counts) walks.update(tapsOf(vec2(0)), countsOf(core::Image<float>(kSize, kSize, n)));
    for (const Weighting weighting : {Weighting::frames, Weighting::samples}) {
      float weight = 0, ageSum = 0;
      for (const float n : counts) {
        ageSum = kDecay * (ageSum + weight);
        weight = kDecay * weight + freshWeight(weighting, n);
      }
      const auto noise = static_cast<float>(leftOf(counts, weighting, kDecay, 0));  // C: nothing moves
      const float perNoise = last > 0 ? freshWeight(weighting, last) / (last * noise) : 0.0f;
      for (const float frames : {4.0f, 12.0f, 20.0f, 40.0f}) {
        const twohistory::Arrival arrival{frames, twohistory::Arrival::kLongAgo};
        const auto share =
            walks.at(30 * kSize + 30).edge({0.5f, 0, 0}, arrival, {weight, ageSum, kDecay}, perNoise).share;
        const double exact = leftOf(counts, weighting, kDecay, static_cast<std::size_t>(frames)) / double(noise);
        EXPECT_NEAR(share / exact, 1, 0.02) << last << ", " << frames;
        if (last != 8 || weighting != Weighting::frames || frames < 12) continue;
        const float byLastCounts = twohistory::stillNoise(weight, perNoise, twohistory::deathRate(kDecay));
        EXPECT_LT(byLastCounts * std::pow(kDecay, 2 * frames) / exact, 0.2);  // control
      }
    }
  }
}

TEST(WalkTiles, KnowWalksAlongTheEdge) {
  WalkTiles walks(kSize, kSize);
  for (int f = 0; f < 200; ++f) walks.update(tapsOf(vec2(0, 0.5f)), oneEach());
  // At the left edge walks go up and down alone, and have settled: V = u / (u + l), rho as of a row.
  constexpr float kDecay = 0.95f;
  const float death = twohistory::deathRate(kDecay), rho = twohistory::walkCorrelation(death, 0.5f);
  const auto edge = [&](const TapPairs& pairs) {
    const float weight = 1 / (1 - kDecay), still = weight / (1 + kDecay);
    return walks.at(30 * kSize + 30).edge(pairs, {0, twohistory::Arrival::kLongAgo}, {weight, 1e9f, kDecay}, 1 / still);
  };
  const float noise = edge({0, 0.5f, 0}).share;
  EXPECT_NEAR(noise, death / (death + 0.5f * (1 - rho)), 0.03f);
  EXPECT_NEAR(edge({0, 0.5f, 0}).common / (0.5f * noise), rho, 0.03f);
  EXPECT_EQ(edge({0.5f, 0, 0}).common, 0.5f * noise);  // what lies in a row is one value
  WalkTiles turned(kSize, kSize);
  for (int f = 0; f < 200; ++f) turned.update(tapsOf(vec2(0.5f, 0)), oneEach());
  const auto upper = turned.at(30 * kSize + 30)
                         .edge({0.5f, 0, 0}, {twohistory::Arrival::kLongAgo, 0}, {20, 1e9f, kDecay}, (1 + kDecay) / 20);
  EXPECT_NEAR(upper.share, noise, 1e-3f);
  EXPECT_NEAR(upper.common, edge({0, 0.5f, 0}).common, 1e-3f);
}

TEST(TileMotion, IsNotSlowedByWhatStandsBesideWhatMoves) {
  const core::Image<Taps> taps = tapsOf([](int x, int) { return x < 8 ? vec2(0) : vec2(2.5f, 0.25f); });
  const auto motion = twohistory::tileMotion(taps, {0, 16}, {16, 32});
  EXPECT_FALSE(motion.isNew);
  EXPECT_NEAR(motion.steps.x, 0.5f, 1e-6f);  // 2 f (1 - f)
  EXPECT_NEAR(motion.steps.y, 0.375f, 1e-6f);
  EXPECT_NEAR(twohistory::tileMotion(taps, {32, 16}, {48, 32}).from.x, 39.5f - 2.5f, 1e-3f);
  EXPECT_EQ(twohistory::tileMotion(tapsOf(vec2(0)), {16, 16}, {32, 32}).from, vec2(23.5f));
  EXPECT_TRUE(twohistory::tileMotion(core::Image<Taps>(kSize, kSize), {0, 0}, {16, 16}).isNew);
}

TEST(WalkTiles, KnowThatYoungerPixelsHaveWalkedLess) {
  WalkTiles walks(kSize, kSize);
  for (int f = 0; f < 60; ++f) walks.update(tapsOf(vec2(0.1f)), oneEach());
  const auto commonAt = [&](float age) {
    return walks.at(30 * kSize + 30).older({0.25f, 0.25f, 0.25f}, {1, age, 0.98f}, 0.1f).common;
  };
  EXPECT_EQ(commonAt(24), commonAt(1e6f));  // as old as the tile, or older
  EXPECT_LT(commonAt(4), 0.8f * commonAt(24));
  EXPECT_LT(commonAt(1), 0.8f * commonAt(4));
  EXPECT_GE(commonAt(0), 0);
  const auto forgetsNothing = [&](float age) {
    return walks.at(30 * kSize + 30).older({0.25f, 0.25f, 0.25f}, {1, age, 1.0f}, 0.1f).common;
  };
  EXPECT_LT(forgetsNothing(2), 0.8f * forgetsNothing(30));
}

TEST(WalkTiles, StayFiniteOverManyFramesOfAnyMotion) {
  core::Rng rng(5, core::Pass::lab, 0, 0);
  for (const vec2 size : {vec2(1, 1), vec2(17, 1), vec2(kSize, kSize)}) {
    const int width = static_cast<int>(size.x), height = static_cast<int>(size.y);
    WalkTiles walks(width, height);
    core::Image<Taps> taps(width, height);
    core::Image<float> n(width, height);
    for (int f = 0; f < 3000; ++f) {
      const vec2 moved = 3.0f * rng.uniform2();
      for (int i = 0; i < width * height; ++i)  // none in half of the frames
        n.data()[i] = f / 40 % 2 ? 0.0f : std::exp2(40 * rng.uniform() - 20);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const std::int32_t here = y * width + x, right = std::min(x + 1, width - 1) - x;
          const std::int32_t below = (std::min(y + 1, height - 1) - y) * width;
          const float a = moved.x - std::floor(moved.x), b = moved.y - std::floor(moved.y);
          taps(x, y) = {{here, here + right, here + below, here + right + below},
                        {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
        }
      walks.update(taps, countsOf(n));
    }
    for (const float decay : {0.0f, 0.3f, 0.9f, 0.98f, 1.0f}) {
      for (const float fresh : {0.0f, 0.2f, 1.0f}) {
        const auto older = walks.at(0).older({0.3f, 0.3f, 0.15f}, {1e6f, 1e12f, decay}, fresh);
        EXPECT_TRUE(older.share >= 0 && older.share <= 1) << decay << ": " << older.share;
        EXPECT_TRUE(older.common >= 0 && older.common <= 0.751f) << decay << ": " << older.common;
      }
      const auto edge = walks.at(0).edge({0.3f, 0.3f, 0.15f}, {3, 7}, {1e6f, 1e12f, decay}, 1e-6f);
      EXPECT_TRUE(edge.share >= 0 && edge.share <= 1) << decay << ": " << edge.share;
      EXPECT_TRUE(edge.common >= 0 && edge.common <= 0.751f) << decay << ": " << edge.common;
    }
  }
}

TEST(WalkTiles, StayFiniteWhereThereAreNoSamplesForThousandsOfFrames) {
  WalkTiles walks(kSize, kSize);
  const core::Image<Taps> taps = tapsOf(vec2(0));
  const SampleCounts none = countsOf(core::Image<float>(kSize, kSize, 0));
  walks.update(taps, oneEach());
  for (int f = 0; f < 6000; ++f) {
    walks.update(taps, none);
    for (const float decay : {0.9f, 0.998f, 1.0f}) {
      const auto edge = walks.at(0).edge({0.3f, 0.3f, 0.15f}, {3, 7}, {1, 1e3f, decay}, 0);
      ASSERT_TRUE(edge.share >= 0 && edge.share <= 1) << decay << ", frame " << f;
      ASSERT_TRUE(edge.common >= 0 && edge.common <= 0.751f) << decay << ", frame " << f;
    }
  }
}

TEST(SampleCounts, AreExactWhereTheyAreSmallOrPowersOfTwo) {
  using namespace twohistory::count_code;
  for (int n = 0; n <= 16; ++n) EXPECT_EQ(unpack(pack(static_cast<float>(n))), n);
  for (int e = -16; e <= 15; ++e) EXPECT_EQ(unpack(pack(std::ldexp(1.0f, e))), std::ldexp(1.0f, e));
  core::Rng rng(7, core::Pass::lab, 0, 0);
  float before = 0;
  for (int i = 0; i < 10000; ++i) {
    const float n = std::exp2(30 * rng.uniform() - 15);
    EXPECT_NEAR(unpack(pack(n)) / n, 1, 1 / 16.0) << n;
  }
  for (float n = 1e-9f; n < 1e9f; n *= 1.01f) {
    EXPECT_GE(unpack(pack(n)), before);
    before = unpack(pack(n));
  }
  EXPECT_EQ(unpack(pack(1e30f)), 57344);
  EXPECT_GT(unpack(pack(1e-30f)), 0);  // few are not none
}

}  // namespace
