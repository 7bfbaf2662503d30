#include "experiments/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/markup.h"
#include "experiments/picture.h"

namespace experiments {

namespace {

constexpr double kWidth = 560, kHeight = 320, kLeft = 78, kRight = 14, kTop = 30, kBottom = 46;

/// Maps values to positions along one axis of the drawing.
class Axis {
 public:
  Axis(double low, double high, double from, double to, bool logarithmic)
      : low_(low), high_(high), from_(from), to_(to), logarithmic_(logarithmic) {}
  bool shows(double v) const { return std::isfinite(v) && (!logarithmic_ || v > 0); }
  double at(double v) const {
    const double t = logarithmic_ ? std::log(v / low_) / std::log(high_ / low_) : (v - low_) / (high_ - low_);
    return from_ + t * (to_ - from_);
  }
  std::vector<double> ticks() const { return logarithmic_ ? logarithmicTicks(low_, high_) : linearTicks(low_, high_); }

 private:
  double low_, high_, from_, to_;
  bool logarithmic_;
};

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double v) { low = std::min(low, v), high = std::max(high, v); }
  bool empty() const { return low > high; }
  /// A little room at both ends, and never a single point.
  Extent padded(bool logarithmic) const {
    if (logarithmic) {
      const double room = std::max(1.05, std::pow(high / low, 0.04));
      return {low / room, high * room};
    }
    const double room = high > low ? 0.04 * (high - low) : 0.5 * std::max(std::abs(high), 1.0);
    return {low - room, high + room};
  }
};

bool drawable(double v, bool logarithmic) { return std::isfinite(v) && (!logarithmic || v > 0); }

bool drawable(const LinePlot& plot, const Line& line, std::size_t i) {
  return drawable(line.x[i], plot.logarithmicX) && drawable(line.y[i], plot.logarithmic);
}

/// Whether a point has an interval that can be drawn.
bool hasWhisker(const LinePlot& plot, const Line& line, std::size_t i) {
  return i < line.low.size() && i < line.high.size() && drawable(line.low[i], plot.logarithmic) &&
         drawable(line.high[i], plot.logarithmic);
}

std::string text(double x, double y, const std::string& anchor, const std::string& content, const char* extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, extra,
                     escaped(content));
}

std::string rule(double x0, double y0, double x1, double y1, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>\n", x0, y0, x1, y1,
                     style);
}

std::string open(double width, double height, const std::string& label) {
  return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" role=\"img\" aria-label=\"{}\">\n", width,
                     height, width, escaped(label));
}

std::string polyline(const LinePlot& plot, const Line& line, const Axis& x, const Axis& y) {
  std::string path, marks;
  bool pen = false;
  std::size_t points = 0;
  for (std::size_t i = 0; i < line.x.size(); ++i) points += drawable(plot, line, i);
  const int radius = points == 1 ? 4 : 2;  // without a line beside it a small point is overlooked
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    const bool shown = drawable(plot, line, i);
    if (shown) {
      const double px = x.at(line.x[i]), py = y.at(line.y[i]);
      path += fmt::format("{}{:.1f} {:.1f}", pen ? "L" : "M", px, py);
      marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>", px, py, radius);
      if (hasWhisker(plot, line, i))
        marks += fmt::format("<path class=\"whisker\" d=\"M{0:.1f} {1:.1f}L{0:.1f} {2:.1f}\"/>", px, y.at(line.low[i]),
                             y.at(line.high[i]));
    }
    pen = shown;
  }
  return fmt::format("<g class=\"line {}\"><title>{}</title><path d=\"{}\"/>{}</g>\n", seriesClass(line.style),
                     escaped(line.label), path, marks);
}

