#include "twohistory/blend.h"

#include "core/parallel.h"
#include "twohistory/combination.h"
#include "twohistory/lag.h"
#include "twohistory/trend.h"

namespace twohistory {
namespace {

using core::luminance;
using core::vec3;

/// Weights of all histories in one pixel; sum 1.
template <int K>
using Weights = std::array<float, K>;

/// What a blend asks for in one pixel.
template <int K>
struct Proposal {
  Weights<K> lambda{};
  std::array<float, K> lag{};  ///< of each history, luminance: what it is above the truth, as far as one can see
};

template <int K>
Weights<K> pairWeights(const BlendParameters& p, float first) {
  Weights<K> w{};
  w[p.pair[0]] += first;
  if (first != 1) w[p.pair[1]] += 1 - first;
  return w;
}

/// Where and how one pixel's result goes.
template <int K>
struct Sink {
  const Histories<K>& h;
  const Blended& out;
  int reported;            ///< history whose weight is written
  float correction;        ///< share of the remaining lag to take away
  Validation* validation;  ///< null = blends go unchecked

  /// [blend residual] q = -(sum_j lambda_j lag_j) / lum(X_0), within [-1, 8].
  float corrected(const vec3& base, const Weights<K>& lambda, const std::array<float, K>& lag) const {
    const float brightness = luminance(base);
    float left = 0;
    for (int j = 0; j < K; ++j) left += lambda[j] * lag[j];
    if (!(correction > 0) || !(brightness > 0) || left == 0) return 0;
    return std::clamp(-correction * left / brightness, -1.0f, 8.0f);  // [blend residual]
  }

  /// Takes back of the blend's weights what earlier checks refuted, and books them for the next check. Returns q.
  float check(int x, int y, const Ledger<K>& ledger, const vec3& base, const Proposal<K>& wanted,
              Weights<K>& lambda) const {
    const Regime regime = validation->regime(ledger, h.samples(x, y));
    const Shifts keep = validation->keep(x, y, regime);
    Shifts share{};
    lambda[0] = 1;
    for (int j = 1; j < K; ++j) share[j - 1] = lambda[j], lambda[j] *= keep[j - 1], lambda[0] -= lambda[j];
    share[kCorrection] = corrected(base, lambda, wanted.lag);
    validation->book(x, y, regime, share);
    return keep[kCorrection] * share[kCorrection];
  }

  void write(int x, int y, const Ledger<K>& ledger, const Proposal<K>& wanted) const {
    const vec3 base = h.colour[0].load(x, y);
    Weights<K> lambda = wanted.lambda;
    const float q = validation ? check(x, y, ledger, base, wanted, lambda) : corrected(base, lambda, wanted.lag);
    vec3 sum = base + q * base;  // weights have sum 1, and differences are what is stored
    for (int j = 1; j < K; ++j)
      if (lambda[j] != 0) sum += lambda[j] * h.colour[j].fromBase(x, y);
    const Matrix<K, float> c = covarianceOf(ledger);
    const float share = c[0][0] > 0 ? varianceOf<K, float>(c, lambda) / c[0][0] : 1.0f;
    store(x, y, sum, h.variance(x, y) * share, lambda[reported]);
  }

  /// All histories are history 0, so the blend is, whatever the weights.
  void writeTwin(int x, int y) const {
    store(x, y, h.colour[0].load(x, y), h.variance(x, y), reported == 0 ? 1.0f : 0.0f);
  }

