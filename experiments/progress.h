// Tells how far a long run is: a bar on a terminal, now and then a line elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>

namespace experiments {

/// Counts steps and reports on stderr. Safe to call from many threads.
class Progress {
 public:
  /// total: steps expected, > 0. out: where to report; a terminal gets a bar.
  Progress(std::string title, std::int64_t total, std::FILE* out = stderr);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Goes on by some steps; note says what is being done now.
  void advance(std::int64_t steps = 1, const std::string& note = "");
  /// Goes on by steps that cost no time (resumed work), so that they do not spoil the time left.
  void skip(std::int64_t steps);

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(const std::string& note) const;
  void report(const std::string& note, bool last);

  std::string title_;
  std::int64_t total_, done_ = 0, skipped_ = 0;
  std::FILE* out_;
  bool terminal_;
  Clock::time_point start_, reported_;
  std::mutex mutex_;
};

/// Seconds as people say them: 42 s, 3 min 05 s, 2 h 10 min.
std::string durationText(double seconds);

}  // namespace experiments
