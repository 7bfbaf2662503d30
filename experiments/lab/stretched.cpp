#include "experiments/lab/stretched.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace experiments::lab {
namespace {

void stretch(SignalParameters& s, float factor) {
  for (float* x : {&s.low, &s.high, &s.amplitude, &s.rate, &s.period, &s.size, &s.speed}) *x *= factor;
  s.at = static_cast<int>(std::lround(factor * static_cast<float>(s.at)));
}

void stretch(NoiseParameters& n, float factor) {
  for (float* x : {&n.sigma, &n.fireflies, &n.fireflyFactor}) *x *= factor;
  if (n.held > 0) n.held = std::max(0.0f, 1 - (1 - n.held) / factor);
}

float stretchedCount(float count, float factor) {
  const float whole = std::round(factor * count);
  return count >= 1 ? std::max(1.0f, whole) : whole;
}

void stretch(PatternParameters& p, float factor) {
  for (float* count : {&p.foveation.inside, &p.foveation.outside, &p.most}) *count = stretchedCount(*count, factor);
  for (float* x : {&p.foveation.radius, &p.gaze.frequencyX, &p.gaze.frequencyY}) *x *= factor;
}

}  // namespace

Case stretched(const Case& original, double factor) {
  Case c = original;
  const auto f = static_cast<float>(factor);
  c.name = fmt::format("{}-x{:g}", original.name, factor);
  stretch(c.signal, f), stretch(c.noise, f), stretch(c.pattern, f);
  for (float* x : {&c.motion.x, &c.motion.y, &c.motion.rotation}) *x *= f;
  return c;
}

std::vector<Case> stretched(const std::vector<Case>& cases, const std::vector<double>& factors) {
  if (factors.empty()) return cases;
  std::vector<Case> all;
  for (const double factor : factors)
    for (const Case& c : cases) all.push_back(stretched(c, factor));
  return all;
}

}  // namespace experiments::lab
