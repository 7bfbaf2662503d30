// The gaze follows its formula and its recording, and a faulty recording is refused with the line's number.
#include "core/gaze.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/check.h"

namespace core {
namespace {

/// A CSV file that lives as long as this object.
class Recording {
 public:
  explicit Recording(const std::string& text) {
    static int count = 0;
    path_ = testing::TempDir() + "gaze_test_" + std::to_string(count++) + ".csv";
    std::ofstream(path_) << text;
  }
  ~Recording() { std::filesystem::remove(path_); }
  GazeParameters parameters() const {
    GazeParameters p;
    p.kind = GazeKind::file;
    p.file = path_;
    return p;
  }

 private:
  std::string path_;
};

void expectAt(const Gaze& gaze, double time, vec2 expected) {
  const vec2 position = gaze.at(time, 200, 100);
  EXPECT_NEAR(position.x, expected.x, 1e-3f) << "at " << time;
  EXPECT_NEAR(position.y, expected.y, 1e-3f) << "at " << time;
}

void expectError(const std::string& text, const std::string& part) {
  const Recording recording(text);
  try {
    const Gaze gaze(recording.parameters());
    ADD_FAILURE() << "accepted: " << text;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Gaze, FixedIsAFractionOfTheImage) {
  GazeParameters p;
  p.kind = GazeKind::fixed;
  p.x = 0.25f, p.y = 0.75f;
  EXPECT_EQ(gazeAt(p, 0, 200, 100), vec2(50, 75));
  EXPECT_EQ(gazeAt(p, 7.5, 200, 100), vec2(50, 75));
}

TEST(Gaze, LissajousFollowsTheProtocol) {
  const Gaze gaze{GazeParameters{}};
  expectAt(gaze, 0, {200, 50});                        // sin(pi/2) = 1, sin 0 = 0
  expectAt(gaze, 0.5, {100 + 100 * 0.3090170f, 100});  // cos(0.4 pi), sin(pi/2)
  expectAt(gaze, 1, {100 - 100 * 0.8090170f, 50});     // cos(0.8 pi), sin(pi)
  expectAt(gaze, 1.25, {0, 50 - 50 * 0.7071068f});     // cos(pi), sin(1.25 pi)
  expectAt(gaze, 10, {200, 50});                       // both periods divide 10 s
  expectAt(gaze, 3600, {200, 50});                     // and an hour, without loss of phase
}

TEST(Gaze, RecordingInPixelsIsInterpolatedAndClampedToItsEnds) {
  const Recording recording("# from an eye tracker\ntime,x,y\n\n1, 10, 20\r\n2,30,0\n4,30,80\n");
  const Gaze gaze(recording.parameters());
  expectAt(gaze, 0, {10, 20});
  expectAt(gaze, 1.5, {20, 10});
  expectAt(gaze, 2, {30, 0});
  expectAt(gaze, 3.5, {30, 60});
  expectAt(gaze, 9, {30, 80});
}

TEST(Gaze, RecordingInFractionsScalesWithTheImage) {
  const Recording recording("time,u,v\n0,0.5,0.25\n");
  const Gaze gaze(recording.parameters());
  EXPECT_EQ(gaze.at(0, 200, 100), vec2(100, 25));
  EXPECT_EQ(gaze.at(0, 400, 400), vec2(200, 100));
}

TEST(Gaze, FaultyRecordingsAreRefusedWithTheirLine) {
  expectError("", "holds no gaze position");
  expectError("time,x,y\n", "holds no gaze position");
  expectError("0,1,2\n", "line 1: no column names");
  expectError("time,u,y\n0,1,2\n", "line 1: no column names");
  expectError("time,x,y\n0,1\n", "line 2: not three finite numbers");
  expectError("time,x,y\n0,1,2,3\n", "line 2: not three finite numbers");
  expectError("time,x,y\n0,1,2\n\n1,nan,2\n", "line 4: not three finite numbers");
  expectError("time,x,y\n0,1,inf\n", "line 2: not three finite numbers");
  expectError("time,x,y\n0,1,2px\n", "line 2: not three finite numbers");
  expectError("time,x,y\n0,1,2\n0,3,4\n", "line 3: time does not ascend");
}

TEST(Gaze, AMissingRecordingIsRefused) {
  GazeParameters p;
  p.kind = GazeKind::file;
  p.file = "/nowhere/gaze.csv";
  EXPECT_THROW(Gaze{p}, Error);
}

}  // namespace
}  // namespace core
