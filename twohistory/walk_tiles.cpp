#include "twohistory/walk_tiles.h"

#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "twohistory/tile_place.h"

namespace twohistory {
namespace {

constexpr float kLastPlace = kReferenceRates - 1;

/// u at a place of the ladder.
float rateAt(int place) { return std::ldexp(1.0f, -2 * place); }

/// log2 of x > 0, linear between powers of two: at most .09 off.
float roughLog2(float x) { return static_cast<float>(std::bit_cast<std::int32_t>(x) - 0x3f800000) * 0x1p-23f; }

float placeOf(float death) { return std::clamp(-0.5f * roughLog2(death), 0.0f, kLastPlace); }

/// One frame's steps s along kReach covariances that lie `stride` apart, the first of them of no distance.
void walk(float* r, int stride, float s) {
  const float here = r[0], one = r[stride], two = r[2 * stride], beyond = one > two ? two * two / one : two;
  r[0] = (1 - s) * here + s * one;
  r[stride] = (1 - s) * one + 0.5f * s * (here + two);
  r[2 * stride] = (1 - s) * two + 0.5f * s * (one + beyond);
}

}  // namespace

template <class Add>
void ReferenceWalk::between(float place, const Add& add) const {
  const int first = std::min(static_cast<int>(place), kReferenceRates - 2);
  const float second = place - static_cast<float>(first);
  for (int t = 0; t < 4; ++t) {
    add((*tile[t])[first], part[t] * (1 - second));
    add((*tile[t])[first + 1], part[t] * second);
  }
}

ReferenceNoise ReferenceWalk::neighbours(float place) const {
  ReferenceNoise sum;
  between(place, [&](const ReferenceNoise& n, float b) {
    sum.row += b * n.row, sum.column += b * n.column, sum.diagonal += b * n.diagonal;
    sum.share += b * n.share, sum.meanAge += b * n.meanAge;
  });
  return sum;
}

OlderNoise<float> ReferenceWalk::older(const TapPairs& pairs, const Remembered<float>& history) const {
  constexpr float kAsOld = 0.98f;  // ages this near the reference's are the same
  const float death = deathRate(history.factor), place = placeOf(death);
  ReferenceNoise noise = neighbours(place);
  if (place > 0 && history.ageSum < kAsOld * noise.meanAge * history.weight) {
    const float younger = deathRateOfAge(history.ageSum / history.weight) / deathRateOfAge(noise.meanAge);
    noise = neighbours(placeOf(death * younger));  // [ledger young]
  }
  return {noise.share, pairs.row * noise.row + pairs.column * noise.column + pairs.diagonal * noise.diagonal};
}

EdgeNoise<float> ReferenceWalk::edge(const TapPairs& pairs, const Arrival& arrival, const Remembered<float>& history,
                                     float perNoise) const {
  const float death = deathRate(history.factor);
  EdgeWalk<float> row, column;
  between(placeOf(death), [&](const ReferenceNoise& n, float b) {
    row.noise += b * n.alongRow.noise, row.alike += b * n.alongRow.alike;
    column.noise += b * n.alongColumn.noise, column.alike += b * n.alongColumn.alike;
  });
  return edgeNoise(pairs, arrival, row, column, death, stillNoise(history.weight * perNoise, death));
}

WalkTiles::WalkTiles(int width, int height)
    : width_(width),
      now_((width + kSide - 1) / kSide, (height + kSide - 1) / kSide, Tile{}),
      before_(now_),
      rates_(now_.width(), now_.height(), ReferenceWalk::Rates{}) {}

ReferenceWalk WalkTiles::at(std::int32_t pixel) const {
  const core::vec2 position(pixel % width_, pixel / width_);
  const TilePlace p(position.x, position.y, kSide, now_.width(), now_.height());
  return {{&rates_(p.i0, p.j0), &rates_(p.i1, p.j0), &rates_(p.i0, p.j1), &rates_(p.i1, p.j1)},
          {(1 - p.a) * (1 - p.b), p.a * (1 - p.b), (1 - p.a) * p.b, p.a * p.b}};
}

WalkTiles::Tile WalkTiles::mixedAt(core::vec2 position) const {
  const TilePlace p(position.x, position.y, kSide, now_.width(), now_.height());
  const Tile &a = now_(p.i0, p.j0), &b = now_(p.i1, p.j0), &c = now_(p.i0, p.j1), &d = now_(p.i1, p.j1);
  Tile mixed;
  for (int k = 0; k < kReferenceRates; ++k) {
    const auto mix = [&](const auto& of) {
      for (int i = 0; i < kReach; ++i)
        of(mixed.lags[k])[i] = p.mix(of(a.lags[k])[i], of(b.lags[k])[i], of(c.lags[k])[i], of(d.lags[k])[i]);
    };
    for (int j = 0; j < kReach; ++j) mix([j](auto& lags) -> auto& { return lags.r[j]; });
    mix([](auto& lags) -> auto& { return lags.alongRow; });
    mix([](auto& lags) -> auto& { return lags.alongColumn; });
  }
  mixed.frames = p.mix(a.frames, b.frames, c.frames, d.frames);
  return mixed;
}

void WalkTiles::step(Lags& lags, const WalkSteps<float>& s, float kept) {
  for (Line& row : lags.r) walk(row.data(), 1, s.x);
  for (int i = 0; i < kReach; ++i) walk(&lags.r[0][i], kReach, s.y);
  walk(lags.alongRow.data(), 1, s.x);
  walk(lags.alongColumn.data(), 1, s.y);
  for (Line* line : {&lags.r[0], &lags.r[1], &lags.r[2], &lags.alongRow, &lags.alongColumn})
    for (float& r : *line) r *= kept;
  lags.r[0][0] += 1, lags.alongRow[0] += 1, lags.alongColumn[0] += 1;  // [ledger reference]
}

WalkTiles::Tile WalkTiles::next(const TileMotion& motion) const {
  Tile tile;
  if (!motion.isNew) tile = mixedAt(motion.from);
  for (int k = 0; k < kReferenceRates; ++k) step(tile.lags[k], motion.steps, 1 / (1 + rateAt(k)));
  tile.frames = std::min(tile.frames + 1, 1e6f);
  return tile;
}

ReferenceNoise WalkTiles::noiseOf(const Lags& lags, float frames, float death) {
  const auto& r = lags.r;
  const float older = r[0][0] - 1, one = older > 1e-6f ? 1 / older : 0.0f;
  const float d = 1 / std::sqrt(1 + death), left = std::pow(d, frames);
  const float meanAge = d / (1 - d) - (left < 1 ? frames * left / (1 - left) : 0.0f);
  const float still = (1 - left * left) * (1 + 1 / death);  // of what never steps
  const auto along = [&](const Line& line) {
    return EdgeWalk<float>{std::min(1.0f, line[0] / still), line[1] / line[0]};  // [ledger along]
  };
  return {one * r[0][1],           one * r[1][0],        one * r[1][1],          older / r[0][0],  // [ledger older]
          std::max(0.0f, meanAge), along(lags.alongRow), along(lags.alongColumn)};
}

void WalkTiles::update(core::In<Taps> taps) {
  CHECK_EQ(taps.width, width_);
  core::forEachTile(
      taps.width, taps.height,
      [&](int x0, int y0, int x1, int y1) {
        before_(x0 / kSide, y0 / kSide) = next(tileMotion(taps, {x0, y0}, {x1, y1}));
      },
      kSide);
  std::swap(now_, before_);
  core::forEachPixel(now_.width(), now_.height(), [&](int i, int j) {
    const Tile& tile = now_(i, j);
    for (int k = 0; k < kReferenceRates; ++k) rates_(i, j)[k] = noiseOf(tile.lags[k], tile.frames, rateAt(k));
  });
}

}  // namespace twohistory
