// Sample counts: whole numbers in range, where they should be, with the mean that was asked for.
#include "core/foveation.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/exr.h"
#include "core/random.h"

namespace core {
namespace {

constexpr int kWidth = 96, kHeight = 72;

struct Placed {
  Image<float> counts{kWidth, kHeight, -1};
  Image<std::uint8_t> fovea{kWidth, kHeight, 9};
};

Placed place(const FoveationParameters& p, vec2 gaze = {48, 36}, std::uint64_t seed = 1, std::uint32_t frame = 0) {
  Placed placed;
  Foveation(p).place(gaze, seed, frame, placed.counts, placed.fovea);
  return placed;
}

FoveationParameters ofKind(FoveationKind kind) {
  FoveationParameters p;
  p.kind = kind;
  return p;
}

double mean(const Image<float>& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.size(); ++i) sum += image.data()[i];
  return sum / static_cast<double>(image.size());
}

bool sameCounts(const Placed& a, const Placed& b) {
  return std::equal(a.counts.data(), a.counts.data() + a.counts.size(), b.counts.data());
}

TEST(Foveation, CircleIsEightInsideAndOneOutside) {
  const Placed placed = place(ofKind(FoveationKind::circle));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = std::hypot(x + 0.5 - 48, y + 0.5 - 36) <= 20;  // 200 of 720 lines are 20 of 72
      ASSERT_EQ(placed.counts(x, y), inside ? 8 : 1) << x << ", " << y;
      ASSERT_EQ(placed.fovea(x, y), inside ? 1 : 0) << x << ", " << y;
    }
}

TEST(Foveation, CircleFollowsTheGazeAndMayLeaveTheImage) {
  const FoveationParameters p = ofKind(FoveationKind::circle);
  EXPECT_EQ(place(p, {10, 10}).counts(10, 10), 8);
  EXPECT_EQ(place(p, {10, 10}).counts(48, 36), 1);
  EXPECT_EQ(mean(place(p, {-500, 10}).counts), 1);
}

TEST(Foveation, UniformKeepsTheFoveaAsARegion) {
  FoveationParameters p = ofKind(FoveationKind::uniform);
  p.samples = 3;
  const Placed placed = place(p);
  EXPECT_EQ(mean(placed.counts), 3);
  EXPECT_EQ(placed.fovea(48, 36), 1);
  EXPECT_EQ(placed.fovea(0, 0), 0);
}

TEST(Foveation, SmoothFallsFromInsideToOutside) {
  FoveationParameters p = ofKind(FoveationKind::smooth);
  p.radius = 10.0f / kHeight, p.fallOff = 20.0f / kHeight, p.inside = 64, p.outside = 0;
  const Placed placed = place(p, {0, 36});
  EXPECT_EQ(placed.counts(9, 36), 64);
  EXPECT_NEAR(placed.counts(20, 36), 32, 3);  // half-way
  EXPECT_EQ(placed.counts(31, 36), 0);
  for (int x = 1; x < kWidth; ++x) EXPECT_LE(placed.counts(x, 36), placed.counts(x - 1, 36));
  EXPECT_EQ(placed.fovea(9, 36), 1);
  EXPECT_EQ(placed.fovea(12, 36), 0);
}

TEST(Foveation, SmoothWithoutARingIsTheCircle) {
  FoveationParameters p = ofKind(FoveationKind::smooth);
  p.fallOff = 0;
  EXPECT_TRUE(sameCounts(place(p), place(ofKind(FoveationKind::circle))));
}

TEST(Foveation, CountsAreWholeInEveryRounding) {
  FoveationParameters p = ofKind(FoveationKind::smooth);
  for (const Rounding rounding : {Rounding::nearest, Rounding::stochastic}) {
    p.rounding = rounding;
    const Placed placed = place(p);
    for (std::size_t i = 0; i < placed.counts.size(); ++i) {
      const float n = placed.counts.data()[i];
      ASSERT_TRUE(n == std::floor(n) && n >= 0 && n <= kMaxSamples) << n;
    }
  }
}

