#include "experiments/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/files.h"

namespace experiments {

namespace {

/// Walks over text and counts the lines it has passed, for all copies of the iterator together.
class LineCounter {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineCounter(const char* at, int* line) : at_(at), line_(line) {}
  const char& operator*() const { return *at_; }
  LineCounter& operator++() {
    if (*at_++ == '\n') ++*line_;
    return *this;
  }
  LineCounter operator++(int) {
    LineCounter old = *this;
    ++*this;
    return old;
  }
  bool operator==(const LineCounter& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  int* line_;
};

/// Objects that are open while JSON is parsed, and the keys each has had.
class DuplicateKeys {
 public:
  void see(Json::parse_event_t event, const Json& parsed, const std::string& where, int line) {
    if (event == Json::parse_event_t::object_start) open_.emplace_back();
    if (event == Json::parse_event_t::object_end) open_.pop_back();
    if (event != Json::parse_event_t::key) return;
    const auto key = parsed.get<std::string>();
    if (!open_.back().insert(key).second)
      throw core::UsageError(where, fmt::format("line {}: the key \"{}\" appears twice in one object", line, key),
                             "remove one of them");
  }

 private:
  std::vector<std::set<std::string>> open_;
};

/// What the parser says without its prefix "[json.exception...]".
std::string plainMessage(const std::string& message) {
  const std::size_t end = message.find("] ");
  std::string plain = end == std::string::npos ? message : message.substr(end + 2);
  std::replace_if(
      plain.begin(), plain.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return plain;
}

/// A value as it stands in a message: one line, not too long, valid UTF-8.
std::string shown(const Json& json) {
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() <= 60 ? text : text.substr(0, 57) + "...";
}

/// The words between dots of a path.
std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> words(1);
  for (const char c : path) {
    if (c == '.')
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

/// Element or member of json that a word names; members are created.
Json& step(Json& json, const std::string& word, const std::string& assignment) {
  if (json.is_null()) json = Json::object();
  if (json.is_object() && !word.empty()) return json[word];
  const bool number = !word.empty() && word.size() < 7 && word.find_first_not_of("0123456789") == std::string::npos;
  if (json.is_array() && number && std::stoul(word) < json.size()) return json[std::stoul(word)];
  throw core::UsageError("--set " + assignment,
                         fmt::format("\"{}\" does not name anything inside {}", word, shown(json)),
                         "give path.to.key=value, with element numbers from 0 for lists");
}

Json parseOrString(const std::string& text) {
  Json value = Json::parse(text, nullptr, false);
  return value.is_discarded() ? Json(text) : value;
}

}  // namespace

Json parseJson(const std::string& text, const std::string& where) {
  int line = 1;
  DuplicateKeys keys;
  const Json::parser_callback_t callback = [&](int, Json::parse_event_t event, Json& parsed) {
    keys.see(event, parsed, where, line);
    return true;
  };
  try {
    return Json::parse(LineCounter(text.data(), &line), LineCounter(text.data() + text.size(), &line), callback);
  } catch (const Json::exception& e) {
    const std::string message = plainMessage(e.what());
    const std::string place = message.find("line ") == std::string::npos ? fmt::format(" near line {}", line) : "";
    throw core::UsageError(where, "not JSON" + place + ": " + message,
                           "correct that place (comments and trailing commas are not allowed)");
  }
}

Json readJson(const std::string& file) {
  try {
    return parseJson(core::readFile(file), file);
  } catch (const core::UsageError&) {
    throw;
  } catch (const core::Error& e) {
    throw core::UsageError("configuration", e.what(), "name a JSON file that you may read");
  }
}

void applyAssignment(Json& config, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw core::UsageError("--set " + assignment, "is not an assignment", "write path.to.key=value");
  Json* place = &config;
  for (const std::string& word : split(assignment.substr(0, equals))) place = &step(*place, word, assignment);
  *place = parseOrString(assignment.substr(equals + 1));
}

void applyAssignments(Json& config, const std::vector<std::string>& assignments) {
  for (const std::string& assignment : assignments) applyAssignment(config, assignment);
}

SettingsReader::SettingsReader(const Json& json, std::string path) : json_(json), path_(std::move(path)) {
  if (!json.is_object()) settings_detail::wrongType(json, path_, "an object {\"key\": value, ...}");
}

void SettingsReader::finish() const {
  for (const auto& item : json_.items())
    if (std::find(known_.begin(), known_.end(), item.key()) == known_.end())
      throw core::UsageError(path_ + "." + item.key(), "is not a known key",
                             "known keys here: " + settings_detail::join(known_));
}

const Json* SettingsReader::find(const char* name) {
  known_.emplace_back(name);
  const auto found = json_.find(name);
  return found == json_.end() ? nullptr : &*found;
}

std::size_t SettingsReader::indexOf(const Json& json, const std::string& path, const std::vector<std::string>& words) {
  const std::string expected = "one of " + settings_detail::join(words);
  if (!json.is_string()) settings_detail::wrongType(json, path, expected.c_str());
  const auto found = std::find(words.begin(), words.end(), json.get<std::string>());
  if (found == words.end()) throw core::UsageError(path, shown(json) + " is not a choice", "give " + expected);
  return static_cast<std::size_t>(found - words.begin());
}

void SettingsLister::add(const char* name, const Json& standard, const std::string& limits, const char* meaning) {
  lines_.push_back(
      {prefix_ + name, standard.is_string() ? standard.get<std::string>() : standard.dump(), limits, meaning});
}

std::string SettingsLister::text() const {
  std::size_t width = 0;
  for (const Line& line : lines_) width = std::max(width, line.key.size() + line.standard.size() + 3);
  std::string text;
  for (const Line& line : lines_) {
    const std::string key = line.key + " = " + line.standard;
    const std::string limits = line.limits.empty() ? "" : " " + line.limits;
    text += fmt::format("  {:<{}}  {}{}\n", key, std::min<std::size_t>(width, 44), line.meaning, limits);
  }
  return text;
}

namespace settings_detail {

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string rangeText(Range range) {
  const bool below = std::isfinite(range.maximum), above = std::isfinite(range.minimum);
  if (above && below) return fmt::format("[{:g}, {:g}]", range.minimum, range.maximum);
  if (above) return fmt::format("[{:g}, ...)", range.minimum);
  return below ? fmt::format("(..., {:g}]", range.maximum) : "";
}

void wrongType(const Json& json, const std::string& path, const char* expected) {
  throw core::UsageError(path, shown(json) + " has the wrong type", std::string("give ") + expected);
}

namespace {

void requireRange(double number, const Json& json, const std::string& path, Range range) {
  if (number >= range.minimum && number <= range.maximum) return;
  throw core::UsageError(path, shown(json) + " is outside " + rangeText(range), "give a number inside");
}

/// JSON numbers such as 3.0 or 1e3 count as whole.
void requireWhole(const Json& json, const std::string& path) {
  if (json.is_number_integer()) return;
  if (!json.is_number()) wrongType(json, path, "a whole number");
  const double number = json.get<double>();
  if (number != std::floor(number) || std::abs(number) > 0x1p53) wrongType(json, path, "a whole number");
}

}  // namespace

double readNumber(const Json& json, const std::string& path, Range range) {
  if (!json.is_number()) wrongType(json, path, "a number");
  const double number = json.get<double>();
  requireRange(number, json, path, range);
  return number;
}

std::int64_t readInteger(const Json& json, const std::string& path, Range range, std::int64_t lowest) {
  requireWhole(json, path);
  const double limit = std::min(range.maximum, 0x1.fffffffffffffp62);  // the last double below 2^63
  requireRange(json.get<double>(), json, path, {std::max(range.minimum, static_cast<double>(lowest)), limit});
  return json.get<std::int64_t>();
}

std::uint64_t readUnsigned(const Json& json, const std::string& path, Range range, std::uint64_t highest) {
  requireWhole(json, path);
  const double limit = std::min(range.maximum, static_cast<double>(highest));
  requireRange(json.get<double>(), json, path, {std::max(range.minimum, 0.0), limit});
  return json.get<std::uint64_t>();
}

double shortest(float x) { return std::isfinite(x) ? std::stod(fmt::format("{}", x)) : static_cast<double>(x); }

}  // namespace settings_detail

}  // namespace experiments
