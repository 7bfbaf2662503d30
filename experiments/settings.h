// Typed settings: every module describes its parameters once, and the same description reads JSON, writes JSON and
// lists the keys for --help.
//
// A parameter aggregate P has in-class defaults and, in its own namespace,
//
//   template <class V> void describe(V& v, P& p) {
//     v("decay", p.decay, "share of the history kept a frame", 0, 1);   // number: name, value, meaning, minimum,
//     maximum v("filter", p.filter, "the filter after blending");               // nested aggregate, bool, string,
//     vector, ... v.choice("mis", p.mis, {{"constant", Mis::constant}, {"balance", Mis::balance}}, "MIS weights of
//     merging");
//   }
//
// Members may be bool, integers, float, double, std::string, core::vec2/vec3/vec4, std::array, std::vector,
// std::optional (null = absent), described aggregates, and Json (anything, read by its owner later).
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace experiments {

using Json = nlohmann::ordered_json;  ///< objects keep the order in which keys were written

/// Limits of a number, both ends allowed.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity(), maximum = std::numeric_limits<double>::infinity();
};

/// JSON from text. Throws core::UsageError with where and the line for malformed text, comments and duplicate keys.
Json parseJson(const std::string& text, const std::string& where);
/// JSON from a file; an unreadable file is a core::UsageError too.
Json readJson(const std::string& file);

/// Sets one value in a configuration: "path.to.key=value". value is parsed as JSON, else taken as a string. Missing
/// objects on the way are created; a number addresses an element of an array. Throws core::UsageError.
void applyAssignment(Json& config, const std::string& assignment);
void applyAssignments(Json& config, const std::vector<std::string>& assignments);

/// Reads an aggregate from JSON: keys that are absent leave p as it is. Unknown keys, wrong types, numbers that are not
/// finite or out of range throw core::UsageError that starts with the key's path.
template <class P>
void fromJson(const Json& json, P& p, const std::string& path = "config");

/// All values of an aggregate, in the order described; fromJson(toJson(p)) gives p back.
template <class P>
Json toJson(const P& p);

/// One line per key for --help: path, default, limits or choices, meaning.
template <class P>
std::string listKeys(const P& defaults);

}  // namespace experiments

#include "experiments/settings_visitors.h"
