// Where counts have been constant since the reset the second history is skipped, and no bit shows it.
#include "twohistory/twins.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/synthetic.h"

namespace {

using core::Planes;
using experiments::Variant;
using tests::Synthetic;

constexpr int kWidth = 84, kHeight = 52;

/// A wall that may move and be hidden: taps(x, y, frame).
struct Sequence {
  const char* name;
  Synthetic::Counts counts;
  core::vec2 motion{0};
  int hiddenFrame = -1;  ///< in it pixels left of the middle lose their history
  int poisonedFrame = -1;
  int frames = 14;
};

bool insideFovea(int x, int y) { return (x - 60) * (x - 60) + (y - 30) * (y - 30) < 10 * 10; }

const std::vector<Sequence>& sequences() {
  static const std::vector<Sequence> all{
      {"constant", [](int, int, int) { return 4; }},
      {"fovea_that_stays", [](int x, int y, int) { return insideFovea(x, y) ? 8 : 1; }},
      {"fovea_arrives_and_leaves", [](int x, int y, int f) { return insideFovea(x, y) && f >= 4 && f < 9 ? 8 : 1; }},
      {"not_a_power_of_two", [](int x, int, int) { return x < 40 ? 3 : 2; }},
      {"zeros", [](int x, int y, int f) { return (x + y + f) % 7 == 0 ? 0 : 2; }},
      {"never_seen", [](int x, int y, int) { return x > 50 && x < 75 && y > 20 && y < 40 ? 0 : 1; }},
      {"changing", [](int x, int y, int f) { return 1 + (x / 9 + y / 7 + f) % 3; }},
      {"moving", [](int, int, int) { return 1; }, {0.3f, -0.6f}},
      {"zeros_moving", [](int x, int y, int f) { return (x + y + f) % 7 == 0 ? 0 : 4; }, {0.3f, -0.6f}},
      {"moving_fovea", [](int x, int y, int f) { return insideFovea(x - f, y) ? 8 : 1; }, {1, 0}},
      {"disocclusion", [](int, int, int) { return 2; }, {0, 0}, 9},
      {"bad_input", [](int, int, int) { return 2; }, {0, 0}, -1, 7},
      {"many", [](int x, int, int) { return x == 20   ? 4096
                                            : x == 60 ? 8192
                                                      : 16; }}};
  return all;
}

twohistory::Taps tapsAt(const Sequence& s, int x, int y, int frame) {
  if (frame == 0 || (frame == s.hiddenFrame && x < kWidth / 2)) return {};
  const core::vec2 p = core::vec2(x, y) + s.motion, corner = glm::floor(p), f = p - corner;
  const float b[4] = {(1 - f.x) * (1 - f.y), f.x * (1 - f.y), (1 - f.x) * f.y, f.x * f.y};
  twohistory::Taps t;
  float sum = 0;
  for (int k = 0; k < 4; ++k) {
    const int u = static_cast<int>(corner.x) + (k & 1), v = static_cast<int>(corner.y) + (k >> 1);
    if (b[k] > 0 && u >= 0 && v >= 0 && u < kWidth && v < kHeight) t.pixel[k] = v * kWidth + u, sum += t.b[k] = b[k];
  }
  for (float& w : t.b) w = sum > 0 ? w / sum : 0;
  return t;
}

/// What every frame of a sequence became.
struct Images {
  std::vector<Planes> images;
  std::vector<core::Image<float>> weights;
};

Images run(const Sequence& s, Variant variant, bool skip) {
  variant.filter.skipTwins = skip;
  Synthetic input(
      kWidth, kHeight, 5, [](int x, int, int) { return core::vec3(x < 30 ? 2.0f : 0.5f, 1, 1); }, s.counts);
  experiments::FilterState state(variant, kWidth, kHeight);
  core::Image<twohistory::Taps> taps(kWidth, kHeight);
  Images result;
  for (int i = 0; i < s.frames; ++i) {
    experiments::Shaded frame = input.frame(i);
    if (i == s.poisonedFrame) input.radiance().view().store(20, 20, core::vec3(NAN));
    core::forEachPixel(kWidth, kHeight, [&](int x, int y) { taps(x, y) = tapsAt(s, x, y, i); });
    frame.taps = taps;
    Planes out(kWidth, kHeight);
    filter(frame, variant, {}, state, out);
    result.images.push_back(out);
    core::Image<float> weight(kWidth, kHeight);
    core::forEachPixel(kWidth, kHeight, [&](int x, int y) { weight(x, y) = state.blendWeight()(x, y); });
    result.weights.push_back(weight);
  }
  return result;
}

bool sameBits(const core::In<float>& a, const core::In<float>& b) {
  return std::memcmp(a.data, b.data, sizeof(float) * a.width * a.height) == 0;
}

class Twins : public testing::TestWithParam<std::tuple<std::string, std::size_t>> {};
INSTANTIATE_TEST_SUITE_P(Blends, Twins,
                         testing::Combine(testing::Values("published", "optimal", "seed", "lag-uw"),
                                          testing::Range<std::size_t>(0, sequences().size())),
                         [](const auto& param) {
                           std::string name =
                               std::get<0>(param.param) + "_" + sequences()[std::get<1>(param.param)].name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(Twins, AreSkippedWithoutChangingABit) {
  const Sequence& s = sequences()[std::get<1>(GetParam())];
  const Variant variant = experiments::variantByName(std::get<0>(GetParam()));
  const Images skipped = run(s, variant, true), full = run(s, variant, false);
  for (int i = 0; i < s.frames; ++i) {
    for (int c = 0; c < 3; ++c)
      ASSERT_TRUE(sameBits(skipped.images[i].view().plane[c], full.images[i].view().plane[c])) << "frame " << i;
    ASSERT_TRUE(sameBits(skipped.weights[i], full.weights[i])) << "frame " << i;
  }
}

/// Share of tiles that are twins after a sequence.
double twinShare(const Sequence& s) {
  const Variant variant = experiments::variantByName("optimal");
  Synthetic input(
      kWidth, kHeight, 5, [](int, int, int) { return core::vec3(1); }, s.counts);
  svgf::FilterState<2> state(kWidth, kHeight);
  for (int i = 0; i < s.frames; ++i) {
    const experiments::Shaded frame = input.frame(i);
    state.swapFrames();
    svgf::dropBadSamples(frame.radiance, frame.samples, state.samples);
    svgf::accumulate<2>(variant.filter, {variant.histories[0], variant.histories[1]}, frame.taps, frame.radiance,
                        state);
    svgf::estimateVariance(variant.filter, frame.guide, state);
    svgf::filterHistories(variant.filter, frame.guide, state);
  }
  int twins = 0, tiles = 0;
  for (int y = 0; y < kHeight; y += twohistory::TwinTiles::kSide)
    for (int x = 0; x < kWidth; x += twohistory::TwinTiles::kSide) ++tiles, twins += state.twins.at(x, y);
  return static_cast<double>(twins) / tiles;
}

const Sequence& named(const char* name) {
  for (const Sequence& s : sequences())
    if (std::string(name) == s.name) return s;
  throw std::runtime_error(name);
}

TEST(TwinTiles, AreFoundWhereCountsAreConstantAndNowhereElse) {
  if (!twohistory::StoredLedger<2>::kKnowsTwins) GTEST_SKIP() << "skipped: this layout marks no twins";
  EXPECT_EQ(twinShare(named("constant")), 1);
  EXPECT_EQ(twinShare(named("fovea_that_stays")), 1);  // constant in every pixel, whatever its neighbours have
  EXPECT_EQ(twinShare(named("changing")), 0);
  Sequence arrived = named("fovea_arrives_and_leaves");
  arrived.frames = 6;
  const double soon = twinShare(arrived);
  EXPECT_GT(soon, 0.2);
  EXPECT_LT(soon, 0.9);
  arrived.frames = 40;  // the fed-back filter carries the difference on, two pixels a frame
  EXPECT_LT(twinShare(arrived), 0.5 * soon);
}

TEST(TwinTiles, NarrowToWhatTheirReachTouches) {
  twohistory::TwinTiles tiles(100, 40);
  for (int y = 0; y < 40; y += 16)
    for (int x = 0; x < 100; x += 16) tiles.of(x, y) = 1;
  tiles.of(40, 20) = 0;  // [32, 48) x [16, 32)
  const auto narrowed = [&](int y, int reach) {
    int x0 = 0, x1 = 100;
    tiles.narrow(y, reach, x0, x1);
    return std::pair(x0, x1);
  };
  EXPECT_EQ(narrowed(20, 0), std::pair(32, 48));
  EXPECT_EQ(narrowed(20, 2), std::pair(16, 64));
  EXPECT_EQ(narrowed(15, 2), std::pair(16, 64));
  const auto none = narrowed(10, 2);
  EXPECT_GE(none.first, none.second);
  EXPECT_LE(none.first, 100);
}

}  // namespace
