#include "twohistory/validation.h"

#include <algorithm>
#include <cmath>

namespace twohistory {

void Evidence::add(const Innovation& r, const Shifts& shift) {
  const double w = static_cast<double>(r.weight), v = static_cast<double>(r.value);
  const double a = static_cast<double>(shift[0]), b = static_cast<double>(shift[1]);
  product[0] += w * a * v, product[1] += w * b * v;
  square[0] += w * a * a, square[1] += w * a * b, square[2] += w * b * b;
  residual += w * v * v, ++count;
}

void Evidence::accumulate(const Evidence& other, double factor) {
  for (int i = 0; i < kShifts; ++i) product[i] += factor * other.product[i];
  for (int i = 0; i < 3; ++i) square[i] += factor * other.square[i];
  residual += factor * other.residual, count += factor * other.count;
}

// [check theta]
Shifts Evidence::solve(const ValidationParameters& p) const {
  if (!(count > 0) || !(residual > 0)) return {1, 1};
  const double tau = static_cast<double>(p.trust), r = residual / count / (tau * tau);
  const double a = square[0] + r, b = square[1], c = square[2] + r, u = product[0] + r, v = product[1] + r;
  const double determinant = a * c - b * b;
  double first = std::clamp((u * c - v * b) / determinant, 0.0, 1.0);
  const double second = std::clamp((v - b * first) / c, 0.0, 1.0);  // best given the first, which may have been clamped
  first = std::clamp((u - b * second) / a, 0.0, 1.0);
  return {static_cast<float>(first), static_cast<float>(second)};
}

void Validation::fit(int width, int height) {
  if (share_.width() == width && share_.height() == height) return;
  share_ = core::Image<Shares>(width, height);
  regime_ = core::Image<Regime>(width, height, Regime::equal);
  evidence_ = core::Image<TileEvidence>((width + kTile - 1) / kTile, (height + kTile - 1) / kTile);
  std::array<Shifts, kRegimes> all;
  for (Shifts& s : all) s.fill(1);
  keep_ = core::Image<std::array<Shifts, kRegimes>>(evidence_.width(), evidence_.height(), all);
}

void Validation::solve(const ValidationParameters& p) {
  const int width = keep_.width(), height = keep_.height();
  TileEvidence all;
  for (int i = 0; i < width * height; ++i)
    for (int c = 0; c < kRegimes; ++c) all[c].accumulate(evidence_.data()[i][c]);
  core::forEachPixel(width, height, [&](int x, int y) {
    for (int c = 0; c < kRegimes; ++c) {
      Evidence sum;
      sum.accumulate(all[c], static_cast<double>(p.shared));
      for (int v = std::max(0, y - 1); v <= std::min(y + 1, height - 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(x + 1, width - 1); ++u) sum.accumulate(evidence_(u, v)[c]);
      keep_(x, y)[c] = sum.solve(p);
    }
  });
}

Shifts Validation::keep(int x, int y, Regime regime) const {
  const auto place = [](int i, int tiles, int& first, int& second) {
    const float t = std::clamp((static_cast<float>(i) + 0.5f) / kTile - 0.5f, 0.0f, static_cast<float>(tiles - 1));
    first = static_cast<int>(t), second = std::min(first + 1, tiles - 1);
    return t - static_cast<float>(first);
  };
  int i0, i1, j0, j1;
  const float a = place(x, keep_.width(), i0, i1), b = place(y, keep_.height(), j0, j1);
  const auto c = static_cast<std::size_t>(regime);
  Shifts out;
  for (int k = 0; k < kShifts; ++k)
    out[k] = (1 - b) * ((1 - a) * keep_(i0, j0)[c][k] + a * keep_(i1, j0)[c][k]) +
             b * ((1 - a) * keep_(i0, j1)[c][k] + a * keep_(i1, j1)[c][k]);
  return out;
}

}  // namespace twohistory
