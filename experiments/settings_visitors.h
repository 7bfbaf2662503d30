// The three visitors behind settings.h: one reads JSON, one writes it, one lists keys. Included by settings.h alone.
#pragma once

#include <array>
#include <concepts>
#include <initializer_list>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/check.h"
#include "core/maths.h"
#include "experiments/settings.h"

namespace experiments {

namespace settings_detail {

/// Stands for any visitor where only the existence of describe() is asked for.
struct AnyVisitor {
  template <class T>
  void operator()(const char*, T&, const char*, double = 0, double = 0) {}
  template <class E>
  void choice(const char*, E&, std::initializer_list<std::pair<const char*, std::type_identity_t<E>>>, const char*) {}
};
template <class T>
concept Described = requires(AnyVisitor& v, T& t) {
  describe(v, t);
};

template <class T>
inline constexpr int kVectorSize = 0;  ///< components of a GLM vector
template <int N, class S, glm::qualifier Q>
inline constexpr int kVectorSize<glm::vec<N, S, Q>> = N;
template <class T, std::size_t N>
inline constexpr int kVectorSize<std::array<T, N>> = static_cast<int>(N);

template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsList = false;
template <class T>
inline constexpr bool kIsList<std::vector<T>> = true;

std::string join(const std::vector<std::string>& words);
std::string rangeText(Range range);

[[noreturn]] void wrongType(const Json& json, const std::string& path, const char* expected);
double readNumber(const Json& json, const std::string& path, Range range);
std::int64_t readInteger(const Json& json, const std::string& path, Range range, std::int64_t lowest);
std::uint64_t readUnsigned(const Json& json, const std::string& path, Range range, std::uint64_t highest);
/// The shortest decimal that gives the same float, as a double (0.95f is written as 0.95).
double shortest(float x);

template <class T>
void readValue(const Json& json, T& value, const std::string& path, Range range);
template <class T>
Json writeValue(const T& value);

}  // namespace settings_detail

/// Reads the members of one aggregate; finish() reports keys that none of them has.
class SettingsReader {
 public:
  SettingsReader(const Json& json, std::string path);
  void finish() const;

  template <class T>
  void operator()(const char* name, T& value, const char*, double minimum = Range{}.minimum,
                  double maximum = Range{}.maximum) {
    if (const Json* found = find(name)) settings_detail::readValue(*found, value, pathOf(name), {minimum, maximum});
  }
  template <class E>
  void choice(const char* name, E& value, std::initializer_list<std::pair<const char*, std::type_identity_t<E>>> names,
              const char*) {
    const Json* found = find(name);
    if (!found) return;
    const std::vector<std::string> words = wordsOf(names);
    value = (names.begin() + indexOf(*found, pathOf(name), words))->second;
  }

 private:
  template <class Names>
  static std::vector<std::string> wordsOf(const Names& names) {
    std::vector<std::string> words;
    for (const auto& entry : names) words.emplace_back(entry.first);
    return words;
  }
  static std::size_t indexOf(const Json& json, const std::string& path, const std::vector<std::string>& words);
  const Json* find(const char* name);
  std::string pathOf(const char* name) const { return path_ + "." + name; }

  const Json& json_;
  std::string path_;
  std::vector<std::string> known_;
};

/// Collects the members of one aggregate as a JSON object.
class SettingsWriter {
 public:
  template <class T>
  void operator()(const char* name, const T& value, const char*, double = 0, double = 0) {
    json_[name] = settings_detail::writeValue(value);
  }
  template <class E>
  void choice(const char* name, const E& value,
              std::initializer_list<std::pair<const char*, std::type_identity_t<E>>> names, const char*) {
    for (const auto& entry : names)
      if (entry.second == value) json_[name] = entry.first;
  }
  Json json() && { return std::move(json_); }

 private:
  Json json_ = Json::object();
};

/// Lists the members of an aggregate and of those nested in it.
class SettingsLister {
 public:
  explicit SettingsLister(std::string prefix) : prefix_(std::move(prefix)) {}

  template <class T>
  void operator()(const char* name, T& value, const char* meaning, double minimum = Range{}.minimum,
                  double maximum = Range{}.maximum) {
    if constexpr (settings_detail::Described<T>) {
      SettingsLister nested(prefix_ + name + ".");
      describe(nested, value);
      lines_.insert(lines_.end(), nested.lines_.begin(), nested.lines_.end());
    } else if constexpr (requires { requires settings_detail::Described<typename T::value_type>; }) {
      // A list of aggregates: how many there are, then what each of them has.
      add(name, std::to_string(value.size()) + " of them", "", meaning);
      typename T::value_type one{};
      SettingsLister nested(prefix_ + name + "[].");
      describe(nested, one);
      lines_.insert(lines_.end(), nested.lines_.begin(), nested.lines_.end());
    } else {
      add(name, settings_detail::writeValue(value), settings_detail::rangeText({minimum, maximum}), meaning);
    }
  }
  template <class E>
  void choice(const char* name, E& value, std::initializer_list<std::pair<const char*, std::type_identity_t<E>>> names,
              const char* meaning) {
    std::string words, current;
    for (const auto& [word, e] : names) {
      words += (words.empty() ? "" : "|") + std::string(word);
      if (e == value) current = word;
    }
    add(name, current, words, meaning);
  }
  std::string text() const;

