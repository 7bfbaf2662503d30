// The program's EXR frames have the same bytes for any number of threads and any tile size; another seed changes them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "core/files.h"

namespace {

namespace fs = std::filesystem;

/// Bytes of the last of three frames of `market` with a fovea, filtered by lag regression.
std::string lastFrame(const std::string& options) {
  const fs::path folder = fs::temp_directory_path() / ("twofold-determinism-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string command = std::string(TWOFOLD_PROGRAM) +
                              " render market --frames 3 --resolution 97x55 --set foveation.kind=circle "
                              "--set 'variants=[\"lag-safe\"]' -o " +
                              (folder / "f.exr").string() + " " + options + " 2>/dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::string bytes = core::readFile(folder / "f.0002.exr");
  fs::remove_all(folder);
  return bytes;
}

TEST(Determinism, FramesHaveTheSameBytesForAnyThreadsAndTile) {
  const std::string one = lastFrame("--threads 1");
  EXPECT_EQ(one, lastFrame("--threads 2"));
  EXPECT_EQ(one, lastFrame("--threads 2 --set render.tile=7"));
  EXPECT_EQ(one, lastFrame("--threads 3 --set render.tile=64 --set render.features=all"));
  EXPECT_NE(one, lastFrame("--threads 1 --seed 2"));  // control
}

TEST(Determinism, RawFramesAndReferencesToo) {
  EXPECT_EQ(lastFrame("--raw --threads 1"), lastFrame("--raw --threads 2 --set render.tile=9"));
  EXPECT_EQ(lastFrame("--reference 3 --threads 1"), lastFrame("--reference 3 --threads 2 --set render.tile=9"));
  EXPECT_NE(lastFrame("--reference 3"), lastFrame("--reference 3 --seed 2"));  // control
}

}  // namespace
