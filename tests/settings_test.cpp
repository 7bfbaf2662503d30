// Settings: reading, writing, assignments, and one clear line for everything that is wrong.
#include "experiments/settings.h"

#include <gtest/gtest.h>

#include <optional>

namespace experiments {
namespace lab {

enum class Kind { round, square };

struct Inner {
  float share = 0.95f;
  int levels = 2;
};
template <class V>
void describe(V& v, Inner& p) {
  v("share", p.share, "kept a frame", 0.0, 1.0);
  v("levels", p.levels, "of the filter", 1, 5);
}

struct Outer {
  bool fast = true;
  std::uint64_t seed = 7;
  double gain = 1.5;
  std::string name = "plain";
  Kind kind = Kind::round;
  core::vec2 centre{0.5f, 0.25f};
  std::array<int, 2> pair{0, 1};
  std::vector<Inner> layers{Inner{}};
  std::vector<int> frames;
  std::optional<float> limit;
  Inner inner;
  Json extra = Json::object();
};
template <class V>
void describe(V& v, Outer& p) {
  v("fast", p.fast, "yes or no");
  v("seed", p.seed, "of the random numbers");
  v("gain", p.gain, "any number");
  v("name", p.name, "any text");
  v.choice("kind", p.kind, {{"round", Kind::round}, {"square", Kind::square}}, "of the fovea");
  v("centre", p.centre, "fractions", -10.0, 10.0);
  v("pair", p.pair, "indices", 0, 2);
  v("layers", p.layers, "a list of aggregates");
  v("frames", p.frames, "a list of numbers", 0, 1000);
  v("limit", p.limit, "absent = none", 0.0, 100.0);
  v("inner", p.inner, "an aggregate");
  v("extra", p.extra, "anything");
}

}  // namespace lab

namespace {

lab::Outer read(const std::string& text) {
  lab::Outer outer;
  fromJson(parseJson(text, "test.json"), outer);
  return outer;
}

/// The message that reading `text` fails with; empty if it does not fail.
std::string failure(const std::string& text) {
  try {
    read(text);
  } catch (const core::UsageError& e) {
    return e.what();
  }
  return "";
}

testing::AssertionResult says(const std::string& message, std::initializer_list<const char*> parts) {
  if (message.empty()) return testing::AssertionFailure() << "no failure";
  if (message.find('\n') != std::string::npos) return testing::AssertionFailure() << "more than one line: " << message;
  for (const char* part : parts)
    if (message.find(part) == std::string::npos)
      return testing::AssertionFailure() << "\"" << message << "\" lacks \"" << part << "\"";
  return testing::AssertionSuccess();
}

TEST(Settings, AbsentKeysKeepTheirDefaults) {
  const lab::Outer outer = read("{}");
  EXPECT_EQ(toJson(outer), toJson(lab::Outer{}));
}

TEST(Settings, EveryKindOfValueIsRead) {
  const lab::Outer o =
      read(R"({"fast": false, "seed": 18446744073709551615, "gain": -2e3, "name": "x", "kind": "square",
    "centre": [1, 2.5], "pair": [2, 0], "layers": [{"share": 0.5}, {"levels": 4}], "frames": [0, 4, 8], "limit": 3,
    "inner": {"levels": 3}, "extra": {"free": [1, "two"]}})");
  EXPECT_FALSE(o.fast);
  EXPECT_EQ(o.seed, 18446744073709551615ull);
  EXPECT_EQ(o.gain, -2000);
  EXPECT_EQ(o.name, "x");
  EXPECT_EQ(o.kind, lab::Kind::square);
  EXPECT_EQ(o.centre, core::vec2(1, 2.5f));
  EXPECT_EQ(o.pair, (std::array{2, 0}));
  ASSERT_EQ(o.layers.size(), 2u);
  EXPECT_EQ(o.layers[0].share, 0.5f);
  EXPECT_EQ(o.layers[0].levels, 2);
  EXPECT_EQ(o.layers[1].levels, 4);
  EXPECT_EQ(o.frames, (std::vector{0, 4, 8}));
  EXPECT_EQ(o.limit, 3.0f);
  EXPECT_EQ(o.inner.levels, 3);
  EXPECT_EQ(o.inner.share, 0.95f);
  EXPECT_EQ(o.extra["free"][1], "two");
}

TEST(Settings, WritingAndReadingGivesTheSame) {
  lab::Outer o;
  o.layers = {{0.1f, 5}, {1, 1}};
  o.limit = 0.3f;
  o.name = "\u00e9 \"quoted\"";
  lab::Outer back;
  fromJson(parseJson(toJson(o).dump(2), "test.json"), back);
  EXPECT_EQ(toJson(back), toJson(o));
  EXPECT_EQ(back.layers[0].share, 0.1f);
  EXPECT_EQ(toJson(o)["inner"]["share"].dump(), "0.95");  // not 0.949999988079071
  EXPECT_TRUE(toJson(lab::Outer{})["limit"].is_null());
  EXPECT_FALSE(read(R"({"limit": null})").limit.has_value());
}

TEST(Settings, UnknownKeysAreErrorsThatListTheKnownOnes) {
  EXPECT_TRUE(says(failure(R"({"inner": {"decay": 1}})"), {"config.inner.decay:", "not a known key", "share, levels"}));
  EXPECT_TRUE(says(failure(R"({"layers": [{}, {"leels": 1}]})"), {"config.layers[1].leels:", "share, levels"}));
}

TEST(Settings, NumbersOutOfRangeAreErrorsWithTheKeysPath) {
  EXPECT_TRUE(says(failure(R"({"inner": {"share": -1}})"), {"config.inner.share: -1 is outside [0, 1];"}));
  EXPECT_TRUE(says(failure(R"({"inner": {"levels": 6}})"), {"config.inner.levels: 6 is outside [1, 5];"}));
  EXPECT_TRUE(says(failure(R"({"frames": [1, 2000]})"), {"config.frames[1]: 2000 is outside [0, 1000];"}));
  EXPECT_TRUE(says(failure(R"({"centre": [0, 11]})"), {"config.centre[1]: 11 is outside [-10, 10];"}));
  EXPECT_TRUE(says(failure(R"({"seed": -1})"), {"config.seed: -1 is outside [0, "}));
  EXPECT_TRUE(says(failure(R"({"seed": 18446744073709551616})"), {"config.seed:"}));
  EXPECT_TRUE(says(failure(R"({"inner": {"levels": 99999999999}})"), {"config.inner.levels:"}));
}

TEST(Settings, NumbersThatAreNotFiniteAreErrors) {
  EXPECT_TRUE(says(failure(R"({"gain": 1e999})"), {"test.json"}));
  EXPECT_TRUE(says(failure(R"({"gain": NaN})"), {"test.json", "line 1"}));
  EXPECT_TRUE(says(failure(R"({"inner": {"share": 1e300}})"), {"config.inner.share"}));
  EXPECT_TRUE(says(failure(R"({"gain": null})"), {"config.gain", "give a number"}));
}

TEST(Settings, WrongTypesAreErrors) {
  EXPECT_TRUE(says(failure(R"({"fast": 1})"), {"config.fast: 1 has the wrong type; give true or false"}));
  EXPECT_TRUE(says(failure(R"({"name": 3})"), {"config.name:", "give a string"}));
  EXPECT_TRUE(says(failure(R"({"gain": "big"})"), {"config.gain:", "give a number"}));
  EXPECT_TRUE(says(failure(R"({"inner": {"levels": 2.5}})"), {"config.inner.levels:", "whole number"}));
  EXPECT_TRUE(says(failure(R"({"inner": [1]})"), {"config.inner:", "give an object"}));
  EXPECT_TRUE(says(failure(R"({"centre": [1]})"), {"config.centre:", "list of 2"}));
  EXPECT_TRUE(says(failure(R"({"frames": 3})"), {"config.frames:", "give a list"}));
  EXPECT_TRUE(says(failure("[1]"), {"config:", "give an object"}));
  EXPECT_EQ(read(R"({"inner": {"levels": 3.0}})").inner.levels, 3);  // a whole number all the same
}

TEST(Settings, UnknownChoicesAreErrorsThatListAll) {
  EXPECT_TRUE(says(failure(R"({"kind": "oval"})"), {"config.kind:", "\"oval\"", "one of round, square"}));
  EXPECT_TRUE(says(failure(R"({"kind": 1})"), {"config.kind:", "one of round, square"}));
}

TEST(Settings, MalformedTextNamesTheLine) {
  EXPECT_TRUE(says(failure("{\n\"fast\": true,\n}"), {"test.json", "line 3"}));
  EXPECT_TRUE(says(failure("{\n// no comments\n}"), {"test.json", "line 2"}));
  EXPECT_TRUE(says(failure(""), {"test.json", "line 1"}));
  EXPECT_TRUE(says(failure("{} {}"), {"test.json", "line 1"}));
}

TEST(Settings, DuplicateKeysNameTheLine) {
  EXPECT_TRUE(says(failure("{\n\"gain\": 1,\n\"inner\": {},\n\"gain\": 2}"), {"line 4", "\"gain\" appears twice"}));
  EXPECT_TRUE(says(failure("{\"inner\": {\"levels\": 1,\n \"levels\": 2}}"), {"line 2", "\"levels\""}));
  EXPECT_EQ(failure(R"({"layers": [{"levels": 1}, {"levels": 2}], "inner": {"levels": 3}})"), "");  // other objects
}

TEST(Settings, AssignmentsSetNestedValues) {
  Json config = parseJson(R"({"inner": {"levels": 1}, "layers": [{}, {}]})", "test.json");
  applyAssignments(config, {"inner.share=0.5", "name=market 2", "layers.1.levels=3", "limit=null", "gain=2",
                            "kind=square", "frames=[1, 2]", "extra.deep.er=true"});
  lab::Outer o;
  fromJson(config, o);
  EXPECT_EQ(o.inner.share, 0.5f);
  EXPECT_EQ(o.inner.levels, 1);
  EXPECT_EQ(o.name, "market 2");
  EXPECT_EQ(o.layers.at(1).levels, 3);
  EXPECT_EQ(o.kind, lab::Kind::square);
  EXPECT_EQ(o.frames.size(), 2u);
  EXPECT_EQ(o.extra["deep"]["er"], true);
}

TEST(Settings, AssignmentsThatNameNothingAreErrors) {
  Json config = parseJson(R"({"gain": 1, "layers": [{}]})", "test.json");
  for (const char* wrong : {"gain", "=1", "gain.x=1", "layers.1.levels=1", "layers.x=1", "inner..levels=1", ""})
    EXPECT_THROW(applyAssignment(config, wrong), core::UsageError) << wrong;
  applyAssignment(config, "inner.nothing=1");  // found when the settings are read
  lab::Outer o;
  EXPECT_THROW(fromJson(config, o), core::UsageError);
}

TEST(Settings, BytesThatAreNoUtf8GiveALine) {
  Json config = Json::object();
  applyAssignment(config, "gain=\xff\xfe");
  lab::Outer o;
  EXPECT_THROW(fromJson(config, o), core::UsageError);
}

TEST(Settings, KeysAreListedWithDefaultsAndLimits) {
  const std::string text = listKeys(lab::Outer{});
  for (const char* part : {"inner.share = 0.95", "[0, 1]", "kind = round", "round|square", "seed = 7", "kept a frame",
                           "layers = 1 of them", "layers[].share = 0.95"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(Settings, MissingFilesAreWrongUsage) { EXPECT_THROW(readJson("/nonexistent.json"), core::UsageError); }

}  // namespace
}  // namespace experiments
