// Settings of an efficiency experiment: which methods of sampling direct light are timed, at which sample counts, on
// which scenes.
#pragma once

#include "experiments/config.h"

namespace experiments::efficiency {

/// One way to sample direct light, rendered at every one of its counts.
struct Method {
  std::string name;
  restir::RestirParameters restir;
  std::vector<int> counts;  ///< samples a pixel n, ascending

  /// Results of different pixels, frames and samples are independent, so that error falls as 1 / n.
  bool independent() const { return restir.reuse == restir::Reuse::none; }
  /// What a frame shows depends on the frames before.
  bool remembers() const { return restir.reuse == restir::Reuse::temporal || restir.reuse == restir::Reuse::both; }
};

template <class V>
void describe(V& v, Method& p) {
  v("name", p.name, "as in tables");
  v("restir", p.restir, "how it draws and reuses samples");
  v("counts", p.counts, "samples a pixel, ascending", 1.0, core::kMaxSamples);
}

/// The four baselines without reuse, and ReSTIR with two kinds of MIS weights.
std::vector<Json> defaultMethods();

struct EfficiencyConfig {
  std::vector<std::string> scenes{"lamps-10", "lamps-1000", "lamps-10000"};
  int warmUp = 24, frames = 8;  ///< frames before the first that counts, and those that count
  int width = 160, height = 90;
  std::vector<std::uint64_t> seeds{1, 2, 3, 4, 5};
  std::vector<int> counts{1, 2, 4};  ///< of methods that do not say otherwise
  std::vector<Json> methods = defaultMethods();
  std::string target = "balance";      ///< whose error the others must reach
  int targetCount = 0;                 ///< at which of its counts; 0 = its first
  std::vector<std::string> baselines;  ///< empty = all methods without reuse
  restir::RestirParameters restir;     ///< of methods that do not say otherwise
  twohistory::ReprojectionParameters reprojection;
  RenderParameters render;
  ReferenceParameters reference{256, 2, "out/cache"};
};

template <class V>
void describe(V& v, EfficiencyConfig& p) {
  v("scenes", p.scenes, "built-in names or glTF files");
  v("warmUp", p.warmUp, "frames before the first that counts", 0.0, 1e5);
  v("frames", p.frames, "frames that count: times are their medians", 1.0, 1e5);
  v("width", p.width, "pixels", 1.0, 16384.0);
  v("height", p.height, "pixels", 1.0, 16384.0);
  v("seeds", p.seeds, "one independent sequence each");
  v("counts", p.counts, "samples a pixel, ascending, of methods that do not say otherwise", 1.0, core::kMaxSamples);
  v("methods", p.methods, "objects {like, name, restir, counts}; like names one that stands before");
  v("target", p.target, "the method whose error the others must reach");
  v("targetCount", p.targetCount, "at how many samples a pixel; 0 = its first count", 0.0, core::kMaxSamples);
  v("baselines", p.baselines, "methods that the target is to beat; empty = all without reuse");
  v("restir", p.restir, "of methods that do not say otherwise");
  v("reprojection", p.reprojection, "which pixels of the frame before are the same surface");
  v("render", p.render, "how the machine works");
  v("reference", p.reference, "what errors are measured against");
}

/// Reads a configuration and applies assignments "path=value" to it. Throws core::UsageError.
EfficiencyConfig efficiencyConfigFrom(Json json, const std::vector<std::string>& assignments);

/// The methods of a configuration, complete and consistent. Throws core::UsageError.
std::vector<Method> methodsOf(const EfficiencyConfig& config);

/// What the target must beat, by name: those named, else every other method without reuse. Throws core::UsageError.
std::vector<std::string> baselinesOf(const EfficiencyConfig& config, const std::vector<Method>& methods);

/// The target's count. Throws core::UsageError where there is no such target or it has no such count.
int targetCountOf(const EfficiencyConfig& config, const std::vector<Method>& methods);

/// Name of a method at a count in results: "balance n=1".
std::string labelOf(const std::string& method, int count);

/// The same scenes, seeds, size and references as an experiment of `twofold run`, warm-up included.
Config experimentOf(const EfficiencyConfig& config);

}  // namespace experiments::efficiency
