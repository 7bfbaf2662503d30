#include "core/gaze.h"

#include <array>
#include <charconv>
#include <numbers>
#include <sstream>
#include <string_view>

#include "core/check.h"
#include "core/files.h"

namespace core {
namespace {

constexpr const char* kColumns = "write a first line time,x,y (seconds, pixels) or time,u,v (seconds, fractions)";

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

bool isBlankOrComment(std::string_view line) { return trim(line).empty() || trim(line).front() == '#'; }

/// A finite number that fills the whole cell.
bool parseNumber(std::string_view cell, double& number) {
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return error == std::errc() && end == cell.data() + cell.size() && std::isfinite(number);
}

/// Exactly three comma-separated cells, trimmed.
bool split(std::string_view line, std::array<std::string_view, 3>& cells) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto comma = line.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return false;
    cells[i] = trim(line.substr(0, comma));
    line = i == 2 ? std::string_view{} : line.substr(comma + 1);
  }
  return true;
}

/// True for pixels, false for fractions; throws where the line names neither.
bool columnsInPixels(const std::string& line, const std::string& where) {
  std::array<std::string_view, 3> cells;
  if (split(line, cells) && cells[0] == "time") {
    if (cells[1] == "x" && cells[2] == "y") return true;
    if (cells[1] == "u" && cells[2] == "v") return false;
  }
  throw Error(where, "no column names", kColumns);
}

float wave(double time, float frequency, float phase) {
  return static_cast<float>(std::sin(2 * std::numbers::pi * frequency * time + phase));
}

}  // namespace

Gaze::Gaze(const GazeParameters& parameters) : parameters_(parameters) {
  if (parameters.kind == GazeKind::file) load(parameters.file);
}

Gaze::Sample Gaze::parseSample(const std::string& line, const std::string& where) {
  std::array<std::string_view, 3> cells;
  double time = 0, x = 0, y = 0;
  if (!split(line, cells) || !parseNumber(cells[0], time) || !parseNumber(cells[1], x) || !parseNumber(cells[2], y))
    throw Error(where, "not three finite numbers", "write time, x and y separated by commas");
  return {time, vec2(x, y)};
}

void Gaze::load(const std::string& path) {
  std::istringstream file(readFile(path));
  bool named = false;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string where = path + " line " + std::to_string(number);
    if (isBlankOrComment(line)) continue;
    if (!named) {
      inPixels_ = columnsInPixels(line, where);
      named = true;
      continue;
    }
    recording_.push_back(parseSample(line, where));
    const std::size_t last = recording_.size() - 1;
    if (last > 0 && recording_[last].time <= recording_[last - 1].time)
      throw Error(where, "time does not ascend", "sort the lines by time and keep one for each");
  }
  if (recording_.empty()) throw Error(path, "holds no gaze position", kColumns);
}

vec2 Gaze::recorded(double time) const {
  const auto next = std::upper_bound(recording_.begin(), recording_.end(), time,
                                     [](double t, const Sample& sample) { return t < sample.time; });
  if (next == recording_.begin()) return next->position;
  const auto last = next - 1;
  if (next == recording_.end()) return last->position;
  return lerp(last->position, next->position, static_cast<float>((time - last->time) / (next->time - last->time)));
}

vec2 Gaze::at(double time, int width, int height) const {
  const GazeParameters& p = parameters_;
  const vec2 size(width, height);
  switch (p.kind) {
    case GazeKind::file:
      return inPixels_ ? recorded(time) : recorded(time) * size;
    case GazeKind::lissajous:
      return size * (vec2(p.x, p.y) + vec2(p.amplitudeX * wave(time, p.frequencyX, p.phaseX),
                                           p.amplitudeY * wave(time, p.frequencyY, p.phaseY)));
    case GazeKind::fixed:
      break;
  }
  return size * vec2(p.x, p.y);
}

}  // namespace core
