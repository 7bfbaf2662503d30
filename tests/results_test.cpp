// Results: rows, summaries over seeds, paired ratios, files in a fixed order that can be read back.
#include "experiments/results.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "core/files.h"
#include "experiments/json_text.h"
#include "experiments/summary.h"

namespace experiments {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("twofold-results-" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Results example() {
  Results r;
  for (const std::uint64_t seed : {1, 2, 3})
    for (const char* variant : {"unweighted", "lag"}) {
      const double error = static_cast<double>(seed) * (variant[0] == 'l' ? 0.5 : 1.0);
      r.rows.push_back({"market", variant, seed, "full", "relMSE", error});
      r.rows.push_back({"market", variant, seed, "fovea", "relMSE", 0.1 * error});
      for (const int frame : {0, 4})
        r.series.push_back({"market", variant, seed, "full", "relMSE", frame, error + frame});
    }
  r.rows.push_back({"market", "lag", 3, "recently_foveal", "relMSE", std::nan("")});
  r.passes.push_back({"market", "lag", "blend", 1.25});
  r.config = {{"frames", 8}, {"name", "test"}};
  r.provenance = currentProvenance();
  return r;
}

Summary find(const std::vector<Summary>& all, const std::string& variant, const std::string& region) {
  return *std::find_if(all.begin(), all.end(),
                       [&](const Summary& s) { return s.variant == variant && s.region == region; });
}

TEST(Results, SummariesHoldStudentsInterval) {
  const Summary s = find(summarise(example().rows), "unweighted", "full");
  EXPECT_DOUBLE_EQ(s.value.mean, 2);
  // Three values 1, 2, 3: standard error 1 / sqrt(3), t = 4.30265 at two degrees of freedom (published table).
  EXPECT_NEAR(s.value.high - 2, 4.30265 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(2 - s.value.low, 4.30265 / std::sqrt(3.0), 1e-4);
}

TEST(Results, RatiosArePairedBySeed) {
  // The errors vary threefold between seeds, yet every seed's ratio is 0.5: the interval has no width.
  const std::vector<Ratio> ratios = ratiosTo(example().rows, "unweighted");
  ASSERT_EQ(ratios.size(), 2u);
  EXPECT_EQ(ratios[0].variant, "lag");
  EXPECT_NEAR(ratios[0].value.mean, 0.5, 1e-12);
  EXPECT_NEAR(ratios[0].value.low, 0.5, 1e-9);
  EXPECT_NEAR(ratios[0].value.high, 0.5, 1e-9);
  std::vector<Row> unpaired = example().rows;
  for (Row& r : unpaired)
    if (r.variant == "lag") r.seed = 4 - r.seed;  // seeds exchanged: the pairing is lost
  EXPECT_GT(ratiosTo(unpaired, "unweighted")[0].value.high, 1);
}

TEST(Results, RatiosOfValuesThatAreNotPositiveAreUnknown) {
  const std::vector<Row> rows{{"s", "a", 1, "full", "relMSE", -1e-3}, {"s", "b", 1, "full", "relMSE", 1}};
  EXPECT_TRUE(std::isnan(ratiosTo(rows, "b").at(0).value.mean));
  EXPECT_TRUE(ratiosTo(rows, "absent").empty());
}

TEST(Results, ASingleSeedHasNoInterval) {
  Results r;
  r.rows.push_back({"s", "a", 1, "full", "relMSE", 0.25});
  const Json json = resultsJson(r);
  EXPECT_EQ(json["summary"][0]["mean"], 0.25);
  EXPECT_TRUE(json["summary"][0]["low"].is_null());
  EXPECT_TRUE(json["summary"][0]["high"].is_null());
}

TEST(Results, MeansOverFramesLeaveOutFramesWithoutValue) {
  const std::vector<FrameValue> series{{"s", "a", 1, "fovea", "relMSE", 0, 2},
                                       {"s", "a", 1, "fovea", "relMSE", 4, std::nan("")},
                                       {"s", "a", 1, "fovea", "relMSE", 8, 4},
                                       {"s", "a", 2, "fovea", "relMSE", 0, std::nan("")}};
  const std::vector<Row> rows = meansOverFrames(series);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].value, 3);
  EXPECT_TRUE(std::isnan(rows[1].value));
}

TEST(Results, FilesCanBeReadBack) {
  const Folder folder;
  const Results results = example();
  saveResults(results, folder.path());
  const Results back = loadResults(folder.path() / "results.json");
  EXPECT_EQ(resultsJson(back), resultsJson(results));
  EXPECT_EQ(back.rows.size(), results.rows.size());
  EXPECT_EQ(back.series.size(), results.series.size());
  EXPECT_TRUE(std::isnan(back.rows.back().value));
  EXPECT_EQ(back.provenance.compiler, results.provenance.compiler);
  for (const auto& entry : fs::directory_iterator(folder.path()))  // no temporary file is left
    EXPECT_TRUE(entry.path().filename() == "results.json" || entry.path().filename() == "results.csv");
}

TEST(Results, JsonHasTheAgreedParts) {
  const Json json = resultsJson(example());
  for (const char* part : {"rows", "summary", "ratios", "passes", "series", "config", "provenance"})
    EXPECT_TRUE(json.contains(part)) << part;
  EXPECT_EQ(json["rows"][0].dump(),
            R"({"scene":"market","variant":"unweighted","seed":1,"region":"full","metric":"relMSE","value":1.0})");
  EXPECT_EQ(json["passes"][0]["ms"], 1.25);
  for (const char* key : {"version", "commit", "compiler", "cpus", "date"})
    EXPECT_TRUE(json["provenance"].contains(key)) << key;
}

TEST(Results, OrderDoesNotDependOnWhichSeedEndedFirst) {
  const Results a = example();
  Results b = a;
  std::stable_sort(b.rows.begin(), b.rows.end(), [](const Row& x, const Row& y) {
    return std::pair(x.region == "recently_foveal", x.seed) < std::pair(y.region == "recently_foveal", y.seed);
  });
  for (const auto keyOf : {+[](const Row& r) { return r.seed; }, +[](const Row& r) { return (r.seed + 1) % 3; }}) {
    std::stable_sort(b.rows.begin(), b.rows.end() - 1, [&](const Row& x, const Row& y) { return keyOf(x) > keyOf(y); });
    std::stable_sort(b.series.begin(), b.series.end(),
                     [](const FrameValue& x, const FrameValue& y) { return x.seed > y.seed; });
    EXPECT_EQ(resultsJson(b), resultsJson(a));
    EXPECT_EQ(resultsCsv(b), resultsCsv(a));
  }
}

TEST(Results, CsvQuotesWhatNeedsIt) {
  Results r;
  r.rows.push_back({"a,b", "say \"x\"", 1, "full", "relMSE", 0.1});
  r.rows.push_back({"a,b", "y", 1, "full", "relMSE", std::nan("")});
  EXPECT_EQ(resultsCsv(r),
            "scene,variant,seed,region,metric,value\n\"a,b\",\"say \"\"x\"\"\",1,full,relMSE,0.10000000000000001\n"
            "\"a,b\",y,1,full,relMSE,\n");
}

TEST(Results, ForeignFilesAreRefused) {
  EXPECT_THROW(resultsFromJson(Json::parse(R"({"rows": []})"), "x.json"), core::Error);
  EXPECT_THROW(resultsFromJson(Json::parse(R"([1, 2])"), "x.json"), core::Error);
  Json json = resultsJson(example());
  json["rows"][0]["value"] = "large";
  EXPECT_THROW(resultsFromJson(json, "x.json"), core::Error);
  EXPECT_THROW(loadResults("/nonexistent/results.json"), core::Error);
}

TEST(Results, AFolderThatDoesNotExistIsAnError) {
  EXPECT_THROW(saveResults(example(), "/nonexistent/folder"), core::Error);
}

TEST(Results, TheTerminalTableIsAligned) {
  const std::string table = summaryTable(example(), "market", "relMSE");
  EXPECT_NE(table.find("(0.500)"), std::string::npos) << table;
  std::vector<std::size_t> widths;
  for (std::size_t begin = 0; begin < table.size();) {
    const std::size_t end = table.find('\n', begin);
    widths.push_back(end - begin);
    begin = end + 1;
  }
  ASSERT_EQ(widths.size(), 3u) << table;
  EXPECT_EQ(widths[0], widths[1]);
  EXPECT_EQ(widths[1], widths[2]);
}

TEST(JsonText, ListsStandOneElementALineAndReadBack) {
  const Json json = Json::parse(R"({"list": [{"a": [1, 2]}, 3], "empty": [], "nested": {"b": [1, 2]}, "x": null})");
  const std::string text = listedText(json);
  EXPECT_EQ(Json::parse(text), json);
  EXPECT_NE(text.find("\n  {\"a\":[1,2]},\n  3\n]"), std::string::npos) << text;
}

}  // namespace
}  // namespace experiments
