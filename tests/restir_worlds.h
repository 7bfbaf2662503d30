// Small worlds rendered by the real passes, many independent sequences of each, against light sampling without reuse.
#pragma once

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/gbuffer.h"
#include "core/lights.h"
#include "core/moment.h"
#include "core/statistics.h"
#include "restir/direct.h"
#include "restir/restir.h"
#include "restir/second.h"
#include "twohistory/reprojection.h"

namespace tests {

using core::vec3;

inline constexpr int kWidth = 16, kHeight = 12, kPixels = kWidth * kHeight;

/// A quad as two triangles, corners counter-clockwise seen from its front; its node gives it a velocity in metres a
/// frame. Returns the node.
inline int addQuad(core::Scene& scene, const core::Material& material, vec3 corner, vec3 u, vec3 v,
                   vec3 velocity = vec3(0)) {
  core::Mesh mesh;
  mesh.positions = {corner, corner + u, corner + u + v, corner + v};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = static_cast<int>(scene.materials.size());
  core::Node node;
  if (length(velocity) > 0) {
    node.translationTrack.times = {0, 1};
    node.translationTrack.values = {core::vec4(0), core::vec4(30.0f * velocity, 0)};
  }
  scene.materials.push_back(material);
  scene.meshes.push_back(mesh);
  scene.nodes.push_back(node);
  scene.instances.push_back({static_cast<int>(scene.meshes.size()) - 1, static_cast<int>(scene.nodes.size()) - 1});
  return static_cast<int>(scene.nodes.size()) - 1;
}

inline core::Material matte(float roughness = 1, float metallic = 0) {
  core::Material m;
  m.baseColor = vec3(0.8f, 0.7f, 0.6f), m.metallic = metallic, m.roughness = roughness;
  return m;
}
inline core::Material emitter(vec3 emission) {
  core::Material m = matte();
  m.emission = emission;
  return m;
}

struct Motion {
  vec3 light{0}, occluder{0}, camera{0};  ///< metres a frame
  vec3 lightStart{0};                     ///< offset of the first lamp in frame 0, metres
};

/// A floor, half of it glossy, under three lamps, with walls that hide lamps from parts of it; seen from above.
inline core::Scene makeWorld(const Motion& motion = {}, bool punctual = false) {
  core::Scene scene;
  addQuad(scene, matte(), {-2, 0, 2}, {2, 0, 0}, {0, 0, -4});
  addQuad(scene, matte(0.35f, 0.7f), {0, 0, 2}, {2, 0, 0}, {0, 0, -4});
  addQuad(scene, emitter({8, 6, 2}), vec3(-1.5f, 1.5f, -1) + motion.lightStart, {1, 0, 0}, {0, 0, 0.5f}, motion.light);
  addQuad(scene, emitter({2, 4, 9}), {0.8f, 1.2f, 0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, -0.5f * motion.light);
  addQuad(scene, emitter({6, 6, 6}), {-0.3f, 2, 1.2f}, {0.6f, 0, 0}, {0, 0, 0.3f});
  addQuad(scene, matte(), {-0.6f, 0, -0.6f}, {0, 0, 1.4f}, {0, 0.9f, 0}, motion.occluder);
  addQuad(scene, matte(), {0.1f, 0.4f, -0.3f}, {0.9f, 0, 0}, {0, 0, 0.7f}, motion.occluder);
  if (punctual) {
    scene.nodes.emplace_back();
    scene.nodes.back().translation = {1.5f, 1, -1.5f};
    core::PunctualLight light;
    light.intensity = vec3(1.5f), light.node = static_cast<int>(scene.nodes.size()) - 1;
    scene.punctual.push_back(light);
  }
  core::Node eye;  // looks down along -y with -z up
  eye.rotation = glm::angleAxis(-0.5f * core::kPi, vec3(1, 0, 0));
  eye.translation = {0, 4, 0};
  eye.translationTrack.times = {0, 1};
  eye.translationTrack.values = {core::vec4(0, 4, 0, 0), core::vec4(vec3(0, 4, 0) + 30.0f * motion.camera, 0)};
  scene.nodes.push_back(eye);
  scene.cameras.push_back({"eye", 0.9f, static_cast<int>(scene.nodes.size()) - 1});
  return scene;
}

/// Everything of a few frames that all sequences share: poses, lights, rays, surfaces and taps.
class World {
 public:
  World(core::Scene scene, int frames, int width = kWidth, int height = kHeight)
      : scene_(std::move(scene)), frames_(frames), width_(width), height_(height) {
    const auto trees = core::buildMeshTrees(scene_);
    for (int f = 0; f < frames; ++f) {
      Instant& now = frames_[f];
      now.pose = core::poseAt(scene_, f / 30.0);
      now.lights = std::make_shared<core::Lights>(scene_, now.pose);
      now.tracer = std::make_shared<core::Tracer>(trees, scene_, now.pose);
      now.gbuffer = core::GBuffer(width, height);
      now.taps = core::Image<twohistory::Taps>(width, height);
      const Instant& before = frames_[std::max(f - 1, 0)];
      core::traceGBuffer(scene_, now.pose, before.pose, *now.tracer, {}, now.gbuffer);
      if (f > 0) twohistory::reproject(now.gbuffer.guide.view(), before.gbuffer.guide.view(), {}, now.taps);
    }
  }

  int width() const { return width_; }
  int height() const { return height_; }
  int frames() const { return static_cast<int>(frames_.size()); }
  /// Frames beyond the last repeat it: a still world goes on for ever from two frames.
  core::Moment moment(int f) const {
    const Instant& i = instant(f);
    return {static_cast<std::uint32_t>(f), i.pose.camera.position, i.lights, i.tracer, i.gbuffer.surfaces,
            i.gbuffer.guide.view()};
  }
  restir::Frame frame(int f, core::In<float> samples, std::uint64_t seed, int tile = core::kDefaultTile) const {
    return {moment(f), moment(std::max(f - 1, 0)), samples, instant(f).taps, seed, tile};
  }

 private:
  struct Instant {
    core::Pose pose;
    std::shared_ptr<const core::Lights> lights;
    std::shared_ptr<const core::Tracer> tracer;
    core::GBuffer gbuffer;
    core::Image<twohistory::Taps> taps;
  };
  const Instant& instant(int f) const { return frames_[std::min<std::size_t>(f, frames_.size() - 1)]; }

  core::Scene scene_;
  std::vector<Instant> frames_;
  int width_, height_;
};

/// What a sequence may do besides rendering; all members optional.
struct Hooks {
  /// Sample counts of a frame; radiance: the frame before, 0 in the first. Default: 1 everywhere.
  std::function<float(int frame, int x, int y, const vec3& radianceBefore)> samples;
  /// Called after each frame.
  std::function<void(int frame, restir::RestirState&)> after = {};
  /// Pixels of the last frame that are compared. Default: all.
  std::function<bool(int x, int y)> compared = {};
};

/// Blackens what is not compared.
inline void blank(const std::function<bool(int, int)>& compared, core::Planes& image) {
  for (int y = 0; y < image.height() && compared; ++y)
    for (int x = 0; x < image.width(); ++x)
      if (!compared(x, y)) image.view().store(x, y, vec3(0));
}

/// Renders all frames of a world once; out is the last frame's radiance, not demodulated.
inline void renderSequence(const World& world, restir::RestirParameters p, const Hooks& hooks, std::uint64_t seed,
                           core::Planes& out, int tile = core::kDefaultTile) {
  p.demodulate = false;
  restir::RestirState state(world.width(), world.height());
  std::optional<restir::SecondHistory> second;
  if (p.second.on) second.emplace(world.width(), world.height());
  core::Image<float> samples(world.width(), world.height(), 1.0f);
  for (int f = 0; f < world.frames(); ++f) {
    for (int y = 0; y < world.height() && hooks.samples; ++y)
      for (int x = 0; x < world.width(); ++x) samples(x, y) = hooks.samples(f, x, y, out.view().load(x, y));
    const restir::Frame frame = world.frame(f, samples, seed, tile);
    restir::drawCandidates(p, frame, state);
    restir::reuseTemporally(p, frame, state);
    restir::reuseSpatiallyAndShade(p, frame, state, out);
    if (second) second->blendInto(p, frame, state, out);
    if (hooks.after) hooks.after(f, state);
  }
  blank(hooks.compared, out);
}

/// Means over independent sequences: of every pixel's luminance in the last frame, of sums over square cells of pixels,
/// and of the frame's sum.
struct Estimate {
  explicit Estimate(int w = kWidth, int h = kHeight, int c = 1)
      : pixels(w * h), cells((w / c) * (h / c)), width(w), cell(c) {}

  std::vector<core::RunningMoments> pixels, cells;
  core::RunningMoments total;
  int width, cell;  ///< cell: pixels on its side; divides the image's

  void add(const core::Planes& image) {
    double sum = 0;
    std::vector<double> inCell(cells.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double l = core::luminance(image.view().at(static_cast<std::int32_t>(i)));
      pixels[i].add(l);
      sum += l;
      const std::size_t x = i % width / cell, y = i / width / cell;
      inCell[y * (width / cell) + x] += l;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i].add(inCell[i]);
    total.add(sum);
  }
  void merge(const Estimate& other) {
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i].merge(other.pixels[i]);
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i].merge(other.cells[i]);
    total.merge(other.total);
  }
};

