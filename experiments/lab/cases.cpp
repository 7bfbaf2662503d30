// The laboratory's default cases.
#include "experiments/lab/lab.h"

namespace experiments::lab {
namespace {

constexpr MotionParameters kStill{}, kMoving{0.37f, 0.21f, 0}, kWhole{1, 0, 0}, kRotating{0, 0, 0.5f};

SignalParameters signal(SignalKind kind) {
  SignalParameters s;
  s.kind = kind;
  return s;
}

SignalParameters pulse(float period) {
  SignalParameters s = signal(SignalKind::pulse);
  s.period = period;
  return s;
}

SignalParameters stepTo(float high) {
  SignalParameters s = signal(SignalKind::step);
  s.high = high;
  return s;
}

SignalParameters spot() {
  SignalParameters s = signal(SignalKind::spot);
  s.amplitude = 2;
  s.period = 90;
  return s;
}

SignalParameters stripes(SignalKind kind, float size, bool separate = false) {
  SignalParameters s = signal(kind);
  s.size = size;
  s.separate = separate;
  return s;
}

NoiseParameters noise(float sigma, float held = 0, bool shared = false, float fireflies = 0) {
  NoiseParameters n;
  n.sigma = sigma;
  n.held = held;
  n.shared = shared;
  n.fireflies = fireflies;
  return n;
}

PatternParameters pattern(PatternKind kind, float most) {
  PatternParameters p;
  p.kind = kind;
  p.most = most;
  return p;
}

PatternParameters fovea(float inside, float outside) {
  PatternParameters p;
  p.foveation.inside = inside;
  p.foveation.outside = outside;
  return p;
}

/// What the blends were first modelled on: smooth signals, independent samples, the moving fovea.
void addSmooth(std::vector<Case>& cases) {
  const NoiseParameters gamma = noise(1.5f);
  cases.push_back({"constant", signal(SignalKind::constant), gamma, kStill, {}, false});
  cases.push_back({"constant-moving", signal(SignalKind::constant), gamma, kMoving, {}, false});
  cases.push_back({"pulse", pulse(32), gamma, kStill, {}, false});
  cases.push_back({"pulse-moving", pulse(32), gamma, kMoving, {}, false});
  cases.push_back({"pulse-fast-moving", pulse(12), gamma, kMoving, {}, false});
  cases.push_back({"pulse-slow-moving", pulse(96), gamma, kMoving, {}, false});
  cases.push_back({"ramp-up-moving", signal(SignalKind::ramp), gamma, kMoving, {}, false});
  SignalParameters down = signal(SignalKind::ramp);
  down.rate = -down.rate;
  cases.push_back({"ramp-down-moving", down, gamma, kMoving, {}, false});
  cases.push_back({"step-up", stepTo(3), gamma, kStill, {}, false});
  cases.push_back({"step-down-moving", stepTo(0.33f), gamma, kMoving, {}, false});
  cases.push_back({"spot", spot(), gamma, kStill, {}, false});
  cases.push_back({"spot-moving", spot(), gamma, kMoving, {}, false});
  cases.push_back({"spot-rotating", spot(), gamma, kRotating, {}, false});
}

/// Edges, fine texture, hard shadows.
void addEdges(std::vector<Case>& cases) {
  const NoiseParameters gamma = noise(1.5f), quiet = noise(0.5f);
  cases.push_back({"edge-moving", stripes(SignalKind::edge, 16), gamma, kMoving, {}, false});
  cases.push_back({"edge-separate-moving", stripes(SignalKind::edge, 16, true), gamma, kMoving, {}, false});
  cases.push_back({"edge-quiet-moving", stripes(SignalKind::edge, 16), quiet, kMoving, {}, false});
  cases.push_back({"texture-moving", stripes(SignalKind::texture, 3), gamma, kMoving, {}, false});
  cases.push_back({"texture-quiet-moving", stripes(SignalKind::texture, 3), quiet, kMoving, {}, false});
  cases.push_back({"texture-whole", stripes(SignalKind::texture, 3), gamma, kWhole, {}, false});
  cases.push_back({"shadow-moving", stripes(SignalKind::shadow, 24), gamma, kMoving, {}, false});
}

/// Samples that are not independent, or not tame.
void addNoises(std::vector<Case>& cases) {
  cases.push_back({"held-constant-moving", signal(SignalKind::constant), noise(1.5f, 0.9f), kMoving, {}, false});
  cases.push_back({"held-spot", spot(), noise(1.5f, 0.9f), kStill, {}, false});
  cases.push_back({"shared-constant-moving", signal(SignalKind::constant), noise(1.5f, 0, true), kMoving, {}, false});
  cases.push_back({"held-shared-spot-moving", spot(), noise(1, 0.8f, true), kMoving, {}, false});
  const NoiseParameters fireflies = noise(1, 0, false, 1e-3f);
  cases.push_back({"fireflies-constant-moving", signal(SignalKind::constant), fireflies, kMoving, {}, false});
  cases.push_back({"fireflies-spot-moving", spot(), fireflies, kMoving, {}, false});
}

/// Other ways to place samples.
void addPatterns(std::vector<Case>& cases) {
  const NoiseParameters gamma = noise(1.5f);
  cases.push_back({"fovea16-constant-moving", signal(SignalKind::constant), gamma, kMoving, fovea(16, 1), false});
  cases.push_back({"fovea4-0-spot", spot(), gamma, kStill, fovea(4, 0), false});
  cases.push_back({"checkerboard-spot-moving", spot(), gamma, kMoving, pattern(PatternKind::checkerboard, 2), false});
  cases.push_back({"random-pulse-moving", pulse(32), gamma, kMoving, pattern(PatternKind::random, 4), false});
  cases.push_back({"single-spot-moving", spot(), gamma, kMoving, pattern(PatternKind::constant, 1), false});
}

/// With the spatial filter, its first level fed back.
void addFiltered(std::vector<Case>& cases) {
  const NoiseParameters gamma = noise(1.5f), reused = noise(1, 0.8f, true), fireflies = noise(1, 0, false, 1e-3f);
  cases.push_back({"filter-constant-moving", signal(SignalKind::constant), gamma, kMoving, {}, true});
  cases.push_back({"filter-pulse-moving", pulse(32), gamma, kMoving, {}, true});
  cases.push_back({"filter-spot-moving", spot(), gamma, kMoving, {}, true});
  cases.push_back({"filter-edge-moving", stripes(SignalKind::edge, 16), gamma, kMoving, {}, true});
  cases.push_back({"filter-texture-quiet-moving", stripes(SignalKind::texture, 3), noise(0.5f), kMoving, {}, true});
  cases.push_back({"filter-shadow-moving", stripes(SignalKind::shadow, 24), gamma, kMoving, {}, true});
  cases.push_back({"filter-reused-spot-moving", spot(), reused, kMoving, {}, true});
  cases.push_back({"filter-fireflies-spot-moving", spot(), fireflies, kMoving, {}, true});
}

}  // namespace

std::vector<Case> defaultCases() {
  std::vector<Case> cases;
  addSmooth(cases);
  addEdges(cases);
  addNoises(cases);
  addPatterns(cases);
  addFiltered(cases);
  return cases;
}

std::vector<Json> defaultVariants() {
  return {"unweighted", "unweighted-96", "unweighted-98", "weighted", "published", "optimal",
          "seed",       "seed-slide",    "consistent",    "lag-uw",   "lag-wf",    "lag-safe",
          "lag-uwf",    "lag-checked",   "lag-debiased",  "lag-even", "oracle"};
}

}  // namespace experiments::lab
