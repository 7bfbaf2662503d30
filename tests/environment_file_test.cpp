// Files of environment maps: both formats and every encoding give one map; whatever is broken is one clear line.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/check.h"
#include "core/environment.h"
#include "core/exr.h"
#include "core/files.h"
#include "core/hdr.h"
#include "experiments/config.h"
#include "experiments/scene_source.h"
#include "tests/environment_maps.h"

namespace {

namespace fs = std::filesystem;
using core::vec3;
using tests::HdrCoding;

class EnvironmentFile : public testing::Test {
 protected:
  EnvironmentFile() : folder_(fs::temp_directory_path() / ("twofold-environment-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~EnvironmentFile() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }
  std::string writeExr(const std::string& name, const core::Planes& image) const {
    core::writeExrRgb(file(name), image);
    return file(name);
  }
  static std::string errorOf(const std::string& path) {
    try {
      core::loadEnvironment(path);
    } catch (const core::Error& e) {
      return e.what();
    }
    return "";
  }

 private:
  fs::path folder_;
};

/// A picture of wide and narrow rows, and the same as float.
struct Picture {
  explicit Picture(int w = 700, int h = 9) : width(w), height(h), pixels(tests::rgbePixels(w * h)), planes(w, h) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        planes.view().store(x, y, tests::radianceOf(pixels[static_cast<std::size_t>(y * w + x)]));
  }
  std::string size() const { return "-Y " + std::to_string(height) + " +X " + std::to_string(width); }
  int width, height;
  std::vector<tests::Rgbe> pixels;
  core::Planes planes;
};

void expectSame(const core::Planes& a, const core::Planes& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) ASSERT_EQ(a.view().load(x, y), b.view().load(x, y)) << x << " " << y;
}

TEST_F(EnvironmentFile, EveryEncodingOfHdrIsTheSamePicture) {
  for (const int width : {7, 8, 700}) {
    const Picture picture(width, 9);
    for (const HdrCoding coding : {HdrCoding::flat, HdrCoding::oldRuns, HdrCoding::newRuns}) {
      if (width < 8 && coding == HdrCoding::newRuns) continue;
      const std::string name = write("a.hdr", tests::hdrBytes(picture.pixels, width, coding, picture.size()));
      expectSame(core::readHdr(name), picture.planes);
    }
  }
}

TEST_F(EnvironmentFile, HdrAndExrAreTheSameMap) {
  const Picture picture;
  const std::string exr = writeExr("a.exr", picture.planes);
  const std::string hdr =
      write("no_extension", tests::hdrBytes(picture.pixels, picture.width, HdrCoding::newRuns, picture.size()));
  const auto a = core::loadEnvironment(exr), b = core::loadEnvironment(hdr), twice = core::loadEnvironment(hdr, 2);
  ASSERT_EQ(a->texels().size(), b->texels().size());
  for (std::size_t i = 0; i < a->texels().size(); ++i) {
    ASSERT_EQ(a->texels()[i], b->texels()[i]);
    ASSERT_EQ(2.0f * a->texels()[i], twice->texels()[i]);
  }
}

TEST_F(EnvironmentFile, HeaderSaysExposureAndOrientation) {
  const Picture picture(20, 4);
  const auto read = [&](const std::string& size, const std::string& variables) {
    return core::readHdr(write("a.hdr", tests::hdrBytes(picture.pixels, 20, HdrCoding::newRuns, size, variables)));
  };
  const core::Planes exposed = read("-Y 4 +X 20", "EXPOSURE= 2\nEXPOSURE=4\nCOLORCORR=1 2 0.5\nPRIMARIES=0 0 0 0\n");
  const core::Planes flipped = read("+Y 4 -X 20", "");
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 20; ++x) {
      EXPECT_EQ(exposed.view().load(x, y), picture.planes.view().load(x, y) / vec3(8, 16, 4));
      EXPECT_EQ(flipped.view().load(19 - x, 3 - y), picture.planes.view().load(x, y));
    }
}