/// How many times over sequences and references are rendered: TWOFOLD_THOROUGH, which slow runs of fast tests set.
inline int thoroughness() {
  const char* text = std::getenv("TWOFOLD_THOROUGH");
  return text ? std::max(1, std::atoi(text)) : 1;
}
/// The bias that a test must detect half of the time, if that is `usual` with as many sequences as it asks for.
inline double detectableBias(double usual) { return usual / std::sqrt(thoroughness()); }

/// Sequences of seeds firstSeed, ...; batches of them run in parallel and are added in order.
inline Estimate estimate(const World& world, const restir::RestirParameters& p, int count, const Hooks& hooks = {},
                         std::uint64_t firstSeed = 1, int cell = 1) {
  constexpr int kBatch = 16;
  count *= thoroughness();
  Estimate result(world.width(), world.height(), cell);
  std::vector<core::Planes> images(kBatch);
  for (int first = 0; first < count; first += kBatch) {
    const int size = std::min(kBatch, count - first);
    tbb::parallel_for(0, size, [&](int i) {
      images[i] = core::Planes(world.width(), world.height());
      renderSequence(world, p, hooks, firstSeed + static_cast<std::uint64_t>(first + i), images[i]);
    });
    for (int i = 0; i < size; ++i) result.add(images[i]);
  }
  return result;
}

