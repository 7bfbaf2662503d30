#include "experiments/json_text.h"

#include <cmath>

namespace experiments {

namespace {

std::string listText(const Json& list) {
  std::string text;
  for (const Json& element : list) text += (text.empty() ? "[\n  " : ",\n  ") + compactText(element);
  return text + "\n]";
}

}  // namespace

Json numberOrNull(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

std::string compactText(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string listedText(const Json& object) {
  std::string text;
  for (const auto& [key, value] : object.items()) {
    text += (text.empty() ? "{\n" : ",\n") + compactText(key) + ": ";
    text += value.is_array() && !value.empty() ? listText(value) : compactText(value, 2);
  }
  return text + "\n}\n";
}

}  // namespace experiments
