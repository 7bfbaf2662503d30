// EXR, PNG and whole files: what is written is read back bit for bit, bytes do not change from run to run, and files
// that are broken, absurd or absent give one clear error and leave nothing behind.
#include "core/exr.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <cstring>

#include <cstdlib>
#include <filesystem>

#include "core/files.h"
#include "core/png.h"

namespace fs = std::filesystem;
using core::ExrImage;
using core::Image;

namespace {

class ExrTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("exr_test_" + std::to_string(::getpid()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path file(const std::string& name) const { return folder_ / name; }
  std::size_t fileCount() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }
  fs::path folder_;
};

Image<float> ramp(int width, int height, float start) {
  Image<float> values(width, height);
  for (std::size_t i = 0; i < values.size(); ++i) values.data()[i] = start + 0.1f * static_cast<float>(i);
  return values;
}

void expectSameBits(const Image<float>& a, const Image<float>& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0);
}

/// Position of the first byte after an attribute's name, type and size.
std::size_t attributeAt(const std::string& bytes, const std::string& nameAndType) {
  return bytes.find(nameAndType) + nameAndType.size() + 4;
}

void patchInt(std::string& bytes, std::size_t at, std::int32_t value) { std::memcpy(bytes.data() + at, &value, 4); }

std::string errorOf(const fs::path& path) {
  try {
    core::readExr(path);
  } catch (const core::Error& e) {
    return e.what();
  }
  return "";
}

const std::string kDataWindow("dataWindow\0box2i\0", 17);

}  // namespace

TEST_F(ExrTest, RoundTripKeepsEveryBitOfEveryChannel) {
  ExrImage image;
  Image<float> hard(5, 3, 0.0f);
  const float values[] = {-0.0f, 1e-41f, 65505.0f, 3e38f, -7.25f, core::kInfinity, -core::kInfinity, std::nanf("1")};
  std::copy(std::begin(values), std::end(values), hard.data());
  image.add("hard", hard);
  core::Planes albedo(5, 3, 0.25f);
  albedo.view().store(4, 2, {1, 2, 3});
  image.add("albedo", albedo);
  core::writeExr(file("a.exr"), image);
  const ExrImage back = core::readExr(file("a.exr"));
  ASSERT_EQ(back.channels.size(), 4u);
  for (const auto& [name, channel] : image.channels) expectSameBits(channel, back.channels.at(name));
  EXPECT_EQ(core::rgbOf(back, "albedo", "a").view().load(4, 2), core::vec3(1, 2, 3));
}

TEST_F(ExrTest, BytesDependOnPixelsAlone) {
  ExrImage image;
  image.add("R", ramp(33, 17, 0));
  core::writeExr(file("first.exr"), image);
  core::writeExr(file("second_with_another_name.exr"), image);
  EXPECT_EQ(core::readFile(file("first.exr")), core::readFile(file("second_with_another_name.exr")));
  image.channels.at("R")(3, 3) += 1;
  core::writeExr(file("third.exr"), image);
  EXPECT_NE(core::readFile(file("first.exr")), core::readFile(file("third.exr")));
}

TEST_F(ExrTest, DataWindowMayLieAnywhere) {
  ExrImage image;
  image.add("Y", ramp(6, 4, 1));
  core::writeExr(file("a.exr"), image);
  std::string bytes = core::readFile(file("a.exr"));
  const std::size_t window = attributeAt(bytes, kDataWindow);
  const int moved[] = {-7, 100, -2, 103};
  for (int i = 0; i < 4; ++i) patchInt(bytes, window + 4 * i, moved[i]);
  for (std::uint64_t at = window; at + 12 < bytes.size(); ++at) {  // the only chunk starts where its offset ends
    std::uint64_t offset;
    std::memcpy(&offset, bytes.data() + at, 8);
    if (offset != at + 8) continue;
    patchInt(bytes, at + 8, 100);
    break;
  }
  core::writeFileAtomically(file("b.exr"), bytes);
  const ExrImage back = core::readExr(file("b.exr"));
  expectSameBits(image.channels.at("Y"), back.channels.at("Y"));
  EXPECT_EQ(core::rgbOf(back, "", "b").view().load(5, 3), core::vec3(image.channels.at("Y")(5, 3)));
}