  void store(int x, int y, const vec3& colour, float variance, float weight) const {
    out.colour.store(x, y, glm::max(colour, vec3(0)));  // extrapolation may undershoot; radiance is not negative
    out.variance(x, y) = variance;
    if (!out.weight.empty()) out.weight(x, y) = weight;
  }
};

/// [blend seed] q = clamp(lum |g| / STD(lum I_u), 0, 1), I_b = lerp(I_opt, I_u, q), so p_b = p + q (1 - p).
template <int K>
float seedWeight(const Histories<K>& h, const Ledger<K>& ledger, const BlendParameters& p, int x, int y) {
  const float optimal = leastVarianceWeight(pairOf(ledger, p.pair[0], p.pair[1]));
  const float own = ledger.covariance(0, 0), first = ledger.covariance(p.pair[0], p.pair[0]);
  const float deviation = std::sqrt(own > 0 ? h.variance(x, y) * first / own : h.variance(x, y));
  const float gradient = luminance(glm::abs(h.gradient.load(x, y)));
  const float q = gradient < deviation ? gradient / deviation : (gradient > 0 ? 1.0f : 0.0f);
  return optimal + q * (1 - optimal);  // [blend seed]
}

/// [blend oracle] p in [0, 1] that minimises |p X_1 + (1 - p) X_2 - r|^2 over RGB.
template <int K>
float oracleWeight(const Histories<K>& h, const BlendParameters& p, int x, int y) {
  const vec3 second = h.colour[p.pair[1]].load(x, y), step = h.colour[p.pair[0]].load(x, y) - second;
  const float length2 = dot(step, step);
  if (!(length2 > 0)) return 1;
  return std::clamp(dot(h.target.load(x, y) - second, step) / length2, 0.0f, 1.0f);  // [blend oracle]
}

template <int K>
Weights<K> customWeights(const Histories<K>& h, const Ledger<K>& ledger, const BlendParameters& p, int x, int y) {
  PixelHistories pixel{K, {}, {}, {}, {}, h.sampleVariance(x, y), h.samples(x, y)};
  for (int j = 0; j < K; ++j) {
    pixel.colour[j] = h.colour[j].load(x, y), pixel.weight[j] = ledger.weight[j], pixel.age[j] = ledger.age(j);
    for (int k = 0; k < K; ++k) pixel.covariance[j][k] = ledger.covariance(j, k);
  }
  const std::array<float, 3> weights = p.custom(pixel);
  Weights<K> result;
  std::copy_n(weights.begin(), K, result.begin());
  return result;
}

/// Blends whose weight needs only the pixel itself.
template <int K>
float localWeight(const Histories<K>& h, const Ledger<K>& ledger, const BlendParameters& p, int x, int y) {
  switch (p.mode) {
    case BlendMode::published:
      return publishedWeight(ledger, p.pair[0], p.pair[1]);
    case BlendMode::seed:
    case BlendMode::seedSlide:
      return seedWeight(h, ledger, p, x, y);
    case BlendMode::oracle:
      if (!h.target.empty()) return oracleWeight(h, p, x, y);
      [[fallthrough]];
    default:
      return leastVarianceWeight(pairOf(ledger, p.pair[0], p.pair[1]));
  }
}

/// Blends of a pair that look at the window around the pixel.
template <int K>
Weights<K> pairWeightsByDrift(const Ledger<K>& ledger, const BlendParameters& p, const DriftRow& row, int i) {
  const int a = p.pair[0], b = p.pair[1];
  const float mean = row.mean(0, i);
  const float noise2 = p.noise == NoiseEstimate::safe ? row.safeNoise(0, i) : row.predictedNoise(0, i);
  const float excess = cappedRatio(std::max(0.0f, mean * mean - noise2), row.meanSampleVariance(i));
  const PairCovariance<float> c = pairOf(ledger, a, b);
  if (p.mode == BlendMode::consistent) return pairWeights<K>(p, consistentWeight(c, excess));
  const float g = squaredDrift(excess, ledger.age(a), ledger.age(b));  // [blend G2]
  return pairWeights<K>(p, std::clamp(lagWeight(c, ledger.age(a), ledger.age(b), g), p.lowest, p.highest));
}

template <int K>
Proposal<K> proposalByDrift(const Ledger<K>& ledger, const BlendParameters& p, const DriftRow& row, int i,
                            const Trends& trend) {
  if (p.mode != BlendMode::lagAll) return {pairWeightsByDrift<K>(ledger, p, row, i)};
  const Against<K> against(p.pair[1]);
  const bool measured = p.noise == NoiseEstimate::safe;
  const WindowEvidence<K> seen = windowEvidence(ledger, against, row, i, measured, trend);
  const float c = p.correction, rho = (1 - c) * (1 - c) + c * c * p.lagError * p.lagError;  // [blend rho]
  Proposal<K> proposal{lagWeights(ledger, against, seen, rho, p.lowest)};
  const float unit = std::sqrt(row.meanSampleVariance(i)) * seen.fresh;
  for (int j = 0; j < K; ++j) proposal.lag[j] = seen.bias[j] * unit;
  return proposal;
}

/// Differences that windows average, each of[k] - reference.
template <int K>
struct Compared {
  int count, reference;
  std::array<int, K> of{};

