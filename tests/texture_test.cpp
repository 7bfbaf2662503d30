// Bilinear look-ups: texel centres, wrap modes, sRGB decoded before mixing, coordinates that are not finite.
#include "core/texture.h"

#include <gtest/gtest.h>

namespace core {
namespace {

using Wrap = Texture::Wrap;

/// One row (or column) of grey texels.
Texture strip(std::vector<std::uint8_t> grey, Wrap wrap, bool vertical = false) {
  Texture texture;
  texture.width = vertical ? 1 : static_cast<int>(grey.size());
  texture.height = vertical ? static_cast<int>(grey.size()) : 1;
  texture.wrapU = texture.wrapV = wrap;
  for (const std::uint8_t g : grey) texture.texels.insert(texture.texels.end(), {g, g, g, 255});
  return texture;
}

/// Value at coordinate u in units of 1/255.
float at(const Texture& texture, float u) { return 255 * sampleLinear(texture, {u, 0.5f}).x; }

TEST(Texture, TexelCentresGiveTheTexelAndTheMiddleTheMean) {
  const Texture texture = strip({0, 100, 200, 40}, Wrap::clamp);
  EXPECT_NEAR(at(texture, 0.125f), 0, 1e-4f);
  EXPECT_NEAR(at(texture, 0.375f), 100, 1e-4f);
  EXPECT_NEAR(at(texture, 0.5f), 150, 1e-4f);
  EXPECT_NEAR(at(texture, 0.875f), 40, 1e-4f);
}

TEST(Texture, RowZeroIsTheTop) {
  const Texture texture = strip({10, 250}, Wrap::clamp, true);
  EXPECT_NEAR(255 * sampleLinear(texture, {0.5f, 0.0f}).x, 10, 1e-4f);
  EXPECT_NEAR(255 * sampleLinear(texture, {0.5f, 1.0f}).x, 250, 1e-4f);
}

TEST(Texture, WrapModes) {
  const std::vector<std::uint8_t> grey{0, 100, 200, 40};
  const Texture repeat = strip(grey, Wrap::repeat), mirror = strip(grey, Wrap::mirror),
                clamp = strip(grey, Wrap::clamp);
  for (const float u : {0.125f, 0.3f, 0.6f, 0.875f}) {
    EXPECT_NEAR(at(repeat, u + 3), at(repeat, u), 1e-3f);
    EXPECT_NEAR(at(repeat, u - 2), at(repeat, u), 1e-3f);
    EXPECT_NEAR(at(mirror, -u), at(mirror, u), 1e-3f);
    EXPECT_NEAR(at(mirror, 2 - u), at(mirror, u), 1e-3f);
    EXPECT_NEAR(at(mirror, 2 + u), at(mirror, u), 1e-3f);
  }
  EXPECT_NEAR(at(repeat, 0), 20, 1e-4f);  // between the last and the first
  EXPECT_NEAR(at(mirror, 0), 0, 1e-4f);
  EXPECT_NEAR(at(mirror, 1), 40, 1e-4f);
  EXPECT_NEAR(at(clamp, -5), 0, 1e-4f);
  EXPECT_NEAR(at(clamp, 5), 40, 1e-4f);
}

TEST(Texture, SrgbIsDecodedBeforeMixing) {
  EXPECT_EQ(kSrgbToLinear[0], 0.0f);
  EXPECT_EQ(kSrgbToLinear[255], 1.0f);
  EXPECT_NEAR(kSrgbToLinear[188], 0.5029f, 1e-4f);
  EXPECT_NEAR(kSrgbToLinear[5], 5 / 255.0f / 12.92f, 1e-7f);  // linear part
  const Texture texture = strip({0, 255}, Wrap::clamp);
  EXPECT_NEAR(sampleSrgb(texture, {0.5f, 0.5f}).x, 0.5f, 1e-6f);  // mixing codes first would give 0.216
  EXPECT_EQ(sampleSrgb(texture, {0.5f, 0.5f}).w, 1.0f);
}

TEST(Texture, AlphaStaysLinear) {
  Texture texture = strip({188}, Wrap::clamp);
  texture.texels[3] = 188;
  EXPECT_NEAR(sampleSrgb(texture, {0.5f, 0.5f}).w, 188 / 255.0f, 1e-6f);
}

TEST(Texture, AnyCoordinateIsSafe) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
    const Texture texture = strip({3, 7, 11}, wrap);
    for (const float u : {nan, kInfinity, -kInfinity, 3e38f, -3e38f, 1e10f, -1e-30f, 1e-40f, 16777217.0f})
      for (const vec2 uv : {vec2(u, 0), vec2(0, u), vec2(u, u)}) {
        const float value = 255 * lookup(texture, uv).x;
        EXPECT_TRUE(value >= 2.99f && value <= 11.01f) << u;
      }
  }
}

}  // namespace
}  // namespace core
