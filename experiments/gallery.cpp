#include "experiments/gallery.h"

#include <fmt/format.h>

#include "core/exr.h"
#include "core/files.h"
#include "experiments/reuse_pictures.h"

namespace experiments {
namespace {

constexpr ErrorScale kErrorScale{1e-4, 1};
constexpr core::vec3 kGazeColour{0.2f, 0.9f, 1.0f};

}  // namespace

std::vector<int> galleryFrames(const Config& config) {
  if (!config.output.frames.empty()) return config.output.frames;
  std::vector<int> all;
  for (int frame = 0; frame < config.frames; ++frame)
    if (hasReference(config, frame)) all.push_back(frame);
  if (all.size() <= 3) return all;
  return {all[all.size() / 3], all[2 * all.size() / 3], all.back()};
}

Gallery::Gallery(const Config& config, std::filesystem::path folder) : config_(config), folder_(std::move(folder)) {}

std::filesystem::path Gallery::fileOf(const std::string& scene, const std::string& variant, int frame,
                                      const char* ending) const {
  return folder_ / scene / fmt::format("{}.{:04}{}", variant, frame, ending);
}

void Gallery::write(const std::string& scene, const std::string& variant, int frame,
                    core::PlanesView<const float> image, const core::vec2* gaze) const {
  std::filesystem::create_directories(folder_ / scene);
  if (config_.output.exr) core::writeExrRgb(fileOf(scene, variant, frame, ".exr"), image);
  Picture picture = toneMappedPicture(image, config_.output.exposure);
  core::writeFileAtomically(fileOf(scene, variant, frame, ".png"), pngBytes(picture));
  if (!gaze || config_.shade.foveation.kind == core::FoveationKind::uniform) return;
  const float radius = config_.shade.foveation.radius * static_cast<float>(config_.height);
  drawCircle(picture, *gaze, radius, kGazeColour);
  core::writeFileAtomically(fileOf(scene, variant, frame, ".gaze.png"), pngBytes(picture));
}

void Gallery::add(const std::string& scene, const FrameImage& image) const {
  write(scene, image.variant, image.frame, image.image, &image.gaze);
  if (image.comparison)
    core::writeFileAtomically(fileOf(scene, image.variant, image.frame, ".error.png"),
                              pngBytes(errorPicture(*image.comparison, kErrorScale)));
}

void Gallery::addDiagnostics(const std::string& scene, int frame, const restir::Diagnostics& diagnostics) const {
  std::filesystem::create_directories(folder_ / scene);
  writeReusePictures(fileOf(scene, "raw", frame, ""), diagnostics, config_.output.exr);
}

void Gallery::addReference(const std::string& scene, int frame, core::PlanesView<const float> image) const {
  write(scene, "reference", frame, image, nullptr);
}

Panel Gallery::panel(const std::string& label, const std::filesystem::path& file) const {
  return {label, std::filesystem::exists(file) ? core::readFile(file) : std::string()};
}

std::vector<Figure> Gallery::figures(const std::string& scene, const std::vector<std::string>& variants) const {
  std::vector<Figure> figures;
  std::vector<std::string> names{"raw"};
  names.insert(names.end(), variants.begin(), variants.end());
  for (const int frame : galleryFrames(config_)) {
    Figure images{
        fmt::format("{}, frame {}: reference, unfiltered frame, and every variant. Circle: the fovea.", scene, frame),
        frame,
        {panel("reference", fileOf(scene, "reference", frame, ".png"))},
        {},
        {}};
    Figure errors{
        fmt::format("{}, frame {}: relative squared error of each pixel.", scene, frame), frame, {}, kErrorScale};
    for (const std::string& name : names) {
      const auto gaze = fileOf(scene, name, frame, ".gaze.png");
      images.panels.push_back(panel(name, std::filesystem::exists(gaze) ? gaze : fileOf(scene, name, frame, ".png")));
      errors.panels.push_back(panel(name, fileOf(scene, name, frame, ".error.png")));
    }
    for (Figure* figure : {&images, &errors}) {
      std::erase_if(figure->panels, [](const Panel& p) { return p.png.empty(); });
      if (!figure->panels.empty()) figures.push_back(std::move(*figure));
    }
  }
  for (Figure& figure : reuseFigures(scene)) figures.push_back(std::move(figure));
  return figures;
}

std::vector<Figure> Gallery::reuseFigures(const std::string& scene) const {
  std::vector<Figure> figures;
  for (const ReuseQuantity& q : reuseQuantities()) {
    Figure figure{fmt::format("{}: {}.", scene, q.meaning), 0, {}, q.scale, std::string(q.name) + " (logarithmic)"};
    for (const int frame : galleryFrames(config_))
      figure.panels.push_back(
          panel(fmt::format("frame {}", frame), fileOf(scene, "raw", frame, fmt::format(".{}.png", q.name).c_str())));
    std::erase_if(figure.panels, [](const Panel& p) { return p.png.empty(); });
    if (!figure.panels.empty()) figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace experiments
