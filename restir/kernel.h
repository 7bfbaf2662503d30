// What the passes share: whole counts, compiled features, and where a reservoir's target was.
#pragma once

#include <new>

#include "core/parallel.h"
#include "restir/restir.h"

namespace restir {

/// Batches that a sample count asks for: whole, at least one wherever n > 0.
inline int batchesOf(float n) { return n > 0 ? std::max(1, static_cast<int>(std::lround(n))) : 0; }

inline std::uint32_t pixelIndex(const Frame& frame, int x, int y) {
  return static_cast<std::uint32_t>(y * frame.samples.width + x);
}

/// What the scene has, or everything.
inline LightFeatures lightFeatures(const RestirParameters& parameters, const Frame& frame) {
  const bool all = parameters.features == Features::all;
  return all ? LightFeatures{true, true} : frame.now.lights->features();
}

/// Calls body.template operator()<F>() for those.
template <class Body>
void withLightFeatures(const RestirParameters& parameters, const Frame& frame, Body&& body) {
  core::withFeatures(lightFeatures(parameters, frame), body);
}

/// The same, and whether targets include visibility: body.template operator()<F, kVisibility>().
template <class Body>
void withTargetFeatures(const RestirParameters& parameters, const Frame& frame, Body&& body) {
  withLightFeatures(parameters, frame, [&]<LightFeatures F>() {
    if (parameters.targetVisibility)
      body.template operator()<F, true>();
    else
      body.template operator()<F, false>();
  });
}

/// A few values in place, for things that are made one by one and need no destructor.
template <class T, int Capacity>
class InlineVector {
 public:
  template <class... Args>
  void add(Args&&... args) {
    DCHECK(count_ < Capacity);
    new (bytes_ + sizeof(T) * count_++) T{std::forward<Args>(args)...};
  }
  operator std::span<const T>() const { return {std::launder(reinterpret_cast<const T*>(bytes_)), count_}; }

 private:
  static_assert(std::is_trivially_destructible_v<T>);
  alignas(T) std::byte bytes_[sizeof(T) * Capacity];
  std::size_t count_ = 0;
};

/// What a target is made of.
struct TargetParts {
  const Surface* surface;
  vec3 viewer;
  const Lights* lights;
  const core::Tracer* tracer;  ///< null only where no target includes visibility
  template <LightFeatures F, bool kVisibility = false>
  Target<F, kVisibility> target() const {
    if constexpr (kVisibility)
      return {*surface, viewer, *lights, *tracer};
    else
      return {*surface, viewer, *lights};
  }
};

/// Target parts of the reservoir that `moment` stores at a pixel. waited: surfaces of those that wait. The frame it is
/// stamped with must be remembered.
inline TargetParts partsOf(const Reservoir& reservoir, std::int32_t pixel, const Moment& moment, In<Surface> waited,
                           const PastMoments& past) {
  if (reservoir.frame == moment.frame)
    return {&moment.surfaces.at(pixel), moment.cameraPosition, moment.lights.get(), moment.tracer.get()};
  const PastMoment* then = past.find(reservoir.frame);
  CHECK(then != nullptr);
  return {&waited.at(pixel), then->viewer, then->lights.get(), then->tracer.get()};
}

/// Target parts of a pixel in this frame.
inline TargetParts partsOf(const Frame& frame, int x, int y) {
  return {&frame.now.surfaces(x, y), frame.now.cameraPosition, frame.now.lights.get(), frame.now.tracer.get()};
}

}  // namespace restir
