#include "twohistory/reference_walk.h"

#include <bit>
#include <cmath>

namespace twohistory {
namespace {

constexpr int kOctaves = 2;  // between rates
constexpr float kLastPlace = kReferenceRates - 1;

constexpr float kAsOld = 0.98f;  // of the reference's mean age: as old as it
constexpr float kSame = 1e-3f;   // shares and ages so close are those of references whose counts have not changed

/// log2 of x > 0, linear between powers of two: at most .09 off.
float roughLog2(float x) { return static_cast<float>(std::bit_cast<std::int32_t>(x) - 0x3f800000) * 0x1p-23f; }

float placeOfRate(float death) { return std::clamp(roughLog2(death) / -kOctaves, 0.0f, kLastPlace); }

float slowest() { return referenceRate(kReferenceRates - 1); }

/// Where `value` lies between both references' in [0, 1]; half way where they are the same.
float placeBetween(const OfReferences<float>& of, float value, float same) {
  const float span = of[1] - of[0];
  return std::abs(span) > same ? std::clamp((value - of[0]) / span, 0.0f, 1.0f) : 0.5f;  // [ledger between]
}

float mixed(const OfReferences<float>& of, float t) { return of[0] + t * (of[1] - of[0]); }

}  // namespace

float referenceRate(int place) { return std::ldexp(1.0f, -kOctaves * place); }

/// Calls add(k, noise of reference k, part) for each tile and the two rates next to a place.
template <class Add>
void ReferenceWalk::between(float place, const Add& add) const {
  const int first = std::min(static_cast<int>(place), kReferenceRates - 2);
  const float second = place - static_cast<float>(first);
  for (int t = 0; t < 4; ++t)
    for (int k = 0; k < kReferences; ++k) {
      add(k, tile[t]->references[first][k], part[t] * (1 - second));
      add(k, tile[t]->references[first + 1][k], part[t] * second);
    }
}

ReferenceWalk::Place ReferenceWalk::placeOf(const Remembered<float>& history) const {
  const float death = std::max(deathRate(history.factor), slowest());
  Place place{placeOfRate(death)};
  if (!(history.weight > 0)) return place;
  OfReferences<float> ages{};
  between(place.rate, [&](int k, const ReferenceNoise& n, float b) { ages[k] += b * n.meanAge; });
  const float age = history.ageSum / history.weight, youngest = std::min(ages[0], ages[1]);
  place.samples = placeBetween(ages, age, kSame * youngest);
  if (place.rate > 0 && age < kAsOld * youngest)
    place.rate = placeOfRate(death + deathRateOfAge(age) - deathRateOfAge(youngest));  // [ledger young]
  return place;
}

OlderNoise<float> ReferenceWalk::older(const TapPairs& pairs, const Remembered<float>& history,
                                       float freshShare) const {
  using N = ReferenceNoise;
  OfReferences<std::array<float, N::kCovariances>> r{};
  between(placeOf(history).rate, [&](int k, const N& n, float b) {
    for (int i = 0; i < N::kCovariances; ++i) r[k][i] += b * n.r[i];
  });
  OfReferences<float> share, common;
  for (int k = 0; k < kReferences; ++k) {
    const float here = r[k][N::kHere], older = r[k][N::kOlder];
    if (!(older > 1e-6f * here)) return {};
    share[k] = older / here;
    common[k] =
        (pairs.row * r[k][N::kRow] + pairs.column * r[k][N::kColumn] + pairs.diagonal * r[k][N::kDiagonal]) / here;
  }
  const float t = placeBetween(share, 1 - freshShare, kSame), all = mixed(share, t);
  return {all, mixed(common, t) / all};  // [ledger older]
}

EdgeNoise<float> ReferenceWalk::edge(const TapPairs& pairs, const Arrival& arrival, const Remembered<float>& history,
                                     float perNoise) const {
  const Place place = placeOf(history);
  EdgeWalks<float> walks{};
  between(place.rate, [&](int k, const ReferenceNoise& n, float b) {
    const float of = b * (k == 0 ? 1 - place.samples : place.samples);
    walks.row.noise += of * n.alongRow.noise, walks.row.alike += of * n.alongRow.alike;
    walks.column.noise += of * n.alongColumn.noise, walks.column.alike += of * n.alongColumn.alike;
  });
  const float death = deathRate(history.factor), frames = std::min(arrival.x, arrival.y);
  const float still = mixed(reachedShare(history, death, frames, perNoise), place.samples);
  return edgeNoise(pairs, arrival, walks, death, still);
}

NoiseRegime NoiseRegime::of(float now, float faster, float slower, float fasterKept, float slowerKept) {
  const float left = (faster - now) / (slower - now);  // of (D_faster / D_slower)^K
  if (!(left > 0 && left < 1)) return {now, slower, 0};
  const float frames = std::min(std::log(left) / std::log(fasterKept / slowerKept), Arrival::kLongAgo);
  return {now, std::max(0.0f, now + (slower - now) / std::pow(slowerKept, frames)), frames};  // [ledger regime]
}

float NoiseRegime::meanBefore(float age, float kept) const {
  return now + (old - now) * std::pow(kept, std::max(0.0f, frames - age));
}

NoiseRegime ReferenceWalk::regimeOf(int reference) const {
  NoiseRegime here;
  for (int t = 0; t < 4; ++t) {
    const NoiseRegime& of = tile[t]->regimes[reference];
    here.now += part[t] * of.now, here.old += part[t] * of.old, here.frames += part[t] * of.frames;
  }
  return here;
}

/// C_still / C of what reached the edge so many frames ago or earlier, before it died off. Where the last frame had
/// samples the history's own weight tells, else the reference.
OfReferences<float> ReferenceWalk::reachedShare(const Remembered<float>& history, float death, float frames,
                                                float perNoise) const {
  OfReferences<float> loss{}, share{};
  between(placeOfRate(death), [&](int k, const ReferenceNoise& n, float b) { loss[k] += b * n.loss; });
  const float still = stillNoise(history.weight, perNoise, death), kept = 1 / (1 + death);
  for (int k = 0; k < kReferences; ++k) {
    const NoiseRegime regime = regimeOf(k);
    const float then = regime.meanBefore(frames, kept);
    const float ofWeight = k == 0 ? regime.now : regime.meanBefore(0, std::sqrt(kept));
    const float all = regime.meanBefore(0, kept) * loss[k];  // 0 after thousands of frames without samples
    if (perNoise > 0 && ofWeight > 0)
      share[k] = still * (then / ofWeight);  // [ledger reached]
    else if (all > 0)
      share[k] = then / all;
  }
  return share;
}

}  // namespace twohistory
