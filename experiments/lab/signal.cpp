#include "experiments/lab/signal.h"

#include <cmath>

namespace experiments::lab {
namespace {

using core::vec2;

bool isOdd(float cell) { return (static_cast<long long>(std::floor(cell)) & 1) != 0; }

/// True in the darker parts of stripes or checker.
bool isDark(const SignalParameters& p, vec2 point) {
  const bool column = isOdd(point.x / p.size);
  return p.kind == SignalKind::texture ? column != isOdd(point.y / p.size) : column;
}

float turn(const SignalParameters& p, float t) { return 2 * core::kPi * t / p.period; }

float spot(const SignalParameters& p, vec2 point, float t) {
  const vec2 centre = 1.5f * p.size * vec2(std::cos(turn(p, t)), std::sin(turn(p, t)));
  const vec2 d = (point - centre) / p.size;
  return p.low + p.amplitude * std::exp(-dot(d, d));
}

float pulse(const SignalParameters& p, float t) { return std::max(0.0f, 1 + p.amplitude * std::sin(turn(p, t))); }

}  // namespace

float signalAt(const SignalParameters& p, vec2 point, int frame) {
  const float t = static_cast<float>(frame);
  switch (p.kind) {
    case SignalKind::ramp:
      return std::exp(p.rate * t);
    case SignalKind::step:
      return frame < p.at ? 1 : p.high;
    case SignalKind::pulse:
      return pulse(p, t);
    case SignalKind::spot:
      return spot(p, point, t);
    case SignalKind::edge:
    case SignalKind::texture:
      return isDark(p, point) ? p.low : 1;
    case SignalKind::shadow:
      return isDark(p, point - vec2(p.speed * t, 0)) ? p.low : 1;
    case SignalKind::constant:
      break;
  }
  return 1;
}

core::vec3 colourAt(const SignalParameters& p, vec2 point, int frame) {
  if (!isColoured(p)) return core::vec3(signalAt(p, point, frame));
  const float t = static_cast<float>(frame), later = p.apart * p.period;
  return {pulse(p, t), pulse(p, t - later), pulse(p, t - 2 * later)};
}

std::uint32_t surfaceAt(const SignalParameters& p, vec2 point) {
  const bool parts = p.kind == SignalKind::edge || p.kind == SignalKind::texture;
  return p.separate && parts && isDark(p, point) ? 1 : 0;
}

}  // namespace experiments::lab