/// Over 6,912 pixels of variance 0.21 the mean has a standard error of 0.0055: 4 of them is a significance of 6e-5.
TEST(Foveation, StochasticRoundingKeepsTheMean) {
  FoveationParameters p = ofKind(FoveationKind::uniform);
  p.samples = 0.3f;
  EXPECT_EQ(mean(place(p).counts), 0) << "negative control: rounding to the nearest loses it";
  p.rounding = Rounding::stochastic;
  EXPECT_NEAR(mean(place(p).counts), 0.3, 0.022);
}

TEST(Foveation, StochasticRoundingDependsOnSeedAndFrameAlone) {
  FoveationParameters p = ofKind(FoveationKind::uniform);
  p.samples = 0.5f, p.rounding = Rounding::stochastic;
  EXPECT_TRUE(sameCounts(place(p), place(p)));
  EXPECT_FALSE(sameCounts(place(p, {48, 36}, 1), place(p, {48, 36}, 2)));
  EXPECT_FALSE(sameCounts(place(p, {48, 36}, 1, 0), place(p, {48, 36}, 1, 1)));
}

TEST(Foveation, ExtremeCountsStayInRange) {
  FoveationParameters p = ofKind(FoveationKind::circle);
  p.inside = kMaxSamples, p.outside = 0;
  EXPECT_EQ(place(p).counts(48, 36), kMaxSamples);
  EXPECT_EQ(place(p).counts(0, 0), 0);
}

/// A map in a file that lives as long as this object.
class MapFile {
 public:
  explicit MapFile(const Image<float>& map, bool twice = false) : path_(testing::TempDir() + "foveation_test.exr") {
    ExrImage file;
    file.width = map.width(), file.height = map.height();
    file.channels["n"] = map;
    if (twice) file.channels["m"] = map;
    writeExr(path_, file);
  }
  ~MapFile() { std::filesystem::remove(path_); }
  FoveationParameters parameters(float scale = 1) const {
    FoveationParameters p = ofKind(FoveationKind::map);
    p.file = path_;
    p.scale = scale;
    return p;
  }

 private:
  std::string path_;
};

TEST(Foveation, MapIsScaledToTheImageByNearest) {
  Image<float> map(2, 2);
  map(0, 0) = 0, map(1, 0) = 1, map(0, 1) = 4, map(1, 1) = 2;
  const MapFile file(map);
  const Placed placed = place(file.parameters(4), {1000, 1000});
  EXPECT_EQ(placed.counts(0, 0), 0);
  EXPECT_EQ(placed.counts(47, 35), 0);
  EXPECT_EQ(placed.counts(48, 35), 4);
  EXPECT_EQ(placed.counts(47, 36), 16);
  EXPECT_EQ(placed.counts(95, 71), 8);
  EXPECT_EQ(placed.fovea(47, 36), 1);
  EXPECT_EQ(placed.fovea(95, 71), 1);
  EXPECT_EQ(placed.fovea(48, 35), 0);
}

TEST(Foveation, MapOfTheImagesSizeIsTakenPixelByPixel) {
  Image<float> map(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) map(x, y) = static_cast<float>((x + 7 * y) % 64);
  const MapFile file(map);
  const Placed placed = place(file.parameters());
  for (std::size_t i = 0; i < map.size(); ++i) ASSERT_EQ(placed.counts.data()[i], map.data()[i]);
}

TEST(Foveation, FaultyMapsAreRefused) {
  for (const float bad : {-1.0f, kInfinity, std::numeric_limits<float>::quiet_NaN(), 4097.0f}) {
    Image<float> map(3, 2, 1);
    map(2, 1) = bad;
    const MapFile file(map);
    EXPECT_THROW(Foveation{file.parameters()}, Error) << bad;
  }
  const MapFile twoChannels(Image<float>(3, 2, 1), true);
  EXPECT_THROW(Foveation{twoChannels.parameters()}, Error);
  const MapFile tooMany(Image<float>(3, 2, 1));
  EXPECT_THROW(Foveation{tooMany.parameters(5000)}, Error);
  FoveationParameters missing = ofKind(FoveationKind::map);
  missing.file = "/nowhere/map.exr";
  EXPECT_THROW(Foveation{missing}, Error);
}

}  // namespace
}  // namespace core
