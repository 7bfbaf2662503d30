#include "experiments/efficiency/analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/maths.h"
#include "experiments/efficiency/measure.h"
#include "experiments/json_text.h"
#include "experiments/names.h"
#include "experiments/scenes/builtin.h"

namespace experiments::efficiency {
namespace {

/// Values of rows by scene, method at a count, seed and metric.
class Table {
 public:
  explicit Table(const std::vector<Row>& rows) {
    for (const Row& r : rows) {
      scenes_.add(r.scene), seeds_.insert(r.seed);
      values_[{r.scene, r.variant, r.seed, r.metric}] = r.value;
    }
  }
  const std::vector<std::string>& scenes() const { return scenes_.inOrder(); }
  const std::set<std::uint64_t>& seeds() const { return seeds_; }
  double at(const std::string& scene, const std::string& label, std::uint64_t seed, const std::string& metric) const {
    const auto found = values_.find({scene, label, seed, metric});
    return found == values_.end() ? core::kNaN : found->second;
  }
  CurvePoint point(const std::string& scene, const Method& m, int count, std::uint64_t seed,
                   const std::string& metric) const {
    const std::string label = labelOf(m.name, count);
    return {static_cast<double>(count), at(scene, label, seed, kTime), at(scene, label, seed, metric)};
  }
  std::vector<CurvePoint> curve(const std::string& scene, const Method& m, std::uint64_t seed,
                                const std::string& metric) const {
    std::vector<CurvePoint> points;
    for (const int n : m.counts) points.push_back(point(scene, m, n, seed, metric));
    return points;
  }

 private:
  Names scenes_;
  std::set<std::uint64_t> seeds_;
  std::map<std::tuple<std::string, std::string, std::uint64_t, std::string>, double> values_;
};

/// All methods of one scene and metric at the error of the target.
class SceneAnalysis {
 public:
  SceneAnalysis(const Table& table, const std::vector<Method>& methods, const std::string& target, int targetCount,
                std::string scene, std::string metric)
      : table_(table),
        methods_(methods),
        target_(*std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == target; })),
        targetCount_(targetCount),
        scene_(std::move(scene)),
        metric_(std::move(metric)) {}

  std::vector<Point> points() const {
    std::vector<Point> all;
    for (const Method& m : methods_)
      for (const int n : m.counts) {
        std::vector<double> times, errors;
        for (const std::uint64_t seed : table_.seeds()) {
          const CurvePoint p = table_.point(scene_, m, n, seed, metric_);
          times.push_back(p.milliseconds), errors.push_back(p.error);
        }
        all.push_back({scene_, m.name, n, metric_, core::geometricInterval(times), core::geometricInterval(errors)});
      }
    return all;
  }

  std::vector<EqualError> equal(const std::vector<std::string>& baselines) const {
    std::vector<EqualError> all;
    for (const Method& m : methods_) {
      all.push_back(equalOf(m));
      all.back().baseline = std::find(baselines.begin(), baselines.end(), m.name) != baselines.end();
    }
    EqualError* best = nullptr;
    for (EqualError& e : all)
      if (e.baseline && std::isfinite(e.ratio.mean) && (!best || better(e, *best))) best = &e;
    if (best) best->best = true;
    return all;
  }

 private:
  static bool better(const EqualError& a, const EqualError& b) {
    const bool reachesA = a.reach != Reach::atLeast, reachesB = b.reach != Reach::atLeast;
    return reachesA != reachesB ? reachesA : a.ratio.mean < b.ratio.mean;
  }

  EqualError equalOf(const Method& m) const {
    EqualError e{scene_, metric_, m.name, {}, {}, Reach::measured, meanSlope(m), false, false};
    std::vector<double> times, ratios;
    for (const std::uint64_t seed : table_.seeds()) {
      const CurvePoint aim = table_.point(scene_, target_, targetCount_, seed, metric_);
      const EqualTime t = &m == &target_
                              ? EqualTime{aim.milliseconds, Reach::measured}
                              : timeToError(table_.curve(scene_, m, seed, metric_), aim.error, m.independent());
      times.push_back(t.milliseconds), ratios.push_back(t.milliseconds / aim.milliseconds);
      e.reach = std::max(e.reach, t.reach);
    }
    e.milliseconds = core::geometricInterval(times);
    e.ratio = core::geometricInterval(ratios);
    return e;
  }

