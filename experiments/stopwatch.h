// Milliseconds by pass.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace experiments {

/// Sums of wall-clock time by pass, in the order in which the passes were first met.
class PassTimes {
 public:
  void add(const char* pass, double ms) {
    for (auto& [name, sum] : sums_)
      if (name == pass) return static_cast<void>(sum += ms);
    sums_.emplace_back(pass, ms);
  }
  const std::vector<std::pair<std::string, double>>& sums() const { return sums_; }

 private:
  std::vector<std::pair<std::string, double>> sums_;
};

/// Runs one pass and books its time.
template <class Body>
void timed(PassTimes& times, const char* pass, Body&& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  times.add(pass, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace experiments
