// What measured rows say: curves of error against time, and who reaches the target's error when.
#pragma once

#include "core/statistics.h"
#include "experiments/efficiency/config.h"
#include "experiments/efficiency/equal_error.h"
#include "experiments/results.h"

namespace experiments::efficiency {

/// A method at a count in one scene: geometric means over seeds, with Student's t intervals of logarithms.
struct Point {
  std::string scene, method;
  int count = 0;
  std::string metric;  ///< which error
  core::Interval milliseconds, error;
};

/// When a method has the target's error in one scene. Times and ratios are worked out seed by seed.
struct EqualError {
  std::string scene, metric, method;
  core::Interval milliseconds;    ///< a frame
  core::Interval ratio;           ///< over the target's time: above 1, the target is faster
  Reach reach = Reach::measured;  ///< the least sure one of all seeds
  double slope = 0;               ///< of log error over log n, all counts
  bool baseline = false;
  bool best = false;  ///< of the baselines: the one with the least time, chosen among those that reach the error
};

/// The best baseline's ratio over numbers of lights, of scenes lamps-N.
struct ByLights {
  std::string metric;
  std::vector<std::pair<double, EqualError>> best;  ///< by number of lights, ascending
  double pays = 0;  ///< number of lights from which the target is faster, interpolated; NaN if ratios do not cross 1
};

struct Findings {
  std::string target;  ///< label, such as "balance n=1"
  std::vector<Point> points;
  std::vector<EqualError> equal;
  std::vector<ByLights> byLights;  ///< empty below two scenes lamps-N
};

/// rows: as measure() gives, all scenes and seeds. targetCount: one of the target's counts.
Findings analyse(const EfficiencyConfig& config, int targetCount, const std::vector<Row>& rows);

/// One sentence: from how many lights on the target pays.
std::string verdict(const ByLights& lights, const std::string& target);

Json pointJson(const Point& point);
Json equalErrorJson(const EqualError& equal);
Json byLightsJson(const ByLights& lights);

}  // namespace experiments::efficiency
