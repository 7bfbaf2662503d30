// Pictures of reuse: their colours follow the values, and files come out whole.
#include "experiments/reuse_pictures.h"

#include <gtest/gtest.h>

#include "core/exr.h"
#include "tests/restir_worlds.h"

namespace {

using experiments::ErrorScale;
using experiments::Picture;

int lightness(const Picture& p, int x) { return p.at(x, 0)[0] + p.at(x, 0)[1] + p.at(x, 0)[2]; }

TEST(ReusePictures, LightnessRisesWithTheValueAndNothingIsGrey) {
  core::Image<float> values(7, 1);
  const std::array<float, 7> row{0.5f, 1, 4, 16, 64, 0, -1};
  for (int x = 0; x < 7; ++x) values(x, 0) = row[x];
  const Picture p = experiments::scalarPicture(values, ErrorScale{1, 64});
  EXPECT_EQ(lightness(p, 0), lightness(p, 1)) << "clamped";
  for (int x = 1; x < 4; ++x) EXPECT_LT(lightness(p, x), lightness(p, x + 1));
  for (const int x : {5, 6}) EXPECT_TRUE(p.at(x, 0)[0] == p.at(x, 0)[1] && p.at(x, 0)[1] == p.at(x, 0)[2]);
}

TEST(ReusePictures, FilesHoldEveryQuantity) {
  const restir::Diagnostics diagnostics(9, 5);
  const auto stem = std::filesystem::temp_directory_path() / "twofold_reuse_pictures";
  experiments::writeReusePictures(stem, diagnostics, true);
  const core::ExrImage image = core::readExr(stem.string() + ".reuse.exr");
  EXPECT_EQ(image.width, 9);
  for (const auto& q : experiments::reuseQuantities()) {
    EXPECT_TRUE(image.has(q.name)) << q.name;
    EXPECT_TRUE(std::filesystem::exists(stem.string() + "." + q.name + ".png"));
    std::filesystem::remove(stem.string() + "." + q.name + ".png");
  }
  EXPECT_EQ(core::channelOf(image, "age", "test")(3, 2), -1);
  std::filesystem::remove(stem.string() + ".reuse.exr");
}

}  // namespace
