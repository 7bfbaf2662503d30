// Small pieces of HTML and SVG text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace experiments {

/// Text with &, <, >, " and ' escaped, for element content and attribute values.
std::string escaped(std::string_view text);

/// RFC 4648 base 64, for data: URIs.
std::string base64(std::string_view bytes);

/// A number for people: four significant digits, exponents only where needed; a dash if not finite.
std::string shortNumber(double x);

/// CSS class of the i-th line or bar ("s0", "s1", ...); colours repeat, line dashes then differ.
std::string seriesClass(std::size_t i);
inline constexpr std::size_t kSeriesClasses = 16;

/// Round numbers that span [low, high]: steps of 1, 2 or 5 times a power of ten, about `count` of them.
std::vector<double> linearTicks(double low, double high, int count = 5);
/// Round numbers for a logarithmic axis, low > 0: decades, with more between them where there is room.
std::vector<double> logarithmicTicks(double low, double high);

}  // namespace experiments
