#include "twohistory/blend.h"

#include "core/parallel.h"
#include "twohistory/combination.h"
#include "twohistory/lag.h"

namespace twohistory {
namespace {

using core::luminance;
using core::vec3;

/// Weights of all histories in one pixel; sum 1.
template <int K>
using Weights = std::array<float, K>;

template <int K>
Weights<K> pairWeights(const BlendParameters& p, float first) {
  Weights<K> w{};
  w[p.pair[0]] += first;
  w[p.pair[1]] += 1 - first;
  return w;
}

/// Variance of sum lambda_j X_j in units of s2.
template <int K>
float varianceOf(const Ledger<K>& ledger, const Weights<K>& lambda) {
  float sum = 0;
  for (int j = 0; j < K; ++j)
    for (int k = 0; k < K; ++k) sum += lambda[j] * lambda[k] * ledger.covariance(j, k);
  return std::max(0.0f, sum);
}

/// Where and how one pixel's result goes.
template <int K>
struct Sink {
  const Histories<K>& h;
  core::PlanesView<float> out;
  core::ImageView<float> variance, weight;
  int reported;            ///< history whose weight is written to `weight`
  Validation* validation;  ///< null = blends go unchecked

  /// Books the blend's shifts away from history 0 for the next check, and takes back what earlier checks refuted.
  Weights<K> checked(int x, int y, Weights<K> lambda) const {
    Shifts shift{};
    for (int j = 1; j < K; ++j) shift[j - 1] = lambda[j] * luminance(h.colour[j].load(x, y) - h.colour[0].load(x, y));
    validation->storeShifts(x, y, shift);
    const Shifts keep = validation->keep(x, y, validation->regime(x, y));
    lambda[0] = 1;
    for (int j = 1; j < K; ++j) lambda[j] *= keep[j - 1], lambda[0] -= lambda[j];
    return lambda;
  }