/// Finds a free place for the name of a point: beside it, else further up, down or away, with a line to it.
class Labels {
 public:
  std::string place(double px, double py, const std::string& label) {
    const double width = 6.8 * static_cast<double>(label.size());
    const bool left = px + 9 + width > kWidth - kRight;
    for (const double away : {9.0, 90.0, 180.0, 270.0})
      for (int step = 0; step < 24; ++step) {
        const double shift = kRow * ((step + 1) / 2) * (step % 2 ? -1 : 1), from = left ? px - away - width : px + away;
        const Box box{from, py + shift - 0.5 * kRow, from + width, py + shift + 0.5 * kRow};
        if (!isFree(box)) continue;
        taken_.push_back(box);
        const std::string line =
            step > 0 || away > 10 ? rule(px, py, left ? box.x1 + 2 : box.x0 - 2, py + shift, "grid") : "";
        return line + text(left ? box.x1 : box.x0, py + shift + 4, left ? "end" : "start", label);
      }
    return text(px + 9, py + 4, "start", label);
  }
  /// Keeps names off a point.
  void avoid(double px, double py) { taken_.push_back({px - 4, py - 4, px + 4, py + 4}); }

 private:
  static constexpr double kRow = 13;
  struct Box {
    double x0, y0, x1, y1;
  };
  bool isFree(const Box& b) const {
    if (b.x0 < kLeft || b.x1 > kWidth || b.y0 < kTop || b.y1 > kHeight - kBottom) return false;
    return std::none_of(taken_.begin(), taken_.end(), [&](const Box& t) {
      return b.x0 < t.x1 && t.x0 < b.x1 && b.y0 < t.y1 - 0.5 && t.y0 < b.y1 - 0.5;
    });
  }
  std::vector<Box> taken_;
};

/// Lines of one point each, with their names.
std::string labelledPoints(const LinePlot& plot, const Axis& x, const Axis& y) {
  std::string svg, points;
  Labels labels;
  for (const Line& line : plot.lines) {
    if (!drawable(plot, line, 0)) continue;
    const double px = x.at(line.x.front()), py = y.at(line.y.front());
    labels.avoid(px, py);
    points += fmt::format("<g class=\"line {}\"><circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/></g>\n",
                          seriesClass(line.style), px, py);
  }
  for (const Line& line : plot.lines)
    if (drawable(plot, line, 0)) svg += labels.place(x.at(line.x.front()), y.at(line.y.front()), line.label);
  return svg + points;
}

std::string frameOf(const LinePlot& plot, const Axis& x, const Axis& y) {
  std::string svg = text(kLeft, 18, "start", plot.title, " class=\"heading\"");
  for (const double tick : y.ticks()) {
    svg += rule(kLeft, y.at(tick), kWidth - kRight, y.at(tick), "grid");
    svg += text(kLeft - 8, y.at(tick) + 4.5, "end", shortNumber(tick));
  }
  for (const double tick : x.ticks()) {
    if (plot.logarithmicX) svg += rule(x.at(tick), kTop, x.at(tick), kHeight - kBottom, "grid");
    svg += rule(x.at(tick), kHeight - kBottom, x.at(tick), kHeight - kBottom + 5, "axis");
    svg += text(x.at(tick), kHeight - kBottom + 19, "middle", shortNumber(tick));
  }
  svg += rule(kLeft, kTop, kLeft, kHeight - kBottom, "axis");
  svg += rule(kLeft, kHeight - kBottom, kWidth - kRight, kHeight - kBottom, "axis");
  svg += text((kLeft + kWidth - kRight) / 2, kHeight - 8, "middle", plot.xLabel);
  const double middle = (kTop + kHeight - kBottom) / 2;
  return svg +
         text(16, middle, "middle", plot.yLabel, fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle).c_str());
}

std::string barRow(const StackedBars& plot, std::size_t bar, const Axis& x, double y, double height) {
  std::string svg = text(kLeft + 62, y + 0.5 * height + 4.5, "end", plot.bars[bar]);
  double sum = 0;
  for (std::size_t s = 0; s < plot.segments.size(); ++s) {
    const double from = x.at(sum), to = x.at(sum + plot.values[bar][s]);
    sum += plot.values[bar][s];
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.1f}\" class=\"bar {}\"><title>{}: {} "
        "ms</title></rect>\n",
        from, y, to - from, height, seriesClass(s), escaped(plot.segments[s]), shortNumber(plot.values[bar][s]));
  }
  return svg + text(x.at(sum) + 5, y + 0.5 * height + 4.5, "start", shortNumber(sum));
}

}  // namespace

