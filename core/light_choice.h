// Ways to draw a light for a surface, behind one pair of sample and density: uniformly, by power, or from a light tree.
#pragma once

#include "core/light_tree.h"

namespace core {

/// uniform: every light that has power alike. power: by share of the power, wherever the surface is. tree: by bounds
/// on what arrives (light_tree.h); lights at infinity apart, by their share of the power.
enum class LightSampler : std::uint8_t { uniform, power, tree };

/// A light point and the density of drawing it, in the measure of lights.h.
struct LightDraw {
  LightSample sample;
  float pdf = 0;
};

/// Uniform bits that a light point is drawn with: 64 for the light, the more significant first, and where on it.
struct LightBits {
  std::uint32_t high = 0, low = 0;
  std::array<std::uint32_t, 2> where{};
};

/// Lights ready to be drawn from in one way. Only what that way needs is built; `power` builds nothing.
class LightChoice {
 public:
  LightChoice() = default;
  /// lights must outlive this and stay as they are.
  LightChoice(const Lights& lights, LightSampler sampler);

  /// Draws a point on a light, for a surface whose normal faces the side that reflects; invalid only where no light has
  /// power. rng: as for Lights::sampleAt().
  LightDraw sample(const vec3& position, const vec3& normal, const LightBits& bits, Rng& rng) const;
  /// Density with which sample() gives y.
  float pdf(const LightSample& y, const vec3& position, const vec3& normal) const;

  std::size_t bytes() const { return tree_.bytes() + lit_.size() * sizeof(lit_[0]); }

 private:
  LightDraw sampleUniform(const LightBits& bits, Rng& rng) const;
  LightDraw sampleTree(const vec3& position, const vec3& normal, const LightBits& bits, Rng& rng) const;
  void listInfinite();

  struct Infinite {
    std::uint32_t light = 0;
    double until = 0;  ///< probability of this and all before it
  };

  const Lights* lights_ = nullptr;
  LightSampler sampler_ = LightSampler::power;
  std::vector<std::uint32_t> lit_;  // uniform: lights that have power
  LightTree tree_;
  std::vector<Infinite> infinite_;  // tree: lights that are in no tree
  double infiniteShare_ = 0;
};

}  // namespace core
