#include "experiments/efficiency/equal_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/maths.h"

namespace experiments::efficiency {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;  ///< relative difference below which two errors are the same

bool usable(const CurvePoint& p) {
  return p.count > 0 && p.milliseconds > 0 && p.error > 0 && std::isfinite(p.milliseconds) && std::isfinite(p.error);
}

std::vector<CurvePoint> usablePoints(const std::vector<CurvePoint>& curve) {
  std::vector<CurvePoint> points;
  std::copy_if(curve.begin(), curve.end(), std::back_inserter(points), usable);
  return points;
}

/// y at x on the straight line through two points in logarithms of both.
double between(double x0, double y0, double x1, double y1, double x) {
  const double t = std::log(x / x0) / std::log(x1 / x0);
  return y0 * std::pow(y1 / y0, t);
}

/// Least time on any segment that has at most the error; infinite if none has.
double leastTime(const std::vector<CurvePoint>& points, double error) {
  double least = kInfinity;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const CurvePoint &a = points[i - 1], &b = points[i];
    if (b.error <= error * (1 + kRounding)) least = std::min(least, b.milliseconds);
    if ((a.error > error) != (b.error > error))
      least = std::min(least, between(a.error, a.milliseconds, b.error, b.milliseconds, error));
  }
  return least;
}

/// Beyond the last point: n grows by the ratio of errors, time by what the last samples took.
double extrapolated(const std::vector<CurvePoint>& points, double error) {
  const CurvePoint& last = points.back();
  double perSample = last.milliseconds / last.count;
  if (points.size() > 1) {
    const CurvePoint& previous = points[points.size() - 2];
    const double step = (last.milliseconds - previous.milliseconds) / (last.count - previous.count);
    if (step > 0) perSample = step;
  }
  return last.milliseconds + perSample * last.count * (last.error / error - 1);
}

}  // namespace

EqualTime timeToError(const std::vector<CurvePoint>& curve, double error, bool independent) {
  const std::vector<CurvePoint> points = usablePoints(curve);
  if (points.empty() || !(error > 0)) return {core::kNaN, Reach::atLeast};
  const CurvePoint& first = points.front();
  if (first.error <= error * (1 + kRounding))
    return {first.milliseconds, first.error >= error * (1 - kRounding) ? Reach::measured : Reach::atMost};
  if (const double least = leastTime(points, error); std::isfinite(least)) return {least, Reach::measured};
  if (independent) return {extrapolated(points, error), Reach::extrapolated};
  return {points.back().milliseconds, Reach::atLeast};
}

double slopeInCount(const std::vector<CurvePoint>& curve) {
  const std::vector<CurvePoint> points = usablePoints(curve);
  if (points.size() < 2) return core::kNaN;
  const auto size = static_cast<double>(points.size());
  double meanX = 0, meanY = 0, xx = 0, xy = 0;
  for (const CurvePoint& p : points) meanX += std::log(p.count) / size, meanY += std::log(p.error) / size;
  for (const CurvePoint& p : points) {
    const double x = std::log(p.count) - meanX;
    xx += x * x, xy += x * (std::log(p.error) - meanY);
  }
  return xx > 0 ? xy / xx : core::kNaN;
}

double riseAboveOne(const std::vector<std::pair<double, double>>& ratios) {
  for (std::size_t i = ratios.size(); i-- > 1;) {
    const auto& [x0, r0] = ratios[i - 1];
    const auto& [x1, r1] = ratios[i];
    if (r1 < 1) return core::kNaN;
    if (r0 < 1) return between(r0, x0, r1, x1, 1);
  }
  return core::kNaN;
}

}  // namespace experiments::efficiency
