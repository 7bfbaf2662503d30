// How users are told what of a glTF file is not supported or wrong.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/check.h"
#include "core/maths.h"

namespace core {

/// What to do about most of what can be wrong with a file.
inline constexpr const char* kRepair = "repair the file or export it again";

/// A parser's complaint as one line.
Error unreadable(const std::string& where, std::string complaint);

/// A number of the file as float. Throws Error naming `where` unless low <= value <= high.
float inRange(double value, double low, double high, const std::string& where);

/// The first N numbers as a vector. Throws Error naming `where` for fewer, or for one out of range.
template <int N>
glm::vec<N, float> toVec(const std::vector<double>& numbers, double low, double high, const std::string& where) {
  if (numbers.size() < N) throw Error(where, "has a vector of too few numbers", kRepair);
  glm::vec<N, float> v;
  for (int i = 0; i < N; ++i) v[i] = inRange(numbers[i], low, high, where);
  return v;
}

/// Adds a warning unless it is there already: each kind is told once.
void warnOnce(std::vector<std::string>& warnings, const std::string& warning);

/// Throws Error naming `where` if the JSON text requires a compression of vertices, without which a parser would only
/// complain of what is missing.
void checkCompression(std::string_view json, const std::string& where);

/// Warns of every extension in use that is not supported.
void checkExtensions(const std::vector<std::string>& used, const std::vector<std::string>& required,
                     std::vector<std::string>& warnings);

}  // namespace core