  /// lagAll compares every history with the freshest, the others their pair.
  explicit Compared(const BlendParameters& p) : count(1), reference(p.pair[1]) {
    of[0] = p.pair[0];
    if (p.mode == BlendMode::lagAll) count = K - 1, of = Against<K>(reference).of;
  }
};

/// Fills the planes that windows average, lum(X_j - X_r) and its noise, both 0 for twins, and lum(X_0); adds up trends.
template <int K>
void prepareDifferences(const Histories<K>& h, const TwinTiles* twins, const Compared<K>& compared,
                        const BlendScratch& scratch, Trend& trend) {
  const auto preparePixel = [&](int x, int y, Trend::TileSums& sums) {
    const Ledger<K> ledger = h.ledger(x, y);
    const int r = compared.reference;
    const float brightness = luminance(h.colour[0].load(x, y)), age = ledger.age(r);
    const vec3 base = h.colour[r].fromBase(x, y);
    for (int k = 0; k < compared.count; ++k) {
      const int j = compared.of[k];
      const float d = luminance(h.colour[j].fromBase(x, y) - base);
      scratch[2 * k](x, y) = d;
      scratch[2 * k + 1](x, y) = h.sampleVariance(x, y) * pairOf<K, float>(ledger, j, r).difference();
      sums[k].add(d, ledger.age(j) - age, brightness);
    }
    scratch.back()(x, y) = brightness;
  };
  core::forEachTile(
      h.variance.width, h.variance.height,
      [&](int x0, int y0, int x1, int y1) {
        const bool same = twins && twins->at(x0, y0);
        Trend::TileSums sums{};
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) {
            if (!same)
              preparePixel(x, y, sums);
            else
              for (int k = 0; k < 2 * compared.count; ++k) scratch[k](x, y) = 0;  // pairs read no brightness
          }
        trend.tile(x0, y0) = sums;
      },
      TwinTiles::kSide);
}

/// Blends of twins that are history 0 for certain. The others' weights need not have a sum of exactly 1.
const TwinTiles* usefulTwins(const TwinTiles* twins, const BlendParameters& p) {
  const bool known = p.mode == BlendMode::optimal || p.mode == BlendMode::seed || p.mode == BlendMode::seedSlide ||
                     p.mode == BlendMode::consistent || p.mode == BlendMode::lag;
  return known && p.pair[0] == 0 && !p.validation.on ? twins : nullptr;
}

/// Blends pixels [x0, x1) of a row. block: window sums, of more than the twins among them.
template <int K>
void blendRow(const Histories<K>& h, const BlendParameters& p, const TwinTiles* twins, const DriftBlock& block,
              const Trend& trend, int y, int x0, int x1, const Sink<K>& sink) {
  int begin = x0, end = x1;
  if (twins) twins->narrow(y, p.radius, begin, end);
  for (int x = x0; x < begin; ++x) sink.writeTwin(x, y);
  for (int x = std::max(begin, end); x < x1; ++x) sink.writeTwin(x, y);
  if (begin >= end) return;
  DriftRow row;
  block.sumWindows(y, begin, end, row);
  for (int x = begin; x < end; ++x) {
    const Ledger<K> ledger = h.ledger(x, y);
    sink.write(x, y, ledger, proposalByDrift(ledger, p, row, x - begin, trend.at(x, y)));
  }
}

template <int K>
void blendByDrift(const Histories<K>& h, const core::Guide& guide, const BlendParameters& p, const TwinTiles* twins,
                  const BlendScratch& scratch, const Sink<K>& sink) {
  const Compared<K> compared(p);
  Trend trend(guide.width(), guide.height());
  prepareDifferences(h, twins, compared, scratch, trend);
  if (p.mode == BlendMode::lagAll && p.trend) trend.solve();
  DriftSource source{guide, p.edges, p.radius, h.sampleVariance, scratch.back(), compared.count, {}};
  for (int k = 0; k < compared.count; ++k) source.differences[k] = {scratch[2 * k], scratch[2 * k + 1]};
  const int reach = p.radius;
  core::forEachBlock(guide.width(), guide.height(), DriftBlock::kWidth, DriftBlock::kHeight,
                     [&](int x0, int y0, int x1, int y1) {
                       DriftBlock block(source);
                       if (!twins || !twins->all(x0 - reach, y0 - reach, x1 + reach, y1 + reach))
                         block.sumRows(x0, x1, y0, y1);
                       for (int y = y0; y < y1; ++y) blendRow(h, p, twins, block, trend, y, x0, x1, sink);
                     });
}

/// Blends that look at one pixel at a time.
template <int K>
Weights<K> ownWeights(const Histories<K>& h, const Ledger<K>& ledger, const BlendParameters& p, int x, int y) {
  if (p.mode == BlendMode::custom) return customWeights(h, ledger, p, x, y);
  if (p.mode == BlendMode::optimalAll) return leastVarianceWeights<K, float>(covarianceOf(ledger));
  return pairWeights<K>(p, p.mode == BlendMode::first ? 1 : localWeight(h, ledger, p, x, y));
}

template <int K>
void blendByPixel(const Histories<K>& h, const BlendParameters& p, const TwinTiles* twins, const Sink<K>& sink) {
  const bool onlyFirst = p.mode == BlendMode::first && p.pair[0] == 0 && !p.validation.on;
  core::forEachTile(
      h.variance.width, h.variance.height,
      [&](int x0, int y0, int x1, int y1) {
        const bool same = onlyFirst || (twins && twins->at(x0, y0));
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) {
            if (same) {
              sink.writeTwin(x, y);
              continue;
            }
            const Ledger<K> ledger = h.ledger(x, y);
            sink.write(x, y, ledger, {ownWeights(h, ledger, p, x, y)});
          }
      },
      TwinTiles::kSide);
}

}  // namespace

template <int K>
void blend(const Histories<K>& h, const core::Guide& guide, const BlendParameters& p, Validation& validation,
           const BlendScratch& scratch, const Blended& out) {
  const bool pairs = usesPair(p.mode);
  CHECK_LT(p.pair[0], K);
  if (pairs) CHECK_LT(p.pair[1], K);
  const Sink<K> sink{h, out, p.pair[0], p.correction, p.validation.on ? &validation : nullptr};
  const TwinTiles* twins = usefulTwins(h.twins, p);
  if (p.mode == BlendMode::lag || p.mode == BlendMode::lagAll || p.mode == BlendMode::consistent)
    return blendByDrift(h, guide, p, twins, scratch, sink);
  blendByPixel(h, p, twins, sink);
}

#define INSTANTIATE(K)                                                                              \
  template void blend(const Histories<K>&, const core::Guide&, const BlendParameters&, Validation&, \
                      const BlendScratch&, const Blended&);
INSTANTIATE(1)
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace twohistory
