// Direct light without reuse: the baselines and the references. One sample is a light sample and a BSDF sample,
// combined by the balance heuristic, with visibility from rays that stop at the first hit. Source: Veach, "Robust Monte
// Carlo Methods for Light Transport Simulation" (1997), section 9.2. Shares no choice with ReSTIR beyond lights and
// materials.
#pragma once

#include "core/light_choice.h"
#include "core/moment.h"

namespace restir {

/// Mean of `samples` >= 1 samples, spread evenly (core/lattice.h), each unbiased by itself, of the light that a surface
/// reflects to the camera (not demodulated, emission excluded). choice: how the moment's own lights are drawn; rng:
/// gives all random numbers.
core::vec3 meanDirect(const core::Moment& moment, const core::Surface& surface, const core::LightChoice& choice,
                      int samples, core::Rng rng);

/// The same with lights drawn by power: references. stream: different streams are independent; pixel: row-major index.
core::vec3 meanDirect(const core::Moment& moment, const core::Surface& surface, int samples, std::uint64_t stream,
                      std::uint32_t pixel);

}  // namespace restir