  double meanSlope(const Method& m) const {
    core::RunningMoments slopes;
    for (const std::uint64_t seed : table_.seeds()) slopes.add(slopeInCount(table_.curve(scene_, m, seed, metric_)));
    return slopes.mean();
  }

  const Table& table_;
  const std::vector<Method>& methods_;
  const Method& target_;
  const int targetCount_;
  const std::string scene_, metric_;
};

std::vector<ByLights> byLights(const std::vector<EqualError>& equal) {
  std::vector<ByLights> all;
  for (const char* metric : kErrors) {
    ByLights lights{metric, {}, core::kNaN};
    for (const EqualError& e : equal)
      if (const int n = lampsIn(e.scene); n > 0 && e.best && e.metric == metric) lights.best.emplace_back(n, e);
    std::sort(lights.best.begin(), lights.best.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::pair<double, double>> ratios;
    for (const auto& [n, e] : lights.best) ratios.emplace_back(n, e.ratio.mean);
    lights.pays = riseAboveOne(ratios);
    if (lights.best.size() > 1) all.push_back(std::move(lights));
  }
  return all;
}

Json intervalJson(const core::Interval& i) {
  return {{"mean", numberOrNull(i.mean)}, {"low", numberOrNull(i.low)}, {"high", numberOrNull(i.high)}};
}

const char* nameOf(Reach reach) {
  switch (reach) {
    case Reach::measured:
      return "measured";
    case Reach::extrapolated:
      return "extrapolated";
    case Reach::atMost:
      return "at most";
    case Reach::atLeast:
      break;
  }
  return "at least";
}

}  // namespace

Findings analyse(const EfficiencyConfig& config, int targetCount, const std::vector<Row>& rows) {
  const Table table(rows);
  const std::vector<Method> methods = methodsOf(config);
  const std::vector<std::string> baselines = baselinesOf(config, methods);
  Findings findings{labelOf(config.target, targetCount), {}, {}, {}};
  for (const std::string& scene : table.scenes())
    for (const char* metric : kErrors) {
      const SceneAnalysis analysis(table, methods, config.target, targetCount, scene, metric);
      for (Point& p : analysis.points()) findings.points.push_back(std::move(p));
      for (EqualError& e : analysis.equal(baselines)) findings.equal.push_back(std::move(e));
    }
  findings.byLights = byLights(findings.equal);
  return findings;
}

std::string verdict(const ByLights& lights, const std::string& target) {
  if (std::isfinite(lights.pays))
    return fmt::format("{} pays from about {:.0f} lights on ({}, interpolated in the logarithm of their number).",
                       target, lights.pays, lights.metric);
  const auto isAbove = [](const auto& at) { return at.second.ratio.mean >= 1; };
  const bool all = std::all_of(lights.best.begin(), lights.best.end(), isAbove);
  const bool none = std::none_of(lights.best.begin(), lights.best.end(), isAbove);
  const char* where = all ? "at every number of lights measured" : none ? "at no number of lights measured" : "at some";
  return fmt::format("{} pays {} ({}: {:.0f} to {:.0f}).", target, where, lights.metric, lights.best.front().first,
                     lights.best.back().first);
}

Json pointJson(const Point& p) {
  return {{"scene", p.scene},
          {"method", p.method},
          {"count", p.count},
          {"metric", p.metric},
          {"milliseconds", intervalJson(p.milliseconds)},
          {"error", intervalJson(p.error)}};
}

Json equalErrorJson(const EqualError& e) {
  return {{"scene", e.scene},
          {"metric", e.metric},
          {"method", e.method},
          {"milliseconds", intervalJson(e.milliseconds)},
          {"ratio", intervalJson(e.ratio)},
          {"reach", nameOf(e.reach)},
          {"slope", numberOrNull(e.slope)},
          {"baseline", e.baseline},
          {"best", e.best}};
}

Json byLightsJson(const ByLights& lights) {
  Json best = Json::array();
  for (const auto& [n, e] : lights.best)
    best.push_back({{"lights", n}, {"method", e.method}, {"ratio", intervalJson(e.ratio)}, {"reach", nameOf(e.reach)}});
  return {{"metric", lights.metric}, {"best", best}, {"pays_from", numberOrNull(lights.pays)}};
}

}  // namespace experiments::efficiency