std::string svgLinePlot(const LinePlot& plot) {
  Extent xs, ys;
  for (const Line& line : plot.lines)
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!drawable(plot, line, i)) continue;
      xs.add(line.x[i]), ys.add(line.y[i]);
      if (hasWhisker(plot, line, i)) ys.add(line.low[i]), ys.add(line.high[i]);
    }
  if (xs.empty()) return "";
  xs = xs.padded(plot.logarithmicX), ys = ys.padded(plot.logarithmic);
  const Axis x(xs.low, xs.high, kLeft, kWidth - kRight, plot.logarithmicX);
  const Axis y(ys.low, ys.high, kHeight - kBottom, kTop, plot.logarithmic);
  std::string svg = open(kWidth, kHeight, plot.title + ": " + plot.yLabel) + frameOf(plot, x, y);
  if (plot.labelled) return svg + labelledPoints(plot, x, y) + "</svg>\n";
  for (const Line& line : plot.lines) svg += polyline(plot, line, x, y);
  return svg + "</svg>\n";
}

std::string htmlLegend(const std::vector<std::string>& labels) {
  std::string html = "<div class=\"legend\">";
  for (std::size_t i = 0; i < labels.size(); ++i)
    html += fmt::format(
        "<span><svg width=\"30\" height=\"12\" class=\"key\"><g class=\"line {}\"><path d=\"M1 6L29 "
        "6\"/></g></svg>{}</span>",
        seriesClass(i), escaped(labels[i]));
  return html + "</div>\n";
}

std::string svgStackedBars(const StackedBars& plot) {
  constexpr double kBar = 20, kPitch = 28, kStart = 150, kEnd = 700, kTotal = 760;
  double longest = 0;
  for (const auto& bar : plot.values) {
    double sum = 0;
    for (const double v : bar) sum += v;
    longest = std::max(longest, sum);
  }
  if (!(longest > 0)) return "";
  const Axis x(0, longest, kStart, kEnd, false);
  const double bottom = 8 + kPitch * static_cast<double>(plot.bars.size());
  std::string svg = open(kTotal, bottom + 44, plot.xLabel);
  for (const double tick : x.ticks()) {
    svg += rule(x.at(tick), 4, x.at(tick), bottom, "grid");
    svg += text(x.at(tick), bottom + 17, "middle", shortNumber(tick));
  }
  for (std::size_t b = 0; b < plot.bars.size(); ++b)
    svg += barRow(plot, b, x, 8 + kPitch * static_cast<double>(b), kBar);
  return svg + text((kStart + kEnd) / 2, bottom + 37, "middle", plot.xLabel) + "</svg>\n";
}

std::string svgColourScale(double low, double high, const std::string& label) {
  constexpr double kFrom = 30, kTo = 430, kBar = 14;
  constexpr int kSteps = 100;
  const Axis x(low, high, kFrom, kTo, true);
  std::string svg = open(460, 54, label);
  for (int i = 0; i < kSteps; ++i) {
    const core::vec3 c = 255.0f * mapColour((i + 0.5) / kSteps);
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"2\" width=\"{:.1f}\" height=\"{:.0f}\" fill=\"rgb({:.0f},{:.0f},{:.0f})\"/>",
        kFrom + i * (kTo - kFrom) / kSteps, (kTo - kFrom) / kSteps + 0.5, kBar, c.r, c.g, c.b);
  }
  for (const double tick : x.ticks()) svg += "\n" + text(x.at(tick), kBar + 17, "middle", shortNumber(tick));
  return svg + text((kFrom + kTo) / 2, kBar + 35, "middle", label) + "</svg>\n";
}

}  // namespace experiments
