// Where the viewer looks: fixed, a Lissajous path, or a recording.
// Source of the path: [Tu24], evaluation: frequencies 0.4 and 0.5 Hz, the whole image wide and high.
#pragma once

#include <string>
#include <vector>

#include "core/maths.h"

namespace core {

enum class GazeKind : std::uint8_t { fixed, lissajous, file };

/// Positions and amplitudes are fractions of the image's width (x) and height (y); (0, 0) is the top left corner.
struct GazeParameters {
  GazeKind kind = GazeKind::lissajous;
  float x = 0.5f, y = 0.5f;                    ///< the position, or the path's centre
  float amplitudeX = 0.5f, amplitudeY = 0.5f;  ///< of the path
  float frequencyX = 0.4f, frequencyY = 0.5f;  ///< Hz
  float phaseX = 0.5f * kPi, phaseY = 0;       ///< radians at time 0
  std::string file;                            ///< recording, see Gaze
};

template <class V>
void describe(V& v, GazeParameters& p) {
  v.choice("kind", p.kind, {{"fixed", GazeKind::fixed}, {"lissajous", GazeKind::lissajous}, {"file", GazeKind::file}},
           "how the gaze moves");
  v("x", p.x, "gaze, or centre of its path, fraction of the width", -10.0, 10.0);
  v("y", p.y, "gaze, or centre of its path, fraction of the height", -10.0, 10.0);
  v("amplitudeX", p.amplitudeX, "of the Lissajous path, fraction of the width", -10.0, 10.0);
  v("amplitudeY", p.amplitudeY, "of the Lissajous path, fraction of the height", -10.0, 10.0);
  v("frequencyX", p.frequencyX, "of the Lissajous path, Hz", 0.0, 1000.0);
  v("frequencyY", p.frequencyY, "of the Lissajous path, Hz", 0.0, 1000.0);
  v("phaseX", p.phaseX, "of the Lissajous path, radians", -100.0, 100.0);
  v("phaseY", p.phaseY, "of the Lissajous path, radians", -100.0, 100.0);
  v("file", p.file, "CSV recording with the columns time,x,y (pixels) or time,u,v (fractions)");
}

/// The gaze over time.
///
/// A recording is a CSV file. Its first line names the columns: `time,x,y` (seconds, pixels of the image) or `time,u,v`
/// (seconds, fractions of width and height). Times ascend. Between two lines the gaze moves linearly; before the first
/// and after the last it rests. Blank lines and lines that begin with # are skipped.
class Gaze {
 public:
  /// Reads the recording if there is one; throws Error with the line's number where it is not as above.
  explicit Gaze(const GazeParameters& parameters);
  /// Position in pixels of an image of this size at time in seconds; may lie outside the image.
  vec2 at(double time, int width, int height) const;

 private:
  struct Sample {
    double time;
    vec2 position;
  };
  static Sample parseSample(const std::string& line, const std::string& where);
  void load(const std::string& path);
  vec2 recorded(double time) const;

  GazeParameters parameters_;
  bool inPixels_ = false;
  std::vector<Sample> recording_;
};

/// Gaze(parameters).at(time, width, height), for one look.
inline vec2 gazeAt(const GazeParameters& parameters, double time, int width, int height) {
  return Gaze(parameters).at(time, width, height);
}

}  // namespace core
