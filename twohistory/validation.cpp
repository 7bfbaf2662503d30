#include "twohistory/validation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "twohistory/combination.h"
#include "twohistory/tile_place.h"

namespace twohistory {

UsualCount::UsualCount(std::span<const Policy> policies) {
  for (std::size_t j = 0; j < policies.size(); ++j) {
    if (policies[j].forgetting != Forgetting::decay || !(policies[j].amount < 1)) continue;
    int& slot = policies[j].weighting == Weighting::frames ? frames_ : samples_;
    if (slot < 0) slot = static_cast<int>(j);
  }
  if (frames_ >= 0 && samples_ >= 0)
    scale_ = static_cast<float>((1 - policies[static_cast<std::size_t>(samples_)].amount) /
                                (1 - policies[static_cast<std::size_t>(frames_)].amount));
}

void Evidence::add(const Innovation& r, const ColourShifts& shift) {
  const core::dvec3 v(r.value);
  const double w = static_cast<double>(r.weight) / 3;  // dot products as means over channels
  int next = kShifts;
  for (int j = 0; j < kShifts; ++j) {
    const core::dvec3 d = w * core::dvec3(shift[j]);
    sum[j] += dot(d, v);
    for (int k = 0; k <= j; ++k) sum[next++] += dot(d, core::dvec3(shift[k]));
  }
  sum[next++] += w * dot(v, v), ++sum[next];
}

void Evidence::accumulate(const Stored& other, double factor) {
  for (int i = 0; i < kSums; ++i) sum[i] += factor * static_cast<double>(other[i]);
}

Evidence::Stored Evidence::stored() const {
  Stored s;
  std::transform(sum.begin(), sum.end(), s.begin(), [](double v) { return static_cast<float>(v); });
  return s;
}

namespace {

using System = Matrix<kShifts, double>;
using Vector = std::array<double, kShifts>;

/// The least of theta' m theta - 2 right' theta where each theta_i is 0, 1 or free, as the i-th ternary digit of
/// `face` says.
Vector leastOnFace(const System& m, const Vector& right, int face, double ridge) {
  System free{};
  Vector fixed{}, known{};
  std::array<bool, kShifts> isFree{};
  for (int i = 0; i < kShifts; ++i, face /= 3) isFree[i] = face % 3 == 2, fixed[i] = isFree[i] ? 0 : face % 3;
  for (int i = 0; i < kShifts; ++i) {
    known[i] = isFree[i] ? right[i] : fixed[i];
    for (int j = 0; j < kShifts; ++j) {
      free[i][j] = isFree[i] && isFree[j] ? m[i][j] : double(i == j);
      if (isFree[i]) known[i] -= m[i][j] * fixed[j];
    }
  }
  Vector theta = solvePositive<kShifts, double>(free, known, ridge);
  for (int i = 0; i < kShifts; ++i)
    if (!isFree[i]) theta[i] = fixed[i];
  return theta;
}

/// The same over the unit cube: the least is on one of its 27 faces, edges and corners, its inside included.
Vector leastInCube(const System& m, const Vector& right) {
  constexpr int kFaces = 27;
  double trace = 0, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kShifts; ++i) trace += m[i][i];
  Vector best{};
  for (int face = 0; face < kFaces; ++face) {
    const Vector theta = leastOnFace(m, right, face, 1e-12 * trace);
    double value = 0;
    bool inside = true;
    for (int i = 0; i < kShifts; ++i) {
      inside &= theta[i] >= 0 && theta[i] <= 1;
      value -= 2 * right[i] * theta[i];
      for (int j = 0; j < kShifts; ++j) value += theta[i] * m[i][j] * theta[j];
    }
    if (inside && value < least) least = value, best = theta;
  }
  return best;
}

}  // namespace

Shifts Evidence::solveWith(const ValidationParameters& p, const Prior& correction) const {
  Shifts result{1, 1, correction.mean};
  const double residual = sum[kSums - 2], count = sum[kSums - 1];
  if (!(count > 0) || !(residual > 0)) return result;
  System m;
  Vector right;
  int next = kShifts;
  for (int j = 0; j < kShifts; ++j) {
    const double tau = static_cast<double>(j == kCorrection ? correction.deviation : p.trust);
    const double prior = residual / count / (tau * tau);  // [check prior]
    right[j] = sum[j] + (j == kCorrection ? static_cast<double>(correction.mean) : 1) * prior;
    for (int k = 0; k <= j; ++k) m[j][k] = m[k][j] = sum[next++] + (j == k ? prior : 0);
  }
  const Vector theta = leastInCube(m, right);  // [check theta]
  std::transform(theta.begin(), theta.end(), result.begin(), [](double v) { return static_cast<float>(v); });
  return result;
}

void Validation::fit(int width, int height, const UsualCount& usual) {
  usual_ = usual;
  if (booked_.width() == width && booked_.height() == height) return;
  booked_ = core::Image<Booked>(width, height);
  evidence_ = core::Image<TileEvidence>((width + kTile - 1) / kTile, (height + kTile - 1) / kTile);
  std::array<Shifts, kRegimes> all;
  all.fill(Evidence{}.solve({}));
  keep_ = core::Image<std::array<Shifts, kRegimes>>(evidence_.width(), evidence_.height(), all);
}

void Validation::solve(const ValidationParameters& p) {
  const int width = keep_.width(), height = keep_.height();
  std::array<Evidence, kRegimes> all;
  const double weight = static_cast<double>(p.shared) / (width * height);
  for (int i = 0; i < width * height; ++i)
    for (int c = 0; c < kRegimes; ++c) all[c].accumulate(evidence_.data()[i][c], weight);
  core::forEachPixel(width, height, [&](int x, int y) {
    std::array<Evidence, kRegimes> sum = all;
    Evidence pooled;
    for (int c = 0; c < kRegimes; ++c) {
      for (int v = std::max(0, y - 1); v <= std::min(y + 1, height - 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(x + 1, width - 1); ++u) sum[c].accumulate(evidence_(u, v)[c], 1);
      pooled.accumulate(sum[c].stored(), 1);
    }
    const float share = pooled.solve(p)[kCorrection], proven = share * share * share * share;  // [check proven]
    for (int c = 0; c < kRegimes; ++c) keep_(x, y)[c] = sum[c].solve(p, proven);
  });
}

Shifts Validation::keep(int x, int y, Regime regime) const {
  const TilePlace p(x, y, kTile, keep_.width(), keep_.height());
  const auto c = static_cast<std::size_t>(regime);
  Shifts out;
  for (int k = 0; k < kShifts; ++k)
    out[k] = p.mix(keep_(p.i0, p.j0)[c][k], keep_(p.i1, p.j0)[c][k], keep_(p.i0, p.j1)[c][k], keep_(p.i1, p.j1)[c][k]);
  return out;
}

}  // namespace twohistory
