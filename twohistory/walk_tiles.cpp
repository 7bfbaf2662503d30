#include "twohistory/walk_tiles.h"

#include <cmath>

#include "core/parallel.h"
#include "twohistory/tile_place.h"

namespace twohistory {
namespace {

constexpr float kNothing = 1e-30f;  // less noise is none

/// What comes after a, b, c: the logarithm goes on as a parabola, or, if that bends upwards, as a line.
float goneOn(float a, float b, float c) {
  if (!(b > c)) return c;
  const float falls = c / b;
  return c * falls * std::min(1.0f, falls * a / b);
}

/// One frame's steps s along kReach covariances that lie `stride` apart, the first of them of no distance.
void walk(float* r, int stride, float s) {
  static_assert(WalkTiles::kReach == 3);
  const float here = r[0], one = r[stride], two = r[2 * stride], beyond = goneOn(here, one, two);
  r[0] = (1 - s) * here + s * one;
  r[stride] = (1 - s) * one + 0.5f * s * (here + two);
  r[2 * stride] = (1 - s) * two + 0.5f * s * (one + beyond);
}

}  // namespace

WalkTiles::WalkTiles(int width, int height)
    : width_(width),
      height_(height),
      now_((width + kSide - 1) / kSide, (height + kSide - 1) / kSide, Tile{}),
      before_(now_),
      noise_(now_.width(), now_.height(), TileNoise{}) {}

ReferenceWalk WalkTiles::at(std::int32_t pixel) const {
  const core::vec2 position(pixel % width_, pixel / width_);
  const TilePlace p(position.x, position.y, kSide, now_.width(), now_.height());
  return {{&noise_(p.i0, p.j0), &noise_(p.i1, p.j0), &noise_(p.i0, p.j1), &noise_(p.i1, p.j1)},
          {(1 - p.a) * (1 - p.b), p.a * (1 - p.b), (1 - p.a) * p.b, p.a * p.b}};
}

WalkTiles::TileSamples WalkTiles::samplesOf(const SampleCounts& counts, int width, core::ivec2 first, core::ivec2 end) {
  float some = 0, inverse = 0, samples = 0, pixels = 0;
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) {
      const float n = counts.at(y * width + x);
      if (n > 0) some += 1, inverse += 1 / n, samples += n;
      pixels += 1;
    }
  return {{inverse / pixels, samples / pixels}, {some / pixels, samples / pixels}};
}

WalkTiles::Tile WalkTiles::mixedAt(core::vec2 position) const {
  const TilePlace p(position.x, position.y, kSide, now_.width(), now_.height());
  Tile mixed;
  const auto add = [&mixed](const Tile& tile, float b) {
    const auto addTo = [b](auto& sums, const auto& values) {
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += b * values[i];
    };
    for (int r = 0; r < kReferenceRates; ++r)
      for (int k = 0; k < kReferences; ++k) {
        Reference& sum = mixed.references[r][k];
        const Reference& from = tile.references[r][k];
        addTo(sum.lags, from.lags), addTo(sum.alongRow, from.alongRow), addTo(sum.alongColumn, from.alongColumn);
        sum.still += b * from.still, sum.weight += b * from.weight, sum.ageSum += b * from.ageSum;
      }
    mixed.frames += b * tile.frames;
  };
  add(now_(p.i0, p.j0), (1 - p.a) * (1 - p.b)), add(now_(p.i1, p.j0), p.a * (1 - p.b));
  add(now_(p.i0, p.j1), (1 - p.a) * p.b), add(now_(p.i1, p.j1), p.a * p.b);
  return mixed;
}

void WalkTiles::step(Reference& reference, const WalkSteps<float>& s, float kept, float noise, float weight) {
  auto& [lags, row, column, still, weights, ages] = reference;
  for (int i = 0; i < kReach; ++i) walk(&lags[i * kReach], 1, s.x);
  for (int i = 0; i < kReach; ++i) walk(&lags[i], kReach, s.y);
  walk(row.data(), 1, s.x), walk(column.data(), 1, s.y);
  for (float& r : lags) r *= kept;
  for (int i = 0; i < kReach; ++i) row[i] *= kept, column[i] *= kept;
  lags[0] += noise, row[0] += noise, column[0] += noise;  // [ledger reference]
  still = kept * still + noise;
  const float d = std::sqrt(kept);
  ages = d * (ages + weights);
  weights = d * weights + weight;
  if (!(still > kNothing)) reference = {};
}

WalkTiles::Tile WalkTiles::next(const TileMotion& motion, const TileSamples& samples) const {
  Tile tile;
  if (!motion.isNew) tile = mixedAt(motion.from);
  for (int r = 0; r < kReferenceRates; ++r)
    for (int k = 0; k < kReferences; ++k)
      step(tile.references[r][k], motion.steps, 1 / (1 + referenceRate(r)), samples.noise[k], samples.weight[k]);
  tile.last = samples.noise;
  tile.frames = std::min(tile.frames + 1, 1e6f);
  return tile;
}

ReferenceNoise WalkTiles::noiseOf(const Reference& of, float fresh) {
  const auto along = [&](const Line& line) {
    return EdgeWalk<float>{std::min(1.0f, line[0] / of.still), line[1] / line[0]};  // [ledger along]
  };
  if (!(of.lags[0] > kNothing)) return {};
  return {{of.lags[0], of.lags[0] - fresh, of.lags[1], of.lags[kReach], of.lags[kReach + 1]},
          of.lags[0] / of.still,
          of.ageSum / of.weight,
          along(of.alongRow),
          along(of.alongColumn)};
}

TileNoise WalkTiles::noiseOf(const Tile& tile) {
  TileNoise noise;
  for (int r = 0; r < kReferenceRates; ++r)
    for (int k = 0; k < kReferences; ++k) noise.references[r][k] = noiseOf(tile.references[r][k], tile.last[k]);
  constexpr int kFaster = 2, kSlower = 3;
  const float faster = 1 / (1 + referenceRate(kFaster)), slower = 1 / (1 + referenceRate(kSlower));
  const auto all = [&](float kept) { return (1 - std::pow(kept, tile.frames)) / (1 - kept); };
  const float allFaster = all(faster), allSlower = all(slower);
  for (int k = 0; k < kReferences; ++k)
    noise.regimes[k] = NoiseRegime::of(tile.last[k], tile.references[kFaster][k].still / allFaster,
                                       tile.references[kSlower][k].still / allSlower, faster, slower);
  return noise;
}

void WalkTiles::update(core::In<Taps> taps, const SampleCounts& counts) {
  CHECK_EQ(taps.width, width_);
  CHECK_EQ(taps.height, height_);
  core::forEachTile(
      taps.width, taps.height,
      [&](int x0, int y0, int x1, int y1) {
        const core::ivec2 first(x0, y0), end(x1, y1);
        Tile& tile = before_(x0 / kSide, y0 / kSide);
        tile = next(tileMotion(taps, first, end), samplesOf(counts, width_, first, end));
        noise_(x0 / kSide, y0 / kSide) = noiseOf(tile);
      },
      kSide);
  std::swap(now_, before_);
}

}  // namespace twohistory
