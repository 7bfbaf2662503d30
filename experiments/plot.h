// Line plots, stacked bars and colour legends as SVG text, styled by the page's CSS classes.
#pragma once

#include <string>
#include <vector>

namespace experiments {

/// Points of one line; values that are not finite (or not positive on a logarithmic axis) leave a gap.
struct Line {
  std::string label;
  std::size_t style = 0;  ///< see seriesClass()
  std::vector<double> x, y;
  std::vector<double> low{}, high{};  ///< intervals of y, drawn as whiskers; empty = none
};

struct LinePlot {
  std::string title, xLabel, yLabel;
  bool logarithmic = true;  ///< y axis
  std::vector<Line> lines;
  bool labelled = false;      ///< lines of one point each: their labels stand beside them
  bool logarithmicX = false;  ///< x axis, which then has grid lines too
};

/// An empty string if there is no point to draw.
std::string svgLinePlot(const LinePlot& plot);

/// Which line is which, for several plots at once.
std::string htmlLegend(const std::vector<std::string>& labels);

struct StackedBars {
  std::string xLabel;
  std::vector<std::string> bars, segments;
  std::vector<std::vector<double>> values;  ///< [bar][segment], >= 0
};
std::string svgStackedBars(const StackedBars& plot);

/// The colours of an error map from low to high, with a logarithmic axis.
std::string svgColourScale(double low, double high, const std::string& label);

}  // namespace experiments