/// The last frame by light sampling without reuse: `images` independent images of `samples` a pixel.
inline Estimate reference(const World& world, int images = 64, int samples = 1024,
                          const std::function<bool(int, int)>& compared = {}, int cell = 1) {
  const core::Moment now = world.moment(world.frames() - 1);
  Estimate result(world.width(), world.height(), cell);
  core::Planes image(world.width(), world.height());
  images *= thoroughness();
  for (int i = 0; i < images; ++i) {
    core::forEachPixel(world.width(), world.height(), [&](int x, int y) {
      const auto pixel = static_cast<std::uint32_t>(y * world.width() + x);
      image.view().store(x, y, restir::meanDirect(now, now.surfaces(x, y), samples, 1000 + i, pixel));
    });
    blank(compared, image);
    result.add(image);
  }
  return result;
}

inline double zOf(const core::RunningMoments& a, const core::RunningMoments& b) {
  const double variance = a.meanVariance() + b.meanVariance();
  return variance > 0 ? (a.mean() - b.mean()) / std::sqrt(variance) : a.mean() == b.mean() ? 0 : 1e9;
}

/// Sum of the pixels' variances.
inline double totalVariance(const Estimate& e) {
  double sum = 0;
  for (const auto& p : e.pixels) sum += p.variance();
  return sum;
}

inline bool sameBits(const core::Planes& a, const core::Planes& b) {
  for (int c = 0; c < 3; ++c)
    if (std::memcmp(a.view().plane[c].data, b.view().plane[c].data, sizeof(float) * kPixels) != 0) return false;
  return true;
}

/// Counts 0, 1, 2 and 4, by pixel and frame; 1 in the last of `frames`, so that all of it is shaded.
inline auto patchwork(int frames) {
  return [frames](int frame, int x, int y, const vec3&) {
    static constexpr std::array<float, 5> kCounts{0, 1, 0, 4, 2};
    return frame == frames - 1 ? 1.0f : kCounts[(x + 2 * y + 3 * frame) % 5];
  };
}

/// Sum over pixels of W p-hat of fresh reservoirs, an unbiased estimate of the unshadowed light of triangles.
/// fill(target, surface, rng, builder) adds a pixel's candidates; image: one set of random numbers.
template <class Fill>
double unshadowedSum(const core::Moment& now, std::uint32_t image, Fill&& fill) {
  double sum = 0;
  for (std::uint32_t i = 0; i < kPixels; ++i) {
    const core::Surface& surface = now.surfaces.at(i);
    if (!surface.hit()) continue;
    const restir::Target<core::LightFeatures{false, false}> target(surface, now.cameraPosition, *now.lights);
    core::Rng rng(1, core::Pass::lab, i, image);
    restir::ReservoirBuilder builder;
    fill(target, surface, rng, builder);
    const restir::Reservoir r = builder.finish(1, 0);
    if (r.unbiasedWeight > 0) sum += r.unbiasedWeight * target(r.sample);
  }
  return sum;
}

/// How an estimate compares with the reference.
struct Comparison {
  double ratio;       ///< of the frames' sums
  double z;           ///< of the frames' sums
  double worst;       ///< largest |z| of a cell; cells are pixels but where a test says otherwise
  double detectable;  ///< relative bias of the sum that a test at 1e-6 detects half of the time
};
inline Comparison compare(const Estimate& test, const Estimate& truth) {
  Comparison c{test.total.mean() / truth.total.mean(), zOf(test.total, truth.total), 0, 0};
  for (std::size_t i = 0; i < test.cells.size(); ++i)
    c.worst = std::max(c.worst, std::abs(zOf(test.cells[i], truth.cells[i])));
  c.detectable = core::sidakBound(1, 1e-6) * std::sqrt(test.total.meanVariance() + truth.total.meanVariance()) /
                 truth.total.mean();
  return c;
}
/// Neighbours that see other lights: from far away, whatever way they face.
inline restir::SpatialParameters farAndAroundCorners() {
  restir::SpatialParameters s;
  s.radius = 0.25f, s.normalCosine = -1, s.planeDistance = 100;
  return s;
}

/// Biased by more than `least`, whatever chance added: what a control of a test that detects `least` must be.
inline bool isBiased(const Comparison& c, double least = 0.01) { return std::abs(c.ratio - 1) > least + c.detectable; }

}  // namespace tests
