// Time to equal error on curves of error against time.
#pragma once

#include <utility>
#include <vector>

namespace experiments::efficiency {

/// One method at one count.
struct CurvePoint {
  double count = 0;         ///< samples a pixel n, > 0
  double milliseconds = 0;  ///< a frame, > 0
  double error = 0;         ///< points whose error is not positive are left out
};

/// How a time to equal error was found, from the surest on.
enum class Reach {
  measured,      ///< the error lies between measured points
  extrapolated,  ///< beyond the last point, by the 1 / n law of independent samples
  atMost,        ///< the first point is better already; its time is an upper bound
  atLeast,       ///< the error is not reached and no law says when; the last point's time is a lower bound
};

struct EqualTime {
  double milliseconds = 0;  ///< NaN where the curve has no point
  Reach reach = Reach::measured;
};

/// Least time at which a curve, taken as straight between its points in log time and log error, has at most `error`.
/// Points in order of count. independent: error falls as 1 / n, and time grows by the same with every further sample,
/// which is how the curve goes on beyond its last point.
EqualTime timeToError(const std::vector<CurvePoint>& curve, double error, bool independent);

/// Least-squares slope of log error over log n; -1 for independent samples and a plain mean. NaN below two points.
double slopeInCount(const std::vector<CurvePoint>& curve);

/// Where ratios rise above 1 for good: straight in log x and log ratio between points (x, ratio) in order of x. NaN
/// where they do not rise from below 1 to above it.
double riseAboveOne(const std::vector<std::pair<double, double>>& ratios);

}  // namespace experiments::efficiency
