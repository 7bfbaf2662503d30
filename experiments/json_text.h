// JSON as text that people can read and compare line by line.
#pragma once

#include <string>

#include "experiments/settings.h"

namespace experiments {

/// JSON has no NaN and no infinity: null stands for them.
Json numberOrNull(double x);

/// One line; bytes that are not UTF-8 (from a command line) are replaced. indent >= 0 gives several lines.
std::string compactText(const Json& json, int indent = -1);

/// An object with one line per element of its lists, however deep the elements are; ends with a line feed.
std::string listedText(const Json& object);

}  // namespace experiments
