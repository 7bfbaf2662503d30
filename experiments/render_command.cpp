// `twofold render`: one scene to frames, or to their mean.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <memory>
#include <optional>

#include "core/exr.h"
#include "core/files.h"
#include "core/parallel.h"
#include "experiments/commands.h"
#include "experiments/picture.h"
#include "experiments/pipeline.h"
#include "experiments/progress.h"
#include "experiments/reference.h"
#include "experiments/reuse_pictures.h"
#include "experiments/scene_source.h"
#include "experiments/threads.h"

namespace experiments {
namespace {

using core::Planes;
using core::PlanesView;

struct RenderArguments {
  std::string scene, output, resolution;
  std::vector<std::string> assignments;
  int frames = 1, threads = 0;
  std::optional<int> reference;
  std::string seedText = "1";
  std::uint64_t seed = 1;
  bool mean = false, raw = false;
};

Config renderDefaults() {
  Config config;
  config.shade.foveation.kind = core::FoveationKind::uniform;
  config.variants = {"unweighted"};
  return config;
}

/// A whole number that is all of the text.
template <class T>
std::optional<T> numberFrom(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return {};
  return value;
}

std::optional<std::pair<int, int>> sizeFrom(std::string_view text) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return {};
  const auto width = numberFrom<int>(text.substr(0, x)), height = numberFrom<int>(text.substr(x + 1));
  if (!width || !height) return {};
  return std::pair(*width, *height);
}

Config configOf(const RenderArguments& a) {
  const auto fail = [](const char* where, const std::string& what, const char* remedy) {
    throw core::UsageError(where, what, remedy);
  };
  Json json = Json::object();
  json["frames"] = a.frames;
  if (!a.resolution.empty()) {
    const auto size = sizeFrom(a.resolution);
    if (!size) fail("--resolution", "'" + a.resolution + "' is no size", "give WIDTHxHEIGHT, such as 640x360");
    json["width"] = size->first;
    json["height"] = size->second;
  }
  if (a.reference && *a.reference < 1) fail("--reference", "fewer samples than one", "give at least 1");
  if (a.reference && a.raw) fail("--reference", "it cannot be combined with --raw", "a reference is never filtered");
  return configFrom(json, a.assignments, renderDefaults());
}

/// Sum of frames in double precision, over the frames in which a pixel had samples.
class MeanImage {
 public:
  MeanImage(int width, int height) : sums_(width, height), counts_(width, height) {}
  void add(PlanesView<const float> image, core::In<float> samples) {
    core::forEachPixel(counts_.width(), counts_.height(), [&](int x, int y) {
      if (!samples.empty() && !(samples(x, y) > 0)) return;
      sums_(x, y) += glm::dvec3(image.load(x, y));
      ++counts_(x, y);
    });
  }
  void store(PlanesView<float> out) const {
    core::forEachPixel(counts_.width(), counts_.height(), [&](int x, int y) {
      out.store(x, y, core::vec3(sums_(x, y) / static_cast<double>(std::max(1, counts_(x, y)))));
    });
  }

 private:
  core::Image<glm::dvec3> sums_;
  core::Image<int> counts_;
};

/// Renders frame by frame into an image: filtered, raw, or reference.
class FrameSource {
 public:
  FrameSource(const Stage& stage, const Config& config, const RenderArguments& a)
      : stage_(stage), config_(config), arguments_(a), variant_(variantsOf(config).front()) {
    if (a.reference) {
      instant_.gbuffer = core::GBuffer(config.width, config.height);
      return;
    }
    shading_.emplace(stage, config.shade, a.seed, config.width, config.height);
    if (!a.raw) filter_.emplace(variant_, config.width, config.height);
  }

  /// Of the last frame; null unless asked for.
  const restir::Diagnostics* diagnostics() const { return shading_ ? shading_->diagnostics() : nullptr; }

