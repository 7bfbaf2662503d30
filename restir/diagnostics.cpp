// Reading ages, duplicates and counts off the reservoirs.
#include "restir/diagnostics.h"

namespace restir {
namespace {

bool holdsSample(const Reservoir& r) { return r.unbiasedWeight > 0 && r.sample.valid(); }

bool sameSample(const Reservoir& a, const Reservoir& b) {
  return a.sample.light == b.sample.light && a.sample.uv == b.sample.uv;
}

float countDuplicates(In<Reservoir> reservoirs, int x, int y) {
  constexpr int kReach = Diagnostics::kReach;
  const Reservoir& here = reservoirs(x, y);
  if (!holdsSample(here)) return 0;
  int count = -1;  // without the pixel itself
  for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, reservoirs.height - 1); ++v)
    for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, reservoirs.width - 1); ++u)
      count += holdsSample(reservoirs(u, v)) && sameSample(reservoirs(u, v), here);
  return static_cast<float>(count);
}

}  // namespace

Diagnostics::Diagnostics(int width, int height)
    : age_(width, height, -1),
      ageBefore_(width, height, -1),
      confidence_(width, height),
      duplicates_(width, height),
      effective_(width, height) {}

/// A sample that the chosen tap of the frame before holds too has come from there.
float Diagnostics::ageOf(const RestirState& state, const Reservoir& r, int x, int y) const {
  if (!holdsSample(r)) return -1;
  const Taps& taps = state.taps(x, y);
  if (!taps.valid() || sameSample(r, state.fresh(x, y))) return 0;
  const std::int32_t tap = taps.pixel[0];
  const Reservoir& old = state.before.view().at(tap);
  return holdsSample(old) && sameSample(old, r) ? ageBefore_.view().at(tap) + 1 : 0;
}

void Diagnostics::update(const RestirParameters& p, const Frame& frame, const RestirState& state) {
  std::swap(age_, ageBefore_);
  const bool reuses = p.reuse != Reuse::none;
  core::forEachPixel(
      age_.width(), age_.height(),
      [&](int x, int y) {
        const bool surface = frame.now.surfaces(x, y).hit();
        const bool kept = surface && reuses;
        age_(x, y) = kept ? ageOf(state, state.now(x, y), x, y) : -1.0f;
        confidence_(x, y) = kept ? state.now(x, y).confidence : 0.0f;
        duplicates_(x, y) = kept ? countDuplicates(state.now, x, y) : 0.0f;
        effective_(x, y) = !surface ? 0.0f : state.effective.empty() ? state.shaded(x, y) : state.effective(x, y);
      },
      frame.tile);
}

}  // namespace restir
