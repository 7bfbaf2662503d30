// Filling tiles, and which block of pixels gets which.
#include "restir/light_tiles.h"

#include <algorithm>

#include "core/parallel.h"

namespace restir {
namespace {

constexpr int kLeastTiles = 8, kMostTiles = 128, kSharing = 32;

bool wanted(TileUse use, const core::Lights& lights) {
  if (use == TileUse::never || lights.empty()) return false;
  return use == TileUse::always || lights.size() >= LightTiles::kManyLights;
}

}  // namespace

void LightTiles::fill(TileUse use, const core::Lights& lights, core::LightFeatures features, std::int64_t candidates,
                      std::uint64_t seed, std::uint32_t frame) {
  count_ = 0, seed_ = seed, frame_ = frame;
  if (!wanted(use, lights)) return;
  count_ = static_cast<int>(std::clamp<std::int64_t>(candidates / (kTileSize * kSharing), kLeastTiles, kMostTiles));
  samples_.resize(static_cast<std::size_t>(count_) * kTileSize);
  core::withFeatures(features, [&]<core::LightFeatures F>() {
    core::forEachIndex(
        samples_.size(),
        [&](std::size_t i) {
          core::Rng rng(seed, core::Pass::lightTiles, static_cast<std::uint32_t>(i), frame);
          samples_[i] = lights.presample<F>(lights.sample(rng));
        },
        kTileSize);
  });
}

std::span<const core::PresampledLight> LightTiles::of(int x, int y) const {
  if (count_ == 0) return {};
  const auto block = static_cast<std::uint32_t>(y / kBlock) << 16 | static_cast<std::uint32_t>(x / kBlock);
  core::Rng rng(seed_, core::Pass::lightTiles, block, frame_, 1);
  const std::size_t tile = rng.below(static_cast<std::uint32_t>(count_));
  return std::span(samples_).subspan(tile * kTileSize, kTileSize);
}

}  // namespace restir