TEST_F(EnvironmentFile, EveryTruncationIsOneLine) {
  const Picture picture(40, 6);
  for (const HdrCoding coding : {HdrCoding::flat, HdrCoding::oldRuns, HdrCoding::newRuns}) {
    const std::string bytes = tests::hdrBytes(picture.pixels, 40, coding, picture.size());
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      const std::string error = errorOf(write("part.hdr", bytes.substr(0, length)));
      ASSERT_NE(error, "") << length << " of " << bytes.size();
      ASSERT_EQ(error.find('\n'), std::string::npos);
      ASSERT_NE(error.find("part.hdr"), std::string::npos);
    }
  }
}

TEST_F(EnvironmentFile, BytesThatAreWrongNeverCrash) {
  const Picture picture(40, 6);
  core::Rng rng(3, core::Pass::lab, 0, 0);
  for (const HdrCoding coding : {HdrCoding::oldRuns, HdrCoding::newRuns}) {
    const std::string bytes = tests::hdrBytes(picture.pixels, 40, coding, picture.size());
    for (int i = 0; i < 1000; ++i) {
      std::string spoiled = bytes;
      for (int k = 0; k < 3; ++k)
        spoiled[rng.below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(rng.below(256));
      try {
        core::readHdr(write("spoiled.hdr", spoiled));
      } catch (const core::Error& e) {
        ASSERT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      }
    }
  }
}

TEST_F(EnvironmentFile, WhatIsNoPictureIsAnErrorThatSaysWhy) {
  const Picture picture(40, 6);
  const auto hdr = [&](const std::string& size, const std::string& variables = "") {
    return errorOf(write("a.hdr", tests::hdrBytes(picture.pixels, 40, HdrCoding::newRuns, size, variables)));
  };
  const auto says = [](const std::string& error, const char* part) {
    EXPECT_NE(error.find(part), std::string::npos) << error << " lacks " << part;
  };
  says(errorOf(file("absent.hdr")), "no such environment map");
  says(errorOf(fs::path(file("x")).parent_path().string()), "no such environment map");
  says(errorOf(write("empty.hdr", "")), "neither OpenEXR nor Radiance");
  says(errorOf(write("text.exr", "no image")), "neither OpenEXR nor Radiance");
  says(errorOf(write("cut.exr", "\x76\x2f\x31\x01")), "cannot be read as OpenEXR");
  says(hdr("-Y 0 +X 40"), "0 pixels");
  says(hdr("-Y 6 +X -40"), "pixels");
  says(hdr("-Y 131072 +X 131072"), "pixels");
  says(hdr("-Y 99999999999999999999 +X 40"), "no size");
  says(hdr("+X 40 -Y 6"), "no size");
  says(hdr("-Y 6 +X 41"), "another width");
  says(hdr("-Y 7 +X 40"), "ends before its last pixel");
  says(hdr("-Y 100000 +X 1000"), "ends before its last pixel");
  says(hdr("-Y 6 +X 40", "FORMAT=32-bit_rle_xyze\n"), "xyze");
  says(hdr("-Y 6 +X 40", "EXPOSURE=0\n"), "exposure");
  says(hdr("-Y 6 +X 40", "EXPOSURE=nan\n"), "exposure");
  says(hdr("-Y 6 +X 40", "COLORCORR=1 1\n"), "exposure");
  core::ExrImage depth;
  depth.add("Z", core::Image<float>(4, 2));
  core::writeExr(file("depth.exr"), depth);
  says(errorOf(file("depth.exr")), "no channel R");
  core::Planes spoiled(4, 2, 1.0f);
  spoiled.view().plane[2](3, 0) = std::nanf("1");
  says(errorOf(writeExr("nan.exr", spoiled)), "pixel (3, 0) is not finite");
}

TEST_F(EnvironmentFile, ReadsASharedImage) {
  const char* shared = std::getenv("TWOFOLD_SHARED");
  const fs::path path = fs::path(shared ? shared : TWOFOLD_SOURCE_DIR "/../shared") / "scenes/others/night.exr";
  if (!fs::exists(path)) GTEST_SKIP() << "skipped: no shared data";
  const auto map = core::loadEnvironment(path);
  EXPECT_EQ(map->width(), 512);
  EXPECT_GT(map->meanLuminance(), 0);
  EXPECT_GT(map->negatives(), 0);  // its lossy compression left some
}

TEST_F(EnvironmentFile, IsPartOfTheScenesHash) {
  core::Scene scene = experiments::loadScene("cornell");
  const std::string without = experiments::contentHash(scene);
  core::Planes map(8, 4, 1.0f);
  const auto with = [&](const core::Planes& image) {
    scene.environment = tests::environmentFrom(image);
    return experiments::contentHash(scene);
  };
  const std::string first = with(map);
  EXPECT_EQ(first, with(map));
  EXPECT_NE(first, without);
  EXPECT_NE(first, with(core::Planes(4, 8, 1.0f)));
  map.view().store(3, 2, vec3(1, 1, 1.5f));
  EXPECT_NE(first, with(map));
}

/// The program with arguments as a shell would split them: exit code and what it printed as errors.
std::pair<int, std::string> runProgram(const std::string& arguments, const std::string& errors) {
  const int status = std::system(("'" TWOFOLD_PROGRAM "' " + arguments + " >/dev/null 2>'" + errors + "'").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, core::readFile(errors)};
}

TEST_F(EnvironmentFile, BrokenOnesEndRenderAndRunWithOneLineAndNoFile) {
  const Picture picture(40, 6);
  core::Planes infinite(4, 2, 1.0f);
  infinite.view().plane[0](1, 1) = core::kInfinity;
  writeExr("infinite.exr", infinite);
  write("text.exr", "no image");
  const std::string whole = tests::hdrBytes(picture.pixels, 40, HdrCoding::newRuns, picture.size());
  write("cut.hdr", whole.substr(0, whole.size() - 1));
  write("config.json", R"({"scenes":["cornell"],"frames":1,"width":8,"height":8})");
  for (const char* name : {"infinite.exr", "text.exr", "cut.hdr", "absent.exr"}) {
    const std::string set = " --set scene.environment='" + file(name) + "' -o '";
    for (const std::string& command : {"render cornell --resolution 8x8" + set + file("out.exr") + "'",
                                       "run '" + file("config.json") + "'" + set + file("out") + "'"}) {
      const auto [code, errors] = runProgram(command, file("errors.txt"));
      EXPECT_EQ(code, 1) << command << errors;
      EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
      EXPECT_NE(errors.find(name), std::string::npos) << errors;
    }
    EXPECT_FALSE(fs::exists(file("out.exr")) || fs::exists(file("out")));
  }
  EXPECT_EQ(runProgram("render cornell --set scene.environmentScale=0 -o '" + file("out.exr") + "'", file("e")).first,
            2);
}

TEST_F(EnvironmentFile, ABlackMapIsAWarning) {
  const std::string map = writeExr("black.exr", core::Planes(4, 2));
  const auto [code, errors] =
      runProgram("render cornell --resolution 8x8 --set scene.environment='" + map + "' -o '" + file("out.exr") + "'",
                 file("errors.txt"));
  EXPECT_EQ(code, 0) << errors;
  EXPECT_NE(errors.find("black.exr: it is black"), std::string::npos) << errors;
}

TEST_F(EnvironmentFile, FramesUnderItHaveTheSameBytesForAnyThreadsAndTile) {
  const std::string map = writeExr("sky.exr", tests::skyMap(64, 32, 46, 10, 2000));
  const auto last = [&](const std::string& options) {
    const auto [code, errors] = runProgram("render cornell --frames 3 --resolution 61x35 --set scene.environment='" +
                                               map + "' -o '" + file("f.exr") + "' " + options,
                                           file("errors.txt"));
    EXPECT_EQ(code, 0) << errors;
    return core::readFile(file("f.0002.exr"));
  };
  const std::string one = last("--threads 1");
  EXPECT_EQ(one, last("--threads 3 --set render.tile=7"));
  EXPECT_EQ(one, last("--threads 2 --set render.features=all"));
  EXPECT_NE(one, last("--threads 1 --set scene.environmentScale=2"));  // controls
  EXPECT_NE(one, last("--threads 1 --seed 2"));
  EXPECT_EQ(last("--raw --threads 1"), last("--raw --threads 2 --set render.tile=9"));
  EXPECT_EQ(last("--reference 3 --threads 1"), last("--reference 3 --threads 2 --set render.tile=9"));
}

}  // namespace
