#include "experiments/border.h"

#include <cmath>
#include <map>

#include "core/maths.h"
#include "core/parallel.h"

namespace experiments {
namespace {

constexpr std::uint8_t kFar = 0, kInside = 1, kOutside = 2;

/// Whether a pixel of the other kind lies within the band.
bool nearBorder(core::In<std::uint8_t> inside, int x, int y) {
  constexpr int r = BorderStep::kBand;
  const bool own = inside(x, y) != 0;
  for (int qy = std::max(0, y - r); qy <= std::min(y + r, inside.height - 1); ++qy)
    for (int qx = std::max(0, x - r); qx <= std::min(x + r, inside.width - 1); ++qx)
      if ((inside(qx, qy) != 0) != own) return true;
  return false;
}

core::Image<std::uint8_t> sidesOf(core::In<std::uint8_t> inside) {
  core::Image<std::uint8_t> side(inside.width, inside.height);
  core::forEachPixel(inside.width, inside.height, [&](int x, int y) {
    side(x, y) = nearBorder(inside, x, y) ? (inside(x, y) ? kInside : kOutside) : kFar;
  });
  return side;
}

double meanOf(core::In<float> image) {
  const std::int64_t width = image.width, size = width * image.height;
  return core::deterministicSum(
             size,
             [&](std::int64_t i) {
               return static_cast<double>(image(static_cast<int>(i % width), static_cast<int>(i / width)));
             }) /
         static_cast<double>(size);
}

}  // namespace

/// Sums over the pixels of one side of a cell.
struct BorderStep::Side {
  int count = 0;
  double error[2]{}, squared = 0, level = 0;

  void add(double value, double first, double second) {
    error[0] += value - first, error[1] += value - second;
    squared += (value - first) * (value - second), level += 0.5 * (first + second), ++count;
  }
  double mean(int half) const { return error[half] / count; }
  /// Variance of the error within the side; the halves' own noise averages out.
  double variance() const { return (squared - error[0] * error[1] / count) / (count - 1); }
};

void BorderStep::addCell(core::In<float> image, const std::array<core::In<float>, 2>& truth,
                         core::In<std::uint8_t> side, double floor, int x0, int y0) {
  std::array<Side, 3> sides;
  for (int y = y0; y < std::min(y0 + kCell, image.height); ++y)
    for (int x = x0; x < std::min(x0 + kCell, image.width); ++x)
      sides[side(x, y)].add(static_cast<double>(image(x, y)), static_cast<double>(truth[0](x, y)),
                            static_cast<double>(truth[1](x, y)));
  const Side &in = sides[kInside], &out = sides[kOutside];
  if (in.count < kLeast || out.count < kLeast) return;
  const double level = (in.level + out.level) / (in.count + out.count) + floor;
  const double step[2] = {in.mean(0) - out.mean(0), in.mean(1) - out.mean(1)};
  sum_ += step[0] * step[1], ++cells_;
  contrasts_.push_back({static_cast<float>(step[0] / level), static_cast<float>(step[1] / level)});
  if (in.variance() > 0 && out.variance() > 0) logRatio_ += std::log(out.variance() / in.variance()), ++noisy_;
}

void BorderStep::add(core::In<float> image, const std::array<core::In<float>, 2>& truth,
                     core::In<std::uint8_t> inside) {
  const core::Image<std::uint8_t> side = sidesOf(inside);
  const double floor = 0.005 * (meanOf(truth[0]) + meanOf(truth[1]));
  for (int y = 0; y < image.height; y += kCell)
    for (int x = 0; x < image.width; x += kCell) addCell(image, truth, side, floor, x, y);
}

double BorderStep::meanSquare() const { return cells_ > 0 ? sum_ / static_cast<double>(cells_) : core::kNaN; }

double BorderStep::noiseRatio() const {
  return noisy_ > 0 ? std::exp(0.5 * logRatio_ / static_cast<double>(noisy_)) : core::kNaN;
}

namespace {

using Contrasts = std::vector<BorderStep::Contrast>;

/// Mean over cells of the product of two different sequences' contrasts, all pairs alike; `left` = left out.
double meanPairProduct(const std::vector<const Contrasts*>& sequences, std::size_t left) {
  const std::size_t cells = sequences.front()->size();
  double sum = 0, count = 0;
  for (std::size_t s = 0; s < sequences.size(); ++s) count += s != left;
  for (std::size_t i = 0; i < cells; ++i) {
    double first = 0, second = 0, same = 0;
    for (std::size_t s = 0; s < sequences.size(); ++s) {
      if (s == left) continue;
      const double a = (*sequences[s])[i][0], b = (*sequences[s])[i][1];
      first += a, second += b, same += a * b;
    }
    sum += first * second - same;
  }
  return sum / (static_cast<double>(cells) * count * (count - 1));
}

}  // namespace

std::vector<double> systematicContrast2(const std::vector<const Contrasts*>& sequences) {
  const std::size_t n = sequences.size();
  std::vector<double> values(n, core::kNaN);
  if (n < 3 || sequences.front()->empty()) return values;
  for (const Contrasts* c : sequences)
    if (c->size() != sequences.front()->size()) return values;
  const double all = meanPairProduct(sequences, n), count = static_cast<double>(n);
  for (std::size_t s = 0; s < n; ++s) values[s] = count * all - (count - 1) * meanPairProduct(sequences, s);
  return values;
}

std::vector<Row> systematicRows(const std::string& scene, const std::vector<BorderContrasts>& all) {
  std::map<std::pair<std::string, std::string>, std::vector<const BorderContrasts*>> groups;
  for (const BorderContrasts& b : all) groups[{b.variant, b.region}].push_back(&b);
  std::vector<Row> rows;
  for (const auto& [key, group] : groups) {
    std::vector<const Contrasts*> contrasts;
    for (const BorderContrasts* b : group) contrasts.push_back(&b->contrasts);
    const std::vector<double> values = systematicContrast2(contrasts);
    for (std::size_t s = 0; s < values.size(); ++s)
      rows.push_back({scene, key.first, group[s]->seed, key.second, "border_contrast2", values[s]});
  }
  return rows;
}

}  // namespace experiments