 private:
  struct Line {
    std::string key, standard, limits, meaning;
  };
  void add(const char* name, const Json& standard, const std::string& limits, const char* meaning);

  std::string prefix_;
  std::vector<Line> lines_;
};

namespace settings_detail {

/// Element path of an array: path[i].
inline std::string elementPath(const std::string& path, std::size_t i) { return path + "[" + std::to_string(i) + "]"; }

template <class T>
void readFixedArray(const Json& json, T& value, const std::string& path, Range range) {
  const auto size = static_cast<std::size_t>(kVectorSize<T>);
  if (!json.is_array() || json.size() != size)
    wrongType(json, path, ("a list of " + std::to_string(size) + " values").c_str());
  for (std::size_t i = 0; i < size; ++i) {
    auto& element = value[static_cast<int>(i)];
    readValue(json[i], element, elementPath(path, i), range);
  }
}

template <class T>
void readList(const Json& json, std::vector<T>& value, const std::string& path, Range range) {
  if (!json.is_array()) wrongType(json, path, "a list");
  value.assign(json.size(), T{});
  for (std::size_t i = 0; i < json.size(); ++i) {
    T element{};
    readValue(json[i], element, elementPath(path, i), range);
    value[i] = std::move(element);
  }
}

template <class T>
void readOptional(const Json& json, std::optional<T>& value, const std::string& path, Range range) {
  value.reset();
  if (!json.is_null()) readValue(json, value.emplace(), path, range);
}

template <class T>
void readScalar(const Json& json, T& value, const std::string& path, Range range) {
  if constexpr (std::is_same_v<T, bool>) {
    if (!json.is_boolean()) wrongType(json, path, "true or false");
    value = json.get<bool>();
  } else if constexpr (std::signed_integral<T>) {
    range.maximum = std::min(range.maximum, static_cast<double>(std::numeric_limits<T>::max()));
    value = static_cast<T>(readInteger(json, path, range, std::numeric_limits<T>::min()));
  } else if constexpr (std::unsigned_integral<T>) {
    value = static_cast<T>(readUnsigned(json, path, range, std::numeric_limits<T>::max()));
  } else if constexpr (std::floating_point<T>) {
    const auto limit = static_cast<double>(std::numeric_limits<T>::max());
    range = {std::max(range.minimum, -limit), std::min(range.maximum, limit)};
    value = static_cast<T>(readNumber(json, path, range));
  } else {
    static_assert(std::is_same_v<T, std::string>, "settings.h lists the types that settings may have");
    if (!json.is_string()) wrongType(json, path, "a string");
    value = json.get<std::string>();
  }
}

template <class T>
void readValue(const Json& json, T& value, const std::string& path, Range range) {
  if constexpr (std::is_same_v<T, Json>) {
    value = json;
  } else if constexpr (Described<T>) {
    fromJson(json, value, path);
  } else if constexpr (kVectorSize<T> > 0) {
    readFixedArray(json, value, path, range);
  } else if constexpr (kIsList<T>) {
    readList(json, value, path, range);
  } else if constexpr (kIsOptional<T>) {
    readOptional(json, value, path, range);
  } else {
    readScalar(json, value, path, range);
  }
}

template <class T>
Json writeArray(const T& value, std::size_t size) {
  Json list = Json::array();
  for (std::size_t i = 0; i < size; ++i) list.push_back(writeValue(value[static_cast<int>(i)]));
  return list;
}

template <class T>
Json writeValue(const T& value) {
  if constexpr (Described<T>) {
    return toJson(value);
  } else if constexpr (kVectorSize<T> > 0) {
    return writeArray(value, static_cast<std::size_t>(kVectorSize<T>));
  } else if constexpr (kIsList<T>) {
    Json list = Json::array();
    for (const auto& element : value) list.push_back(writeValue(element));
    return list;
  } else if constexpr (kIsOptional<T>) {
    return value ? writeValue(*value) : Json(nullptr);
  } else if constexpr (std::is_same_v<T, float>) {
    return shortest(value);
  } else {
    return Json(value);
  }
}

}  // namespace settings_detail

template <class P>
void fromJson(const Json& json, P& p, const std::string& path) {
  SettingsReader reader(json, path);
  describe(reader, p);
  reader.finish();
}

template <class P>
Json toJson(const P& p) {
  P copy = p;
  SettingsWriter writer;
  describe(writer, copy);
  return std::move(writer).json();
}

template <class P>
std::string listKeys(const P& defaults) {
  P copy = defaults;
  SettingsLister lister("");
  describe(lister, copy);
  return lister.text();
}

}  // namespace experiments
