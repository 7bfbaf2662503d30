// Efficiency: time to equal error on curves that are known, wrong configurations, and a whole run on small frames.
#include "experiments/efficiency/efficiency.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "core/check.h"
#include "core/files.h"
#include "experiments/efficiency/analysis.h"
#include "experiments/efficiency/measure.h"
#include "experiments/efficiency/overview.h"
#include "experiments/plot.h"
#include "experiments/scenes/builtin.h"

namespace experiments::efficiency {
namespace {

namespace fs = std::filesystem;

const std::vector<int> kCounts{1, 2, 4, 8};

/// Error c n^power at time a + b n.
std::vector<CurvePoint> curve(double c, double power, double a, double b, const std::vector<int>& counts = kCounts) {
  std::vector<CurvePoint> points;
  for (const int n : counts) points.push_back({double(n), a + b * n, c * std::pow(n, power)});
  return points;
}

TEST(EqualError, IsExactOnPowerLaws) {
  for (const double power : {-0.5, -1.0, -1.7})
    for (const double error : {0.9, 0.5, 0.4}) {
      const EqualTime t = timeToError(curve(1, power, 0, 3), error, false);  // error = (t / 3)^power
      EXPECT_NEAR(t.milliseconds, 3 * std::pow(error, 1 / power), 1e-9) << power << " " << error;
      EXPECT_EQ(t.reach, Reach::measured);
    }
  EXPECT_NEAR(slopeInCount(curve(5, -0.7, 1, 1)), -0.7, 1e-12);
}

TEST(EqualError, GoesOnByTheLawOfIndependentSamplesAndSaysSo) {
  const EqualTime t = timeToError(curve(1, -1, 5, 3), 0.01, true);  // n = 100
  EXPECT_NEAR(t.milliseconds, 305, 1e-9);
  EXPECT_EQ(t.reach, Reach::extrapolated);
  const EqualTime single = timeToError(curve(1, -1, 0, 3, {2}), 0.1, true);
  EXPECT_NEAR(single.milliseconds, 30, 1e-9);
}

TEST(EqualError, OutsideTheCurveIsABound) {
  const EqualTime late = timeToError(curve(1, -1, 5, 3), 0.01, false);
  EXPECT_EQ(late.reach, Reach::atLeast);
  EXPECT_DOUBLE_EQ(late.milliseconds, 29);
  const EqualTime early = timeToError(curve(1, -1, 5, 3), 2, true);
  EXPECT_EQ(early.reach, Reach::atMost);
  EXPECT_DOUBLE_EQ(early.milliseconds, 8);
  EXPECT_EQ(timeToError(curve(1, -1, 5, 3), 1, true).reach, Reach::measured);  // the first point itself
  EXPECT_TRUE(std::isnan(timeToError({}, 1, true).milliseconds));
  EXPECT_TRUE(std::isnan(timeToError(curve(1, -1, 5, 3), -1, true).milliseconds));
}

TEST(EqualError, OfCurvesThatAreNotMonotoneIsTheLeastTime) {
  const std::vector<CurvePoint> bumpy{{1, 1, 1}, {2, 2, 0.25}, {4, 4, 0.5}, {8, 8, 0.125}};
  EXPECT_NEAR(timeToError(bumpy, 0.5, true).milliseconds, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(timeToError(bumpy, 0.125, true).milliseconds, 8, 1e-12);
  const std::vector<CurvePoint> faster{{1, 4, 1}, {2, 2, 0.1}};  // time that falls, as noise can make it
  EXPECT_DOUBLE_EQ(timeToError(faster, 0.1, true).milliseconds, 2);
  const std::vector<CurvePoint> withNoise{{1, 1, 1}, {2, 2, -0.1}, {4, 4, 0.25}};
  EXPECT_NEAR(timeToError(withNoise, 0.5, true).milliseconds, 2, 1e-12);  // the negative error is left out
}

TEST(EqualError, CrossingIsInterpolatedInLogarithms) {
  EXPECT_NEAR(riseAboveOne({{10, 0.1}, {1000, 10}}), 100, 1e-9);
  EXPECT_NEAR(riseAboveOne({{1, 2}, {10, 0.1}, {1000, 10}}), 100, 1e-9);
  EXPECT_TRUE(std::isnan(riseAboveOne({{10, 2}, {1000, 3}})));
  EXPECT_TRUE(std::isnan(riseAboveOne({{10, 0.2}, {1000, 0.3}})));
  EXPECT_TRUE(std::isnan(riseAboveOne({{10, 2}, {1000, 0.3}})));
  EXPECT_TRUE(std::isnan(riseAboveOne({})));
}

/// A configuration of two baselines and two methods with reuse.
EfficiencyConfig example(std::vector<std::string> scenes = {"lamps-10", "lamps-1000"}) {
  EfficiencyConfig config;
  config.scenes = std::move(scenes);
  config.counts = kCounts;
  config.methods = {{{"name", "slow"}, {"restir", {{"reuse", "none"}}}},
                    {{"name", "ris"}, {"restir", {{"reuse", "none"}}}},
                    {{"name", "balance"}},
                    {{"like", "balance"}, {"name", "again"}}};
  return config;
}

/// Rows of a curve in one scene; error and time vary by seed alike for all methods.
void addRows(std::vector<Row>& rows, const std::string& scene, const std::string& method,
             const std::vector<CurvePoint>& points, double timeFactor = 1) {
  for (const std::uint64_t seed : {1, 2, 3})
    for (const CurvePoint& p : points) {
      const std::string label = labelOf(method, static_cast<int>(p.count));
      const double wobble = 1 + 0.1 * static_cast<double>(seed);
      rows.push_back({scene, label, seed, "full", kTime, timeFactor * p.milliseconds * wobble});
      for (const char* metric : kErrors) rows.push_back({scene, label, seed, "full", metric, p.error * wobble});
    }
}

std::vector<Row> exampleRows(double timeOfRis = 1, double timeOfAgain = 1) {
  std::vector<Row> rows;
  for (const double gain : {0.5, 8.0}) {  // errors at equal time, without reuse over with it
    const std::string scene = gain < 1 ? "lamps-10" : "lamps-1000";
    addRows(rows, scene, "slow", curve(3 * gain, -1, 0, 1));
    addRows(rows, scene, "ris", curve(gain, -1, 0, 1), timeOfRis);
    addRows(rows, scene, "balance", curve(0.5, -1, 0, 1));
    addRows(rows, scene, "again", curve(0.5, -1, 0, 1), timeOfAgain);
  }
  return rows;
}

const EqualError& find(const Findings& f, const std::string& scene, const std::string& method) {
  for (const EqualError& e : f.equal)
    if (e.scene == scene && e.method == method && e.metric == "relMSE") return e;
  throw std::out_of_range(method);
}

TEST(Efficiency, FindsRatiosOfKnownCurves) {
  const Findings f = analyse(example(), 1, exampleRows());
  EXPECT_EQ(f.target, "balance n=1");
  const EqualError& ris = find(f, "lamps-1000", "ris");
  EXPECT_NEAR(ris.ratio.mean, 16, 1e-9);  // error 0.5 at n = 16
  EXPECT_NEAR(ris.ratio.low, 16, 1e-9);   // paired: what varies by seed for all alike cancels
  EXPECT_EQ(ris.reach, Reach::extrapolated);
  EXPECT_NEAR(ris.slope, -1, 1e-12);
  EXPECT_TRUE(ris.best && ris.baseline);
  EXPECT_FALSE(find(f, "lamps-1000", "slow").best);
  EXPECT_NEAR(find(f, "lamps-1000", "slow").ratio.mean, 48, 1e-9);
  EXPECT_FALSE(find(f, "lamps-1000", "again").baseline);
  EXPECT_NEAR(find(analyse(example(), 4, exampleRows()), "lamps-1000", "ris").ratio.mean, 16, 1e-9);
}

TEST(Efficiency, AMethodAgainstItselfIsOne) {
  const Findings f = analyse(example(), 1, exampleRows());
  for (const char* method : {"balance", "again"}) {
    const EqualError& e = find(f, "lamps-10", method);
    EXPECT_NEAR(e.ratio.mean, 1, 1e-12);
    EXPECT_EQ(e.reach, Reach::measured);
  }
}

TEST(Efficiency, TwiceTheTimeIsTwiceTheRatio) {
  for (const char* scene : {"lamps-10", "lamps-1000"}) {
    const double once = find(analyse(example(), 1, exampleRows()), scene, "ris").ratio.mean;
    EXPECT_NEAR(find(analyse(example(), 1, exampleRows(2)), scene, "ris").ratio.mean, 2 * once, 1e-9);
  }
  EXPECT_NEAR(find(analyse(example(), 1, exampleRows(1, 2)), "lamps-10", "again").ratio.mean, 2, 1e-9);
}

TEST(Efficiency, SaysFromHowManyLightsItPays) {
  const Findings f = analyse(example(), 1, exampleRows());
  ASSERT_EQ(f.byLights.size(), 2u);
  EXPECT_EQ(f.byLights[0].best.front().second.reach, Reach::measured);
  EXPECT_TRUE(std::isnan(f.byLights[0].pays));  // at 10 lights the ratio is 1: it pays everywhere
  EXPECT_NE(verdict(f.byLights[0], f.target).find("at every number"), std::string::npos);
  const Findings slower = analyse(example(), 1, exampleRows(0.25));  // ratios 1/4 and 4
  EXPECT_NEAR(slower.byLights[0].pays, 100, 1e-6);
  EXPECT_NE(verdict(slower.byLights[0], f.target).find("about 100 lights"), std::string::npos);
  EXPECT_TRUE(analyse(example({"lamps-10"}), 1, {}).byLights.empty());
}

TEST(Efficiency, ABaselineThatNeverGetsThereIsBestOnlyAlone) {
  EfficiencyConfig config = example();
  config.baselines = {"again", "ris"};
  std::vector<Row> rows;
  addRows(rows, "cornell", "ris", curve(4, -1, 0, 1));
  addRows(rows, "cornell", "balance", curve(0.1, -1, 0, 1));
  addRows(rows, "cornell", "again", curve(2, -1, 0, 1));  // reuses: no law says when it has 0.1
  const Findings f = analyse(config, 1, rows);
  EXPECT_EQ(find(f, "cornell", "again").reach, Reach::atLeast);
  EXPECT_TRUE(find(f, "cornell", "ris").best);
  config.baselines = {"again"};
  EXPECT_TRUE(find(analyse(config, 1, rows), "cornell", "again").best);
}

void expectRefused(const Json& json, const std::string& part) {
  try {
    efficiencyConfigFrom(json, {});
    ADD_FAILURE() << json.dump() << " was taken";
  } catch (const core::UsageError& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
}

TEST(EfficiencyConfig, RefusesWhatIsWrong) {
  expectRefused({{"nothing", 1}}, "config.nothing");
  expectRefused({{"methods", Json::array()}}, "config.methods");
  expectRefused({{"methods", {"ris"}}}, "config.methods[0]: it is not an object");
  expectRefused({{"methods", {Json::object()}}}, "config.methods[0].name");
  expectRefused({{"methods", {{{"name", "a"}, {"restir", {{"unknown", 1}}}}}}}, "config.methods[0].restir.unknown");
  expectRefused({{"methods", {{{"name", "a"}}, {{"name", "a"}}}}}, "config.methods[1]: the name 'a' is taken");
  expectRefused({{"methods", {{{"name", "a"}, {"like", "b"}}}}}, "config.methods[0].like");
  expectRefused({{"methods", {{{"name", "a"}, {"counts", Json::array()}}}}}, "config.methods[0].counts");
  expectRefused({{"methods", {{{"name", "a"}}}}}, "config.target");
  for (const Json& counts : {Json{0, 1}, Json{-1}, Json{1.5}, Json{5000}, Json{2, 1}, Json{1, 1}})
    expectRefused({{"counts", counts}}, "counts");
  expectRefused({{"targetCount", 3}}, "config.targetCount");
  expectRefused({{"baselines", {"nosuch"}}}, "config.baselines");
  expectRefused({{"seeds", {1, 1}}}, "config.seeds");
  expectRefused({{"scenes", Json::array()}}, "config.scenes");
  expectRefused({{"scenes", {"cornell", "cornell"}}}, "config.scenes");
  expectRefused({{"frames", 0}}, "config.frames");
}

TEST(EfficiencyConfig, MethodsStartFromOthers) {
  const EfficiencyConfig config = efficiencyConfigFrom(
      Json{{"restir", {{"candidates", {{"lightSamples", 7}}}}},
           {"methods",
            {{{"name", "a"}, {"restir", {{"reuse", "temporal"}}}, {"counts", {3}}}, {{"like", "a"}, {"name", "b"}}}},
           {"target", "b"}},
      {"methods.1.restir.mis=pairwise"});
  const std::vector<Method> methods = methodsOf(config);
  ASSERT_EQ(methods.size(), 2u);
  EXPECT_EQ(methods[1].restir.candidates.lightSamples, 7);
  EXPECT_EQ(methods[1].restir.reuse, restir::Reuse::temporal);
  EXPECT_EQ(methods[1].restir.mis, restir::Mis::pairwise);
  EXPECT_EQ(methods[0].restir.mis, restir::Mis::balance);
  EXPECT_EQ(methods[1].counts, std::vector<int>{3});
  EXPECT_EQ(toJson(efficiencyConfigFrom(toJson(config), {})), toJson(config));
}

TEST(EfficiencyConfig, DefaultsAreConsistent) {
  EXPECT_EQ(methodsOf(efficiencyConfigFrom(Json::object(), {})).size(), 6u);
}

/// Small frames of cornell: two methods at two counts.
EfficiencyConfig smallConfig(const fs::path& folder, int warmUp = 2) {
  return efficiencyConfigFrom(
      Json{{"scenes", {"cornell"}},
           {"warmUp", warmUp},
           {"frames", 2},
           {"width", 32},
           {"height", 18},
           {"seeds", {1, 2}},
           {"counts", {1, 2}},
           {"methods", {{{"name", "ris"}, {"restir", {{"reuse", "none"}}}}, {{"name", "balance"}}}},
           {"reference", {{"samples", 8}, {"every", 1}, {"cache", (folder / "cache").string()}}}},
      {});
}

class EfficiencyRun : public testing::Test {
 protected:
  EfficiencyRun() : folder_(fs::temp_directory_path() / ("twofold-efficiency-" + std::to_string(getpid()))) {}
  ~EfficiencyRun() override { fs::remove_all(folder_); }
  const fs::path folder_;
};

double valueOf(const std::vector<Row>& rows, const std::string& variant, const std::string& metric) {
  for (const Row& r : rows)
    if (r.variant == variant && r.metric == metric && r.seed == 1) return r.value;
  throw std::out_of_range(variant);
}

TEST_F(EfficiencyRun, WritesEveryMethodCountAndSeed) {
  const EfficiencyConfig config = smallConfig(folder_);
  const Results results = runEfficiency(config, folder_);
  EXPECT_EQ(results.rows.size(), 2u * 2 * 2 * 4);  // methods, counts, seeds, metrics
  for (const Row& r : results.rows) {
    EXPECT_TRUE(std::isfinite(r.value)) << r.variant << " " << r.metric;
    EXPECT_EQ(r.region, "full");
    if (r.metric == kTime) {
      EXPECT_GT(r.value, 0) << r.variant;
    }
  }
  EXPECT_GT(valueOf(results.rows, "ris n=1", "relMSE"), valueOf(results.rows, "ris n=2", "relMSE"));

  const Json json = parseJson(core::readFile(folder_ / "results.json"), "results.json");
  EXPECT_EQ(json.at("rows").size(), results.rows.size());
  EXPECT_EQ(json.at("points").size(), 2u * 2 * 2);   // methods, counts, errors
  EXPECT_EQ(json.at("equal_error").size(), 2u * 2);  // methods, errors
  EXPECT_EQ(json.at("by_lights").size(), 0u);        // cornell is none of lamps-N
  EXPECT_EQ(loadResults(folder_ / "results.json").rows.size(), results.rows.size());
  const std::string csv = core::readFile(folder_ / "results.csv"), html = core::readFile(folder_ / "report.html");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), std::ssize(results.rows) + 1);
  for (const char* part : {"time to the error of balance n=1", "<svg viewBox", "best baseline", "draw candidates"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  EXPECT_NE(overviewText(config, results).find("ris (best baseline)"), std::string::npos);
  for (const auto& file : fs::recursive_directory_iterator(folder_))
    EXPECT_EQ(file.path().string().find(".tmp"), std::string::npos) << file.path();
}

TEST_F(EfficiencyRun, ResumesWithoutMeasuringAgain) {
  const EfficiencyConfig config = smallConfig(folder_);
  const std::string first = resultsCsv(runEfficiency(config, folder_));
  EXPECT_EQ(resultsCsv(runEfficiency(config, folder_)), first);  // times too, which a second measurement would change
}

TEST_F(EfficiencyRun, ErrorsAreThoseOfTheExperimentAndNeedNoWarmUpWithoutReuse) {
  const EfficiencyConfig config = smallConfig(folder_, 3);
  Config experiment = experimentOf(config);
  experiment.variants = {"none"};
  experiment.shade.foveation.kind = core::FoveationKind::uniform;
  const core::Scene scene = cornellScene();
  const Stage stage(scene);
  References references(stage, experiment, "cornell");
  const std::vector<Row> rows = measure(stage, config, "cornell", 1, references, {}).rows;
  for (const Method& m : methodsOf(config))
    for (const int n : m.counts) {
      experiment.shade.restir = m.restir;
      experiment.shade.foveation.samples = static_cast<float>(n);
      double sum = 0;
      for (const FrameValue& f :
           runSequence(stage, experiment, variantsOf(experiment), "cornell", 1, references, {}).series)
        if (f.variant == "raw" && f.region == "full" && f.metric == "relMSE" && f.frame >= config.warmUp)
          sum += f.value;
      EXPECT_DOUBLE_EQ(valueOf(rows, labelOf(m.name, n), "relMSE"), sum / config.frames) << m.name << n;
    }
}

TEST(EfficiencyPlot, BothAxesCanBeLogarithmic) {
  LinePlot plot{"t", "x", "y", true, {{"a", 0, {0, 1, 10, 100}, {1, 1, 2, 4}, {}, {}}}};
  plot.logarithmicX = true;
  plot.lines[0].low = {1, 0.5, 0, 3}, plot.lines[0].high = {1, 2, 3, 5};
  const std::string svg = svgLinePlot(plot);
  const auto count = [&](const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = svg.find(part); at != std::string::npos; at = svg.find(part, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<circle"), 3u);  // 0 has no logarithm
  EXPECT_EQ(count("whisker"), 2u);  // nor has the interval that begins at 0
  for (const char* tick : {">1<", ">2<", ">5<", ">10<", ">20<", ">50<", ">100<"}) EXPECT_GE(count(tick), 1u) << tick;
  EXPECT_EQ(count("nan"), 0u);
  EXPECT_EQ(count("inf"), 0u);
}

}  // namespace
}  // namespace experiments::efficiency