  /// Fills out; returns sample counts where a pixel without samples says nothing about the scene (raw frames).
  core::In<float> render(int frame, PlanesView<float> out) {
    const auto number = static_cast<std::uint32_t>(frame);
    if (!shading_) {
      stage_.pose(number, nullptr, instant_);
      stage_.trace(instant_.pose, config_.render.features, config_.render.tile, instant_);
      renderReference(instant_, *arguments_.reference, arguments_.seed * 0x10001 + number, config_.render.tile, out);
      return {};
    }
    const Shaded shaded = shade(stage_, config_.shade, number, *shading_);
    if (!filter_) {
      remodulate(shaded.radiance, shaded, out);
      return shaded.samples;
    }
    filter(shaded, variant_, {}, *filter_, out);
    return {};
  }

 private:
  const Stage& stage_;
  const Config& config_;
  const RenderArguments& arguments_;
  Variant variant_;
  Instant instant_;
  std::optional<ShadeState> shading_;
  std::optional<FilterState> filter_;
};

std::filesystem::path numbered(const std::filesystem::path& file, int frame, bool several) {
  if (!several) return file;
  return file.parent_path() / fmt::format("{}.{:04}{}", file.stem().string(), frame, file.extension().string());
}

void writeImages(const std::filesystem::path& exr, PlanesView<const float> image, float exposure) {
  core::writeExrRgb(exr, image);
  std::filesystem::path png = exr;
  core::writeFileAtomically(png.replace_extension(".png"), pngBytes(toneMappedPicture(image, exposure)));
}

void render(const RenderArguments& a) {
  const ThreadLimit threads(a.threads);
  const Config config = configOf(a);
  const std::filesystem::path output = a.output;
  if (output.extension() != ".exr")
    throw core::UsageError("-o", "'" + a.output + "' does not end in .exr",
                           "name an OpenEXR file; a PNG is written beside it");
  if (output.has_parent_path() && !std::filesystem::is_directory(output.parent_path()))
    throw core::Error(a.output, "its folder does not exist", "create it, or name another file");

  const core::Scene scene = loadScene(a.scene, {}, environmentOf(config.scene));
  const Stage stage(scene);
  FrameSource source(stage, config, a);
  Planes image(config.width, config.height);
  MeanImage mean(a.mean ? config.width : 0, a.mean ? config.height : 0);
  Progress progress(a.scene, config.frames);
  for (int frame = 0; frame < config.frames; ++frame) {
    const core::In<float> samples = source.render(frame, image);
    if (const restir::Diagnostics* d = source.diagnostics())
      writeReusePictures(numbered(output, frame, config.frames > 1).replace_extension(), *d, config.output.exr);
    if (a.mean)
      mean.add(image, samples);
    else
      writeImages(numbered(output, frame, config.frames > 1), image, config.output.exposure);
    progress.advance();
  }
  if (!a.mean) return;
  mean.store(image);
  writeImages(output, image, config.output.exposure);
}

}  // namespace

void addRenderCommand(CLI::App& app) {
  auto a = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand("render", "one scene to frames (OpenEXR, and PNG beside)");
  command->add_option("scene", a->scene, "file.gltf, file.glb, or a built-in name")->required();
  command->add_option("-o,--output", a->output, "OUT.exr; OUT.0000.exr, ... for several frames")->required();
  command->add_option("--frames", a->frames, "at 30 a second")->capture_default_str();
  command->add_option("--resolution", a->resolution, "WIDTHxHEIGHT");
  command->add_option("--threads", a->threads, "0 = all");
  command->add_option("--seed", a->seedText, "of the random numbers")->capture_default_str();
  command->add_option("--set", a->assignments, "path=value, changes one setting")->take_all();
  command->add_option("--reference", a->reference, "N samples a pixel by light sampling with MIS, without reuse");
  command->add_flag("--mean", a->mean, "write the mean over frames instead of every frame");
  command->add_flag("--raw", a->raw, "write the shaded radiance instead of the filtered image");
  command->footer([] { return "Settings and their defaults:\n" + listKeys(renderDefaults()); });
  command->callback([=] {
    const auto seed = numberFrom<std::uint64_t>(a->seedText);
    if (!seed) throw core::UsageError("--seed", "'" + a->seedText + "' is no seed", "give 0, 1, 2, ... below 2^64");
    a->seed = *seed;
    render(*a);
  });
}

}  // namespace experiments
