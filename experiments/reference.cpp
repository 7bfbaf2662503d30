#include "experiments/reference.h"

#include <fmt/format.h>

#include "core/check.h"
#include "core/exr.h"
#include "core/parallel.h"
#include "experiments/scene_source.h"
#include "restir/direct.h"

namespace experiments {
namespace {

using core::vec3;

constexpr int kReferenceVersion = 2;  ///< part of the cache's key; raised when the estimator's results change
constexpr std::uint64_t kFirstStream = 0x52656631, kSecondStream = 0x52656632;

}  // namespace

core::Planes ReferenceFrame::mean() const {
  core::Planes mean(first.width(), first.height());
  core::forEachPixel(mean.width(), mean.height(), [&](int x, int y) {
    mean.view().store(x, y, 0.5f * (first.view().load(x, y) + second.view().load(x, y)));
  });
  return mean;
}

void renderReference(const Instant& instant, int samples, std::uint64_t stream, int tile, core::PlanesView<float> out) {
  const core::Moment moment = instant.moment();
  const core::PlanesView<const float> emission = instant.gbuffer.emission;
  core::forEachPixel(
      out.width(), out.height(),
      [&](int x, int y) {
        const core::Surface& surface = moment.surfaces(x, y);
        const vec3 direct = surface.hit() ? restir::meanDirect(moment, surface, samples, stream,
                                                               static_cast<std::uint32_t>(y * out.width() + x))
                                          : vec3(0);
        out.store(x, y, direct + emission.load(x, y));
      },
      tile);
}

References::References(const Stage& stage, const Config& config, std::string sceneHash)
    : stage_(stage), config_(config), sceneHash_(std::move(sceneHash)) {}

std::filesystem::path References::fileOf(int frame) const {
  return std::filesystem::path(config_.reference.cache) /
         fmt::format("{}-{}x{}-{}spp-v{}.{:04}.exr", sceneHash_, config_.width, config_.height,
                     config_.reference.samples, kReferenceVersion, frame);
}

ReferenceFrame References::render(int frame) const {
  Instant instant;
  instant.gbuffer = core::GBuffer(config_.width, config_.height);
  stage_.pose(static_cast<std::uint32_t>(frame), nullptr, instant);
  stage_.trace(instant.pose, config_.render.features, config_.render.tile, instant);
  ReferenceFrame r{core::Planes(config_.width, config_.height), core::Planes(config_.width, config_.height)};
  renderReference(instant, config_.reference.samples, kFirstStream, config_.render.tile, r.first);
  renderReference(instant, config_.reference.samples, kSecondStream, config_.render.tile, r.second);
  return r;
}

const ReferenceFrame& References::at(int frame) {
  if (const auto found = kept_.find(frame); found != kept_.end()) return found->second;
  const bool caching = !config_.reference.cache.empty();
  const auto file = fileOf(frame);
  if (caching && std::filesystem::exists(file)) {
    try {
      const core::ExrImage image = core::readExr(file);
      if (image.width == config_.width && image.height == config_.height)
        return kept_[frame] = {core::rgbOf(image, "first", file.string()), core::rgbOf(image, "second", file.string())};
    } catch (const core::Error& error) {
      fmt::print(stderr, "twofold: {}; it is rendered anew\n", error.what());
    }
  }
  ReferenceFrame& r = kept_[frame] = render(frame);
  if (caching) {
    std::filesystem::create_directories(config_.reference.cache);
    core::ExrImage image;
    image.add("first", r.first.view());
    image.add("second", r.second.view());
    core::writeExr(file, image);
  }
  return r;
}

}  // namespace experiments
