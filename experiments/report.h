// report.html: one self-contained page that shows an experiment to people, without network.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/picture.h"
#include "experiments/results.h"

namespace experiments {

/// One image of a figure.
struct Panel {
  std::string label;
  std::string png;  ///< a PNG file's bytes
};

/// Images that belong side by side, such as every variant's frame, or every variant's error map.
struct Figure {
  std::string caption;  ///< says scene and frame
  int frame = 0;
  std::vector<Panel> panels;
  std::optional<ErrorScale> scale;  ///< maps: their common colour scale, drawn as a legend
  std::string scaleLabel = "relative squared error of a pixel (logarithmic)";
};

struct ReportData {
  std::string title;
  Results results;
  std::vector<Figure> figures;
  std::string overview;            ///< HTML of a first section, before the scenes; empty = none
  std::vector<std::string> notes;  ///< remarks on this run, such as a scene's warnings; one paragraph each
};

/// The whole page. All text is escaped.
std::string reportHtml(const ReportData& data);
/// Writes the page, complete or not at all. Throws core::Error.
void saveReport(const ReportData& data, const std::filesystem::path& file);

}  // namespace experiments
