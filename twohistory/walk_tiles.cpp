#include "twohistory/walk_tiles.h"

#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "twohistory/tile_place.h"

namespace twohistory {
namespace {

constexpr float kLastPlace = kReferenceRates - 1;

constexpr int kOctaves = 2;      // between rates
constexpr float kAsOld = 0.98f;  // of the reference's mean age: as old as it

/// u at a place of the ladder.
float rateAt(int place) { return std::ldexp(1.0f, -kOctaves * place); }

/// log2 of x > 0, linear between powers of two: at most .09 off.
float roughLog2(float x) { return static_cast<float>(std::bit_cast<std::int32_t>(x) - 0x3f800000) * 0x1p-23f; }

float placeOfRate(float death) { return std::clamp(roughLog2(death) / -kOctaves, 0.0f, kLastPlace); }

/// One frame's steps s along kReach covariances that lie `stride` apart, the first of them of no distance.
void walk(float* r, int stride, float s) {
  static_assert(WalkTiles::kReach == 3);
  const float here = r[0], one = r[stride], two = r[2 * stride], beyond = one > two ? two * two / one : two;
  r[0] = (1 - s) * here + s * one;
  r[stride] = (1 - s) * one + 0.5f * s * (here + two);
  r[2 * stride] = (1 - s) * two + 0.5f * s * (one + beyond);
}

}  // namespace

/// Calls add(noise, part) for each tile and the two rates next to a place.
template <class Add>
void ReferenceWalk::between(float place, const Add& add) const {
  const int first = std::min(static_cast<int>(place), kReferenceRates - 2);
  const float second = place - static_cast<float>(first);
  for (int t = 0; t < 4; ++t) {
    add((*tile[t])[first], part[t] * (1 - second));
    add((*tile[t])[first + 1], part[t] * second);
  }
}

float ReferenceWalk::placeOf(const Remembered<float>& history) const {
  const float death = std::max(deathRate(history.factor), rateAt(kReferenceRates - 1)), place = placeOfRate(death);
  if (!(place > 0) || !(history.weight > 0)) return place;
  float reference = 0;
  between(place, [&](const ReferenceNoise& n, float b) { reference += b * n.meanAge; });
  const float age = history.ageSum / history.weight;
  if (!(age < kAsOld * reference)) return place;
  return placeOfRate(death + deathRateOfAge(age) - deathRateOfAge(reference));  // [ledger young]
}

OlderNoise<float> ReferenceWalk::older(const TapPairs& pairs, const Remembered<float>& history) const {
  float here = 0, row = 0, column = 0, diagonal = 0;
  between(placeOf(history), [&](const ReferenceNoise& n, float b) {
    here += b * n.here, row += b * n.row, column += b * n.column, diagonal += b * n.diagonal;
  });
  const float older = here - 1;
  if (!(older > 1e-6f)) return {};
  return {older / here,
          (pairs.row * row + pairs.column * column + pairs.diagonal * diagonal) / older};  // [ledger older]
}

EdgeNoise<float> ReferenceWalk::edge(const TapPairs& pairs, const Arrival& arrival, const Remembered<float>& history,
                                     float perNoise) const {
  EdgeWalks<float> walks{};
  between(placeOf(history), [&](const ReferenceNoise& n, float b) {
    walks.row.noise += b * n.alongRow.noise, walks.row.alike += b * n.alongRow.alike;
    walks.column.noise += b * n.alongColumn.noise, walks.column.alike += b * n.alongColumn.alike;
  });
  const float death = deathRate(history.factor);
  return edgeNoise(pairs, arrival, walks, death, stillNoise(history.weight, perNoise, death));
}

WalkTiles::WalkTiles(int width, int height)
    : width_(width),
      height_(height),
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
    const auto mix = [&](auto Lags::*of) {
      for (std::size_t i = 0; i < (mixed.lags[k].*of).size(); ++i)
        (mixed.lags[k].*of)[i] = p.mix((a.lags[k].*of)[i], (b.lags[k].*of)[i], (c.lags[k].*of)[i], (d.lags[k].*of)[i]);
    };
    mix(&Lags::r), mix(&Lags::alongRow), mix(&Lags::alongColumn);
  }
  mixed.frames = p.mix(a.frames, b.frames, c.frames, d.frames);
  return mixed;
}

void WalkTiles::step(Lags& lags, const WalkSteps<float>& s, float kept) {
  for (int i = 0; i < kReach; ++i) walk(&lags.r[i * kReach], 1, s.x);
  for (int i = 0; i < kReach; ++i) walk(&lags.r[i], kReach, s.y);
  walk(lags.alongRow.data(), 1, s.x);
  walk(lags.alongColumn.data(), 1, s.y);
  for (float& r : lags.r) r *= kept;
  for (int i = 0; i < kReach; ++i) lags.alongRow[i] *= kept, lags.alongColumn[i] *= kept;
  lags.r[0] += 1, lags.alongRow[0] += 1, lags.alongColumn[0] += 1;  // [ledger reference]
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
  const float d = 1 / std::sqrt(1 + death), left = std::pow(d, frames);
  const float meanAge = d / (1 - d) - (left < 1 ? frames * left / (1 - left) : 0.0f);
  const float still = (1 - left * left) * (1 + 1 / death);  // of what never steps
  const auto along = [&](const std::array<float, kReach>& line) {
    return EdgeWalk<float>{std::min(1.0f, line[0] / still), line[1] / line[0]};  // [ledger along]
  };
  return {r[0], r[1], r[kReach], r[kReach + 1], std::max(0.0f, meanAge), along(lags.alongRow), along(lags.alongColumn)};
}

void WalkTiles::update(core::In<Taps> taps) {
  CHECK_EQ(taps.width, width_);
  CHECK_EQ(taps.height, height_);
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