TEST_F(ExrTest, TruncationAnywhereIsAnError) {
  ExrImage image;
  image.add("R", ramp(64, 64, 0));
  core::writeExr(file("whole.exr"), image);
  const std::string bytes = core::readFile(file("whole.exr"));
  for (double part : {0.0, 0.001, 0.01, 0.02, 0.1, 0.5, 0.9, 0.99}) {
    core::writeFileAtomically(file("part.exr"), bytes.substr(0, static_cast<std::size_t>(part * bytes.size())));
    EXPECT_NE(errorOf(file("part.exr")), "") << part;
    EXPECT_EQ(errorOf(file("part.exr")).find('\n'), std::string::npos);
  }
}

TEST_F(ExrTest, AbsurdSizesAreRefusedBeforeAllocating) {
  ExrImage image;
  image.add("R", ramp(8, 8, 0));
  core::writeExr(file("a.exr"), image);
  const std::string bytes = core::readFile(file("a.exr"));
  for (int side : {32000, 1 << 17, 1 << 30, 0x7ffffff0}) {
    std::string big = bytes;
    patchInt(big, attributeAt(big, kDataWindow) + 8, side - 1);
    patchInt(big, attributeAt(big, kDataWindow) + 12, side - 1);
    core::writeFileAtomically(file("big.exr"), big);
    EXPECT_NE(errorOf(file("big.exr")), "") << side;
  }
}

TEST_F(ExrTest, WhatIsNotAnImageIsAnErrorThatNamesTheFile) {
  core::writeFileAtomically(file("text.exr"), "this is not an image");
  EXPECT_NE(errorOf(file("text.exr")).find("text.exr"), std::string::npos);
  EXPECT_NE(errorOf(file("absent.exr")).find("no such file"), std::string::npos);
  EXPECT_NE(errorOf(folder_), "");
  ExrImage image;
  image.add("depth", ramp(2, 2, 0));
  EXPECT_THROW(core::rgbOf(image, "", "x.exr"), core::Error);
  EXPECT_THROW(core::channelOf(image, "Z", "x.exr"), core::Error);
}

TEST_F(ExrTest, FailedWritesLeaveNothing) {
  ExrImage image;
  image.add("R", ramp(4, 4, 0));
  EXPECT_THROW(core::writeExr(file("no/such/folder/a.exr"), image), core::Error);
  EXPECT_THROW(core::writeFileAtomically(folder_, "x"), core::Error);
  { core::PendingFile abandoned(file("b.exr")); }
  EXPECT_EQ(fileCount(), 0u);
  core::writeFileAtomically(file("c"), "old");
  core::writeFileAtomically(file("c"), "new");
  EXPECT_EQ(core::readFile(file("c")), "new");
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(ExrTest, PngIsDeterministicAndHasItsSignature) {
  const std::vector<std::uint8_t> pixels(3 * 4 * 4, 77);
  const core::ByteImage image{3, 4, 4, pixels};
  const std::string bytes = core::pngBytes(image);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes, core::pngBytes(image));
  core::writePng(file("a.png"), image);
  EXPECT_EQ(core::readFile(file("a.png")), bytes);
}

TEST_F(ExrTest, ReadsForeignHalfDwaImage) {
  const char* shared = std::getenv("TWOFOLD_SHARED");
  const fs::path path = fs::path(shared ? shared : TWOFOLD_SOURCE_DIR "/../shared") / "scenes/others/night.exr";
  if (!fs::exists(path)) GTEST_SKIP() << "skipped: no shared data";
  const core::Planes rgb = core::readExrRgb(path);
  EXPECT_EQ(rgb.width(), 512);
  EXPECT_EQ(rgb.height(), 256);
  double sum = 0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 512; ++x) sum += core::luminance(rgb.view().load(x, y));
  EXPECT_GT(sum, 0);
  EXPECT_TRUE(std::isfinite(sum));
}
