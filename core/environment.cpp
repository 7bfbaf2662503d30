// Tables of an environment map, and the map between directions and its points.
#include "core/environment.h"

#include <fstream>

#include "core/check.h"
#include "core/exr.h"
#include "core/hdr.h"
#include "core/parallel.h"

namespace core {
namespace {

constexpr float kLeastV = 0x1p-24f, kLastBelowOne = 1 - 0x1p-24f;

/// Weights of largest 1, so that no luminance is too small or too large for a table.
std::vector<float> normalised(const std::vector<double>& weights) {
  const double largest = *std::max_element(weights.begin(), weights.end());
  std::vector<float> result(weights.size(), 0.0f);
  for (std::size_t i = 0; i < weights.size() && largest > 0; ++i) result[i] = static_cast<float>(weights[i] / largest);
  return result;
}

/// Mean of sin(theta) over a row: the integral from the row's upper edge to its lower one, over its height.
double meanSine(int row, int rows) {
  const double height = double{kPi} / rows;
  return (std::cos(row * height) - std::cos((row + 1) * height)) / height;
}

/// Where in a table's bin the bits point, in (0, 1]: what is left of them after they chose the bin.
float withinBin(std::uint32_t binBits, int size) {
  const auto rest = static_cast<std::uint32_t>(std::uint64_t{binBits} * static_cast<std::uint32_t>(size));
  return (static_cast<float>(rest >> 8) + 0.5f) * 0x1p-24f;
}

}  // namespace

Environment::Environment(PlanesView<const float> image, const std::string& where, float scale) {
  if (image.width() < 1 || image.height() < 1) throw Error(where, "the environment has no pixel", "give an image");
  fillTexels(image, where, scale);
  buildTables();
}

void Environment::fillTexels(PlanesView<const float> image, const std::string& where, float scale) {
  texels_ = Image<vec3>(image.width(), image.height());
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x) {
      const vec3 c = scale * image.load(x, y);
      if (!isFinite(c))
        throw Error(where, "pixel (" + std::to_string(x) + ", " + std::to_string(y) + ") is not finite",
                    "replace it in the image");
      texels_(x, y) = glm::max(c, vec3(0));
      negatives_ += texels_(x, y) != c;
    }
}

void Environment::buildTables() {
  columns_.resize(static_cast<std::size_t>(height()));
  std::vector<double> rowWeights(columns_.size());
  forEachRow(height(), [&](int y) {
    std::vector<double> weights(static_cast<std::size_t>(width()));
    double sum = 0;
    for (int x = 0; x < width(); ++x) sum += weights[static_cast<std::size_t>(x)] = double{luminance(texels_(x, y))};
    rowWeights[static_cast<std::size_t>(y)] = sum * meanSine(y, height());
    columns_[static_cast<std::size_t>(y)] = AliasTable(normalised(weights));
  });
  rows_ = AliasTable(normalised(rowWeights));
  double sum = 0;
  for (const double weight : rowWeights) sum += weight;
  meanLuminance_ = sum * 0.5 * double{kPi} / (static_cast<double>(width()) * height());  // [env 2] over 4 pi
}

vec2 Environment::sample(std::array<std::uint32_t, 2> bits, std::array<std::uint32_t, 2> keepBits) const {
  // The float nearest to (texel + within) / size that lies in the texel, so that radiance() and pdf() see this texel.
  const auto inside = [](std::uint32_t texel, float within, int size) {
    const int wanted = static_cast<int>(texel);
    auto u = static_cast<float>((double{within} + texel) / size);
    while (texelOf(u, size) < wanted) u = std::nextafter(u, 1.0f);
    while (texelOf(u, size) > wanted || u >= 1) u = std::nextafter(u, 0.0f);
    return u;
  };
  const std::uint32_t row = rows_.sample(bits[1], keepBits[1]);
  const std::uint32_t column = columns_[row].sample(bits[0], keepBits[0]);
  return {inside(column, withinBin(bits[0], width()), width()), inside(row, withinBin(bits[1], height()), height())};
}

float Environment::pdf(vec2 uv) const {
  if (black()) return 0;
  const auto row = static_cast<std::uint32_t>(texelOf(uv.y, height()));
  if (columns_[row].empty()) return 0;
  const auto column = static_cast<std::uint32_t>(texelOf(uv.x, width()));
  const float ofRow = rows_.probability(row) * static_cast<float>(height());
  return ofRow * (columns_[row].probability(column) * static_cast<float>(width()));
}

// Angles are counted from the nearer pole: sin(pi v) loses all its digits where v is near 1, sin(pi (1 - v)) none.
vec3 Environment::directionOf(vec2 uv) {
  const float fromPole = kPi * std::min(uv.y, 1 - uv.y), phi = 2 * kPi * (uv.x - 0.5f);  // [env 1]
  const float sine = std::sin(fromPole), cosine = std::copysign(std::cos(fromPole), 0.5f - uv.y);
  return {sine * std::cos(phi), cosine, sine * std::sin(phi)};
}

vec2 Environment::uvOf(const vec3& d) {
  const float u = 0.5f + std::atan2(d.z, d.x) / (2 * kPi);  // [env 1]
  const float v = std::atan2(std::hypot(d.x, d.z), d.y) / kPi;
  return {u < 1 ? std::max(u, 0.0f) : 0.0f, std::clamp(v, kLeastV, kLastBelowOne)};
}

float Environment::solidAngle(vec2 uv) {
  return 2 * kPi * kPi * std::sin(kPi * std::min(uv.y, 1 - uv.y));  // [env 2]
}

std::shared_ptr<const Environment> loadEnvironment(const std::filesystem::path& path, float scale) {
  if (!std::filesystem::is_regular_file(path))
    throw Error(path.string(), "no such environment map", "name an OpenEXR or Radiance HDR image");
  std::string magic(4, '\0');
  std::ifstream(path, std::ios::binary).read(magic.data(), 4);
  const bool exr = magic == "\x76\x2f\x31\x01", hdr = magic.compare(0, 2, "#?") == 0;
  if (!exr && !hdr)
    throw Error(path.string(), "the environment map is neither OpenEXR nor Radiance HDR", "convert it to one of them");
  const Planes image = exr ? readExrRgb(path) : readHdr(path);
  return std::make_shared<const Environment>(image.view(), path.string(), scale);
}

}  // namespace core
