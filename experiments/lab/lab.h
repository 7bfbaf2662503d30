// The laboratory: all blends on synthetic sequences whose truth is known, in minutes and without a renderer.
#pragma once

#include <filesystem>

#include "experiments/lab/synthetic.h"
#include "experiments/results.h"

namespace experiments::lab {

/// Signals, noises, motions and sample patterns on which histories are known to go wrong; see docs/results.md.
std::vector<Case> defaultCases();

/// Names of the variants compared unless a configuration says otherwise.
std::vector<Json> defaultVariants();

struct LabConfig {
  int frames = 96, first = 32;  ///< length of a sequence, and the first frame that counts
  int width = 128, height = 96;
  std::vector<std::uint64_t> seeds{1, 2, 3, 4};
  twohistory::ReprojectionParameters reprojection;
  svgf::FilterParameters filter;  ///< of cases with a filter
  std::vector<Json> variants = defaultVariants();
  std::vector<Case> cases = defaultCases();
  std::vector<double> stretch;  ///< factors; see stretched.h. Applied once, when a configuration is read
  std::string baseline = "unweighted";
};

template <class V>
void describe(V& v, LabConfig& p) {
  v("frames", p.frames, "frames a sequence, at 30 a second", 2.0, 1e6);
  v("first", p.first, "first frame that counts", 0.0, 1e6);
  v("width", p.width, "pixels", 8.0, 4096.0);
  v("height", p.height, "pixels", 8.0, 4096.0);
  v("seeds", p.seeds, "one independent sequence each");
  v("reprojection", p.reprojection, "which pixels of the frame before are the same surface");
  v("filter", p.filter, "the spatial filter, in cases that have one");
  v("variants", p.variants, "names, or objects {like, name, histories, blend}");
  v("cases", p.cases, "signal, noise, motion and samples of each");
  v("stretch", p.stretch, "runs the cases once a factor, all their numbers times it; empty = as they are", 0.1, 10.0);
  v("baseline", p.baseline, "the variant that ratios are against");
}

/// Reads a configuration, applies assignments "path=value", stretches the cases, and keeps those whose name contains
/// `only`. Throws core::UsageError.
LabConfig labConfigFrom(Json json, const std::vector<std::string>& assignments, const std::string& only);

/// Runs every case, seed and variant: a row each of "MSE" in every region, of "MSE_rgb" too
/// where the channels of any case differ, and at the fovea's border and that of where
/// it has been (border.h): of "border_step", mean squared step; "border_noise", noise outside over noise inside;
/// "border_contrast2", squared Weber contrast of the step in the mean image, from three seeds on. Cases are the
/// results' scenes.
Results runLab(const LabConfig& config);

/// runLab, and results.json, results.csv, report.html in folder (created if need be).
Results runLab(const LabConfig& config, const std::filesystem::path& folder);

}  // namespace experiments::lab
