// The scenes that come with the program, made in code. Metres, y up; all keep moving for at least 8 seconds.
#pragma once

#include <string>
#include <vector>

#include "core/scene.h"

namespace experiments {

std::vector<std::string> builtinSceneNames();

/// Throws UsageError that lists the names for any other name.
core::Scene builtinScene(const std::string& name);

/// The Cornell box: one area light, two boxes, nothing moves.
core::Scene cornellScene();
/// A room lit through the slit of a door that stands ajar and swings slowly.
core::Scene ajarScene();
/// A night market: many small lights of all colours, some flickering, some moving, over a wet street.
core::Scene marketScene();

}  // namespace experiments
