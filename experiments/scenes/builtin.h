// The scenes that come with the program, made in code. Metres, y up; all keep moving for at least 8 seconds.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"

namespace experiments {

/// One name a scene; of those with a number in their name, one example.
std::vector<std::string> builtinSceneNames();
bool isBuiltin(const std::string& name);
/// Throws UsageError that lists the names for any other name, or says which numbers there are.
core::Scene builtinScene(const std::string& name);

/// The Cornell box: one area light, two boxes, nothing moves.
core::Scene cornellScene();
/// A room lit through the slit of a door that stands ajar and swings slowly.
core::Scene ajarScene();
/// A hall with N small lamps, `lamps-N`; throws UsageError where N is not a whole number from 1 to 4,000,000.
core::Scene lampsScene(const std::string& name);
/// N of `lamps-N`; 0 for every other name.
int lampsIn(std::string_view name);
/// Whether a name asks for it, with whatever number.
bool isLamps(const std::string& name);
/// A night market: many small lights of all colours, some flickering, some moving, over a wet street.
core::Scene marketScene();

}  // namespace experiments
