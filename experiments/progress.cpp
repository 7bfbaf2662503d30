#include "experiments/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace experiments {

namespace {

constexpr int kBarWidth = 24;
constexpr double kTerminalPause = 0.1, kLinePause = 10;  ///< seconds between reports

double secondsBetween(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

std::string durationText(double seconds) {
  const auto s = static_cast<std::int64_t>(std::ceil(std::max(0.0, seconds)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

Progress::Progress(std::string title, std::int64_t total, std::FILE* out)
    : title_(std::move(title)),
      total_(std::max<std::int64_t>(1, total)),
      out_(out),
      terminal_(isatty(fileno(out))),
      start_(Clock::now()),
      reported_(start_) {}

Progress::~Progress() {
  const std::scoped_lock lock(mutex_);
  if (done_ == total_) report("", true);  // a run that failed says why elsewhere, in one line
}

void Progress::advance(std::int64_t steps, const std::string& note) {
  const std::scoped_lock lock(mutex_);
  done_ = std::min(total_, done_ + steps);
  if (secondsBetween(reported_, Clock::now()) >= (terminal_ ? kTerminalPause : kLinePause)) report(note, false);
}

void Progress::skip(std::int64_t steps) {
  const std::scoped_lock lock(mutex_);
  done_ = std::min(total_, done_ + steps);
  skipped_ += steps;
}

std::string Progress::line(const std::string& note) const {
  const double elapsed = secondsBetween(start_, Clock::now());
  const std::int64_t worked = done_ - skipped_;
  std::string text = fmt::format("{}: {}/{}", title_, done_, total_);
  if (done_ == total_)
    text += ", took " + durationText(elapsed);
  else if (worked > 0)
    text += fmt::format(", {} left",
                        durationText(elapsed * static_cast<double>(total_ - done_) / static_cast<double>(worked)));
  return note.empty() ? text : text + ", " + note;
}

void Progress::report(const std::string& note, bool last) {
  reported_ = Clock::now();
  if (!terminal_) {
    fmt::print(out_, "{}\n", line(note));
  } else {
    const auto filled = static_cast<int>(kBarWidth * done_ / total_);
    const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
    fmt::print(out_, "\r\033[K[{}] {}{}", bar, line(note), last ? "\n" : "");
  }
  std::fflush(out_);
}

}  // namespace experiments
