// The truths of the laboratory: simple signals on a plane, each a known trap for temporal histories.
#pragma once

#include "core/maths.h"

namespace experiments::lab {

enum class SignalKind {
  constant,  ///< 1
  ramp,      ///< exp(rate t): drift of one relative speed
  step,      ///< 1 before frame `at`, then `high` (below 1: a step down)
  pulse,     ///< 1 + amplitude sin(2 pi t / period)
  spot,      ///< `low` and a soft spot of radius `size` that circles with `period`
  edge,      ///< stripes `size` wide, 1 and `low`
  texture,   ///< checker of squares `size` wide, 1 and `low`
  shadow,    ///< stripes `size` wide, 1 and `low`, that move by `speed`
};

struct SignalParameters {
  SignalKind kind = SignalKind::constant;
  float low = 0.2f, high = 3, amplitude = 0.5f, rate = 0.015f;
  float period = 32;      ///< frames
  float size = 16;        ///< pixels
  float speed = 1;        ///< pixels a frame
  float apart = 0;        ///< pulse: of its period, from one colour channel to the next
  int at = 48;            ///< frame of the step
  bool separate = false;  ///< edge, texture: the parts are surfaces of their own, so that edge-aware means see them
};

template <class V>
void describe(V& v, SignalParameters& p) {
  v.choice("kind", p.kind,
           {{"constant", SignalKind::constant},
            {"ramp", SignalKind::ramp},
            {"step", SignalKind::step},
            {"pulse", SignalKind::pulse},
            {"spot", SignalKind::spot},
            {"edge", SignalKind::edge},
            {"texture", SignalKind::texture},
            {"shadow", SignalKind::shadow}},
           "the true radiance over the plane and over time");
  v("low", p.low, "radiance of the darker parts", 0.0, 1e6);
  v("high", p.high, "step: radiance after it", 0.0, 1e6);
  v("amplitude", p.amplitude, "pulse: of the sine; spot: of the spot", 0.0, 1e6);
  v("rate", p.rate, "ramp: relative change a frame", -1.0, 1.0);
  v("period", p.period, "pulse, spot: frames", 1.0, 1e6);
  v("size", p.size, "spot: radius; edge, texture, shadow: width; pixels", 0.5, 1e6);
  v("speed", p.speed, "shadow: pixels a frame", -1e3, 1e3);
  v("apart", p.apart, "pulse: how much later one colour channel is than the one before, of the period", -1.0, 1.0);
  v("at", p.at, "step: its frame", 0.0, 1e6);
  v("separate", p.separate, "edge, texture: the parts are surfaces of their own");
}

/// Radiance of the red channel at a point of the plane, in pixels from its centre, in a frame; >= 0. That of all, but
/// for pulses whose channels are apart.
float signalAt(const SignalParameters& parameters, core::vec2 point, int frame);

/// The same in RGB.
core::vec3 colourAt(const SignalParameters& parameters, core::vec2 point, int frame);

/// Whether channels differ.
inline bool isColoured(const SignalParameters& p) { return p.kind == SignalKind::pulse && p.apart != 0; }

/// Which surface lies there: 0, or 0 and 1 in turn where the parts are separate.
std::uint32_t surfaceAt(const SignalParameters& parameters, core::vec2 point);

}  // namespace experiments::lab
