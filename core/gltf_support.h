// What of glTF this project does not read, and how its users are told.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace core {

/// Adds a warning unless it is there already: each kind is told once.
void warnOnce(std::vector<std::string>& warnings, const std::string& warning);

/// Throws Error naming `where` if the JSON text requires a compression of vertices, without which a parser would only
/// complain of what is missing.
void checkCompression(std::string_view json, const std::string& where);

/// Warns of every extension in use that is not supported.
void checkExtensions(const std::vector<std::string>& used, const std::vector<std::string>& required,
                     std::vector<std::string>& warnings);

}  // namespace core
