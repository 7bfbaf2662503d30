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

/// Mean age of a history that has kept d of its weight a frame, for so many frames.
float meanAgeAfter(float frames, float d) {
  const float lost = std::pow(d, frames);
  return d / (1 - d) - (lost < 1 ? frames * lost / (1 - lost) : 0.0f);
}

}  // namespace

ReferenceNoise ReferenceWalk::between(float place) const {
  const int first = std::min(static_cast<int>(place), kReferenceRates - 2);
  const float second = place - static_cast<float>(first);
  ReferenceNoise sum;
  const auto add = [&](const ReferenceNoise& n, float b) {
    sum.row += b * n.row, sum.column += b * n.column, sum.diagonal += b * n.diagonal;
    sum.share += b * n.share, sum.meanAge += b * n.meanAge;
  };
  for (int t = 0; t < 4; ++t)
    add((*tile[t])[first], part[t] * (1 - second)), add((*tile[t])[first + 1], part[t] * second);
  return sum;
}

OlderNoise<float> ReferenceWalk::older(const TapPairs& pairs, const Remembered<float>& history) const {
  constexpr float kAsOld = 0.98f;  // ages this near the reference's are the same
  const float death = deathRate(history.factor), place = placeOf(death);
  ReferenceNoise noise = between(place);
  if (place > 0 && history.ageSum < kAsOld * noise.meanAge * history.weight) {
    const float younger = deathRateOfAge(history.ageSum / history.weight) / deathRateOfAge(noise.meanAge);
    noise = between(placeOf(death * younger));  // [ledger young]
  }
  return {noise.share, pairs.row * noise.row + pairs.column * noise.column + pairs.diagonal * noise.diagonal};
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
  for (int k = 0; k < kReferenceRates; ++k)
    for (int j = 0; j < kReach; ++j)
      for (int i = 0; i < kReach; ++i) mixed.r[k][j][i] = p.mix(a.r[k][j][i], b.r[k][j][i], c.r[k][j][i], d.r[k][j][i]);
  mixed.frames = p.mix(a.frames, b.frames, c.frames, d.frames);
  return mixed;
}

/// One frame's steps along both axes; the rows first.
void WalkTiles::step(Lags& r, const WalkSteps<float>& s, float kept) {
  const auto stepped = [](float before, float here, float after, float step) {
    return (1 - step) * here + 0.5f * step * (before + after);
  };
  const auto beyond = [](float last, float previous) { return previous > last ? last * last / previous : last; };
  constexpr int kLast = kReach - 1;
  Lags half;
  for (int j = 0; j < kReach; ++j)
    for (int i = 0; i < kReach; ++i)  // R_-1 = R_1
      half[j][i] =
          stepped(r[j][i > 0 ? i - 1 : 1], r[j][i], i < kLast ? r[j][i + 1] : beyond(r[j][i], r[j][i - 1]), s.x);
  for (int j = 0; j < kReach; ++j)
    for (int i = 0; i < kReach; ++i)
      r[j][i] = kept * stepped(half[j > 0 ? j - 1 : 1][i], half[j][i],
                               j < kLast ? half[j + 1][i] : beyond(half[j][i], half[j - 1][i]), s.y);
  r[0][0] += 1;  // [ledger reference]
}

WalkTiles::Tile WalkTiles::next(const TileMotion& motion) const {
  Tile tile;
  if (!motion.isNew) tile = mixedAt(motion.from);
  for (int k = 0; k < kReferenceRates; ++k) step(tile.r[k], motion.steps, 1 / (1 + rateAt(k)));
  tile.frames = std::min(tile.frames + 1, 1e6f);
  return tile;
}

ReferenceWalk::Rates WalkTiles::ratesOf(const Tile& tile) {
  ReferenceWalk::Rates rates;
  for (int k = 0; k < kReferenceRates; ++k) {
    const Lags& r = tile.r[k];
    const float older = r[0][0] - 1, one = older > 1e-6f ? 1 / older : 0.0f;
    rates[k] = {one * r[0][1], one * r[1][0], one * r[1][1], older / r[0][0],  // [ledger older]
                meanAgeAfter(tile.frames, 1 / std::sqrt(1 + rateAt(k)))};
  }
  return rates;
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
  core::forEachPixel(now_.width(), now_.height(), [&](int i, int j) { rates_(i, j) = ratesOf(now_(i, j)); });
}

}  // namespace twohistory