  void write(int x, int y, const Weights<K>& wanted) const {
    const Weights<K> lambda = validation ? checked(x, y, wanted) : wanted;
    vec3 sum(0);
    for (int j = 0; j < K; ++j)
      if (lambda[j] != 0) sum += lambda[j] * h.colour[j].load(x, y);
    out.store(x, y, glm::max(sum, vec3(0)));  // extrapolation may undershoot; radiance is not negative
    const float own = h.ledger(x, y).covariance(0, 0);
    variance(x, y) = own > 0 ? h.variance(x, y) * varianceOf<K>(h.ledger(x, y), lambda) / own : h.variance(x, y);
    if (!weight.empty()) weight(x, y) = lambda[reported];
  }
};

/// [blend seed] q = clamp(lum |g| / STD(lum I_u), 0, 1), I_b = lerp(I_opt, I_u, q), so p_b = p + q (1 - p).
template <int K>
float seedWeight(const Histories<K>& h, const BlendParameters& p, int x, int y) {
  const Ledger<K>& ledger = h.ledger(x, y);
  const float optimal = leastVarianceWeight(pairOf(ledger, p.pair[0], p.pair[1]));
  const float own = ledger.covariance(0, 0), first = ledger.covariance(p.pair[0], p.pair[0]);
  const float deviation = std::sqrt(own > 0 ? h.variance(x, y) * first / own : h.variance(x, y));
  const float gradient = luminance(glm::abs(h.gradient.load(x, y)));
  const float q = gradient < deviation ? gradient / deviation : (gradient > 0 ? 1.0f : 0.0f);
  return optimal + q * (1 - optimal);
}

/// [blend oracle] p in [0, 1] that minimises |p X_1 + (1 - p) X_2 - r|^2 over RGB.
template <int K>
float oracleWeight(const Histories<K>& h, const BlendParameters& p, int x, int y) {
  const vec3 second = h.colour[p.pair[1]].load(x, y), step = h.colour[p.pair[0]].load(x, y) - second;
  const float length2 = dot(step, step);
  if (!(length2 > 0)) return 1;
  return std::clamp(dot(h.target.load(x, y) - second, step) / length2, 0.0f, 1.0f);
}

template <int K>
Weights<K> customWeights(const Histories<K>& h, const BlendParameters& p, int x, int y) {
  const Ledger<K>& ledger = h.ledger(x, y);
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
float localWeight(const Histories<K>& h, const BlendParameters& p, int x, int y) {
  const Ledger<K>& ledger = h.ledger(x, y);
  switch (p.mode) {
    case BlendMode::published:
      return publishedWeight(ledger, p.pair[0], p.pair[1]);
    case BlendMode::seed:
    case BlendMode::seedSlide:
      return seedWeight(h, p, x, y);
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
Weights<K> driftWeights(const Ledger<K>& ledger, const BlendParameters& p, const DriftRow& row, int i) {
  if (p.mode != BlendMode::lagAll) return pairWeightsByDrift<K>(ledger, p, row, i);
  const Against<K> against(p.pair[1]);
  return lagWeights(ledger, against, windowEvidence(ledger, against, row, i, p.noise == NoiseEstimate::safe), p.lowest);
}

/// Fills the planes that sumDrift averages: lum(X_j - X_k) and its noise.
template <int K>
void prepareDifference(const Histories<K>& h, int j, int k, core::ImageView<float> value,
                       core::ImageView<float> noise) {
  core::forEachPixel(h.ledger.width, h.ledger.height, [&](int x, int y) {
    value(x, y) = luminance(h.colour[j].load(x, y) - h.colour[k].load(x, y));
    noise(x, y) = h.sampleVariance(x, y) * pairOf(h.ledger(x, y), j, k).difference();
  });
}

/// lagAll compares every history with the freshest, the others their pair.
template <int K>
void blendByDrift(const Histories<K>& h, const core::Guide& guide, const BlendParameters& p, BlendState& state,
                  const Sink<K>& sink) {
  const bool all = p.mode == BlendMode::lagAll;
  const Against<K> against(p.pair[1]);
  const int count = all ? K - 1 : 1;
  state.fit(count, guide.width(), guide.height());
  std::array<Difference, DriftRow::kMost> differences;
  for (int k = 0; k < count; ++k) {
    prepareDifference(h, all ? against.of[k] : p.pair[0], p.pair[1], state.difference[k], state.noise[k]);
    differences[k] = {state.difference[k], state.noise[k]};
  }
  core::forEachRow(guide.height(), [&](int y) {
    DriftRow row;
    for (int x0 = 0; x0 < guide.width(); x0 += core::kBlock) {
      const int x1 = std::min(x0 + core::kBlock, guide.width());
      sumDrift(guide, p.edges, differences.data(), count, h.sampleVariance, p.radius, y, x0, x1, row);
      for (int x = x0; x < x1; ++x) sink.write(x, y, driftWeights(h.ledger(x, y), p, row, x - x0));
    }
  });
}

}  // namespace

void BlendState::fit(int differences, int width, int height) {
  for (int k = 0; k < differences; ++k) {
    if (difference[k].width() == width && difference[k].height() == height) continue;
    difference[k] = core::Image<float>(width, height);
    noise[k] = core::Image<float>(width, height);
  }
}

template <int K>
void blend(const Histories<K>& h, const core::Guide& guide, const BlendParameters& p, BlendState& state,
           core::PlanesView<float> out, core::ImageView<float> variance, core::ImageView<float> weight) {
  CHECK_LT(p.pair[0], K);
  const Sink<K> sink{h, out, variance, weight, p.pair[0], p.validation.on ? &state.validation : nullptr};
  const int width = guide.width(), height = guide.height();
  if (p.mode == BlendMode::first) {
    Weights<K> only{};
    only[p.pair[0]] = 1;
    return core::forEachPixel(width, height, [&](int x, int y) { sink.write(x, y, only); });
  }
  if (p.mode == BlendMode::custom)
    return core::forEachPixel(width, height, [&](int x, int y) { sink.write(x, y, customWeights(h, p, x, y)); });
  CHECK_LT(p.pair[1], K);
  if (p.mode == BlendMode::lag || p.mode == BlendMode::lagAll || p.mode == BlendMode::consistent)
    return blendByDrift(h, guide, p, state, sink);
  core::forEachPixel(width, height,
                     [&](int x, int y) { sink.write(x, y, pairWeights<K>(p, localWeight(h, p, x, y))); });
}

template void blend(const Histories<1>&, const core::Guide&, const BlendParameters&, BlendState&,
                    core::PlanesView<float>, core::ImageView<float>, core::ImageView<float>);
template void blend(const Histories<2>&, const core::Guide&, const BlendParameters&, BlendState&,
                    core::PlanesView<float>, core::ImageView<float>, core::ImageView<float>);
template void blend(const Histories<3>&, const core::Guide&, const BlendParameters&, BlendState&,
                    core::PlanesView<float>, core::ImageView<float>, core::ImageView<float>);

}  // namespace twohistory
