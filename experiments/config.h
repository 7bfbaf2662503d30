// All settings of an experiment: which scenes, frames and seeds, how they are shaded, and which variants filter them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/pipeline.h"
#include "experiments/scene_source.h"
#include "experiments/settings.h"

namespace experiments {

/// How the machine works; never changes a result.
struct RenderParameters {
  int tile = core::kDefaultTile;
  Features features = Features::automatic;
};

template <class V>
void describe(V& v, RenderParameters& p) {
  v("tile", p.tile, "pixels on a tile's side; changes no result", 1.0, 4096.0);
  v.choice("features", p.features, {{"auto", Features::automatic}, {"all", Features::all}},
           "kernels for what the scene has, or for everything; changes no result");
}

struct ReferenceParameters {
  int samples = 64;                 ///< a pixel, in each of the two independent halves
  int every = 4;                    ///< frames from one reference to the next; the last frame always has one
  std::string cache = "out/cache";  ///< folder for references; empty = none is kept
};

template <class V>
void describe(V& v, ReferenceParameters& p) {
  v("samples", p.samples, "samples a pixel in each of two independent halves", 1.0, 1048576.0);
  v("every", p.every, "frames from one reference to the next", 1.0, 1e6);
  v("cache", p.cache, "folder that keeps references, by content of scene and settings; empty = none");
}

struct OutputParameters {
  std::vector<int> frames;   ///< frames whose images are written and shown; empty = the last three with a reference
  bool exr = true;           ///< EXR beside PNG
  float exposure = 0;        ///< stops, of PNG images and of SSIM's tone map
  bool diagnostics = false;  ///< pictures of what reuse leaves behind, too
};

template <class V>
void describe(V& v, OutputParameters& p) {
  v("frames", p.frames, "frames whose images are written and shown in the report", 0.0, 1e6);
  v("exr", p.exr, "write EXR images beside PNG");
  v("exposure", p.exposure, "stops, for PNG images", -30.0, 30.0);
  v("diagnostics", p.diagnostics, "pictures of sample age, confidence, duplicates and N_eff, too");
}

struct Config {
  std::vector<std::string> scenes{"market"};  ///< built-in names or glTF files
  int frames = 60, width = 480, height = 270;
  std::vector<std::uint64_t> seeds{1, 2, 3};
  ShadeParameters shade;
  RenderParameters render;
  svgf::FilterParameters filter;                     ///< of all variants that do not say otherwise
  std::vector<Json> variants{"none", "unweighted"};  ///< names, or {"like": name, "name": new name, changes...}
  std::string baseline;  ///< what ratios are against; empty = unweighted, or the first variant where there is none
  ReferenceParameters reference;
  OutputParameters output;
  SceneParameters scene;
};

template <class V>
void describe(V& v, Config& p) {
  v("scenes", p.scenes, "built-in names or glTF files");
  v("scene", p.scene, "what every scene gets beside its own file");
  v("frames", p.frames, "frames a sequence, at 30 a second", 1.0, 1e6);
  v("width", p.width, "pixels", 1.0, 16384.0);
  v("height", p.height, "pixels", 1.0, 16384.0);
  v("seeds", p.seeds, "one independent sequence each");
  v("gaze", p.shade.gaze, "where the viewer looks");
  v("foveation", p.shade.foveation, "samples per pixel");
  v("reprojection", p.shade.reprojection, "which pixels of the frame before are the same surface");
  v("restir", p.shade.restir, "reservoir resampling");
  v("render", p.render, "how the machine works");
  v("filter", p.filter, "of all variants that do not say otherwise");
  v("variants", p.variants, "names, or objects {like, name, histories, blend, filter}");
  v("baseline", p.baseline, "the variant that ratios are against; empty = unweighted, else the first");
  v("reference", p.reference, "what errors are measured against");
  v("output", p.output, "images");
}

/// Reads a configuration and applies assignments "path=value" to it. Throws core::UsageError.
Config configFrom(Json json, const std::vector<std::string>& assignments, const Config& defaults = {});

/// The variants of a configuration, complete and consistent. Throws core::UsageError.
std::vector<Variant> variantsOf(const Config& config);

/// The variant that ratios are against. Throws core::UsageError where the one named is not there.
std::string baselineOf(const Config& config);

/// Throws core::UsageError, naming the key under path, where settings of ReSTIR contradict each other.
void requireConsistent(const restir::RestirParameters& parameters, const std::string& path);

/// Throws core::UsageError where scenes or seeds are missing or come twice, or a file is asked for but not named.
void requireConsistent(const Config& config);

/// True for frames that have a reference: every `every`-th, and the last.
bool hasReference(const Config& config, int frame);

}  // namespace experiments
