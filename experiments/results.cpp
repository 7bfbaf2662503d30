#include "experiments/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "core/files.h"
#include "core/statistics.h"
#include "experiments/json_text.h"
#include "experiments/names.h"
#include "experiments/summary.h"

namespace experiments {

namespace {

Json rowJson(const Row& r) {
  return {{"scene", r.scene},   {"variant", r.variant}, {"seed", r.seed},
          {"region", r.region}, {"metric", r.metric},   {"value", numberOrNull(r.value)}};
}

Json passJson(const PassTime& p) {
  return {{"scene", p.scene}, {"variant", p.variant}, {"pass", p.pass}, {"ms", numberOrNull(p.ms)}};
}

Json provenanceJson(const Provenance& p) {
  return {{"program", "twofold"}, {"version", p.version}, {"commit", p.commit},   {"compiler", p.compiler},
          {"build", p.build},     {"cpus", p.cpus},       {"threads", p.threads}, {"date", p.date}};
}

bool sameSequence(const FrameValue& a, const FrameValue& b) {
  return std::tie(a.scene, a.variant, a.seed, a.region, a.metric) ==
         std::tie(b.scene, b.variant, b.seed, b.region, b.metric);
}

/// Frames of one sequence, which stand together, as two parallel lists.
Json seriesJson(const std::vector<FrameValue>& series) {
  Json list = Json::array();
  for (std::size_t i = 0; i < series.size(); ++i) {
    const FrameValue& f = series[i];
    if (i == 0 || !sameSequence(series[i - 1], f))
      list.push_back({{"scene", f.scene},
                      {"variant", f.variant},
                      {"seed", f.seed},
                      {"region", f.region},
                      {"metric", f.metric},
                      {"frames", Json::array()},
                      {"values", Json::array()}});
    list.back()["frames"].push_back(f.frame);
    list.back()["values"].push_back(numberOrNull(f.value));
  }
  return list;
}

template <class T, class ToJson>
Json listJson(const std::vector<T>& values, ToJson&& convert) {
  Json list = Json::array();
  for (const T& value : values) list.push_back(convert(value));
  return list;
}

double numberOf(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Row rowOf(const Json& j) {
  return {j.at("scene"), j.at("variant"), j.at("seed"), j.at("region"), j.at("metric"), numberOf(j.at("value"))};
}

void appendSeries(const Json& j, std::vector<FrameValue>& series) {
  const Json &frames = j.at("frames"), &values = j.at("values");
  for (std::size_t i = 0; i < frames.size(); ++i)
    series.push_back({j.at("scene"), j.at("variant"), j.at("seed"), j.at("region"), j.at("metric"),
                      frames.at(i).get<int>(), numberOf(values.at(i))});
}

Provenance provenanceOf(const Json& j) {
  return {j.at("version"), j.at("commit"),  j.at("compiler"), j.at("build"),
          j.at("cpus"),    j.at("threads"), j.at("date")};
}

Results readParts(const Json& json) {
  Results r;
  for (const Json& j : json.at("rows")) r.rows.push_back(rowOf(j));
  for (const Json& j : json.at("series")) appendSeries(j, r.series);
  for (const Json& j : json.at("passes"))
    r.passes.push_back({j.at("scene"), j.at("variant"), j.at("pass"), numberOf(j.at("ms"))});
  r.config = json.at("config");
  r.provenance = provenanceOf(json.at("provenance"));
  r.baseline = json.at("baseline").get<std::string>();
  return r;
}

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::vector<Row> meansOverFrames(const std::vector<FrameValue>& series) {
  struct Sum {
    Row row;
    int count = 0;
  };
  std::vector<Sum> sums;
  std::map<std::tuple<std::string, std::string, std::uint64_t, std::string, std::string>, std::size_t> index;
  for (const FrameValue& f : series) {
    const auto [at, isNew] = index.try_emplace({f.scene, f.variant, f.seed, f.region, f.metric}, sums.size());
    if (isNew) sums.push_back({{f.scene, f.variant, f.seed, f.region, f.metric, 0}});
    if (!std::isfinite(f.value)) continue;
    sums[at->second].row.value += f.value;
    ++sums[at->second].count;
  }
  std::vector<Row> rows;
  for (Sum& sum : sums) {
    sum.row.value = sum.count ? sum.row.value / sum.count : std::numeric_limits<double>::quiet_NaN();
    rows.push_back(std::move(sum.row));
  }
  return rows;
}

std::vector<PassTime> medianPasses(const std::vector<PassTime>& passes) {
  std::vector<PassTime> merged;
  std::vector<std::vector<double>> times;
  std::map<std::tuple<std::string, std::string, std::string>, std::size_t> index;
  for (const PassTime& p : passes) {
    const auto [at, isNew] = index.try_emplace({p.scene, p.variant, p.pass}, merged.size());
    if (isNew) merged.push_back(p), times.emplace_back();
    times[at->second].push_back(p.ms);
  }
  for (std::size_t i = 0; i < merged.size(); ++i) merged[i].ms = core::median(times[i]);
  return merged;
}

void sortCanonically(Results& results) {
  Names scenes, variants, regions, metrics;
  for (const Row& r : results.rows)
    scenes.add(r.scene), variants.add(r.variant), regions.add(r.region), metrics.add(r.metric);
  for (const FrameValue& f : results.series)
    scenes.add(f.scene), variants.add(f.variant), regions.add(f.region), metrics.add(f.metric);
  const auto key = [&](const auto& r, int frame) {
    return std::tuple(scenes[r.scene], variants[r.variant], r.seed, regions[r.region], metrics[r.metric], frame);
  };
  std::stable_sort(results.rows.begin(), results.rows.end(),
                   [&](const Row& a, const Row& b) { return key(a, 0) < key(b, 0); });
  std::stable_sort(results.series.begin(), results.series.end(),
                   [&](const FrameValue& a, const FrameValue& b) { return key(a, a.frame) < key(b, b.frame); });
}

Json resultsJson(const Results& results) {
  Results sorted = results;
  sortCanonically(sorted);
  Json json;
  json["provenance"] = provenanceJson(sorted.provenance);
  json["config"] = sorted.config;
  json["baseline"] = sorted.baseline;
  json["summary"] = listJson(summarise(sorted.rows), summaryJson);
  json["ratios"] = listJson(ratiosTo(sorted.rows, sorted.baseline), ratioJson);
  json["passes"] = listJson(sorted.passes, passJson);
  json["rows"] = listJson(sorted.rows, rowJson);
  json["series"] = seriesJson(sorted.series);
  return json;
}

Results resultsFromJson(const Json& json, const std::string& where) {
  try {
    return readParts(json);
  } catch (const Json::exception& e) {
    throw core::Error(where, std::string("does not hold results of this program: ") + e.what(),
                      "delete it, or choose another output folder");
  }
}

void saveResults(const Results& results, const std::filesystem::path& folder) {
  core::writeFileAtomically(folder / "results.json", listedText(resultsJson(results)));
  core::writeFileAtomically(folder / "results.csv", resultsCsv(results));
}

Results loadResults(const std::filesystem::path& file) {
  return resultsFromJson(parseJson(core::readFile(file), file.string()), file.string());
}

std::string resultsCsv(const Results& results) {
  Results sorted = results;
  sortCanonically(sorted);
  std::string text = "scene,variant,seed,region,metric,value\n";
  for (const Row& r : sorted.rows) {
    const std::string value = std::isfinite(r.value) ? fmt::format("{:.17g}", r.value) : "";
    text += fmt::format("{},{},{},{},{},{}\n", csvField(r.scene), csvField(r.variant), r.seed, csvField(r.region),
                        csvField(r.metric), value);
  }
  return text;
}

}  // namespace experiments
