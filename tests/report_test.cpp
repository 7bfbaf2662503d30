// The report: self-contained, escaped, complete; its plots, pictures and progress lines.
#include "experiments/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "core/statistics.h"
#include "experiments/markup.h"
#include "experiments/plot.h"
#include "experiments/progress.h"

namespace experiments {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++found;
  return found;
}

ReportData example() {
  ReportData data;
  data.title = "Market <at> night & \"day\"";
  for (const std::uint64_t seed : {1, 2})
    for (const char* variant : {"unweighted", "lag<b>", "oracle"}) {
      const double error = variant[0] == 'u' ? 2 : variant[0] == 'l' ? 1 : 0.5;
      data.results.rows.push_back({"market", variant, seed, "full", "relMSE", error + 0.1 * static_cast<double>(seed)});
      for (const int frame : {0, 4, 8})
        data.results.series.push_back({"market", variant, seed, "full", "relMSE", frame, error / (frame + 1)});
    }
  data.results.passes = {{"market", "unweighted", "filter", 3}, {"market", "lag<b>", "filter", 4}};
  data.results.config = {{"filter", {{"levels", 2}}}, {"name", "<script>alert(1)</script>"}};
  Picture picture(8, 8);
  data.figures.push_back(
      {"every variant, frame 4", 4, {{"reference", pngBytes(picture)}, {"lag", pngBytes(picture)}}, {}});
  data.figures.push_back({"errors, frame 4", 4, {{"lag", pngBytes(picture)}}, ErrorScale{}});
  return data;
}

TEST(Report, IsSelfContained) {
  const std::string html = reportHtml(example());
  for (const char* part : {"http:", "https:", "<link", "src=\"/", "url(", "@import"})
    EXPECT_EQ(count(html, part), 0u) << part;
  EXPECT_EQ(count(html, "data:image/png;base64,iVBORw0KGgo"), 3u);  // every PNG's first bytes
}

TEST(Report, HoldsEveryPart) {
  const std::string html = reportHtml(example());
  for (const char* part : {"What was measured", "Error in market", "Error by frame in market", "Time by pass in market",
                           "Frames", "Settings", "filter.levels", "relative squared error", "every pixel of the frame"})
    EXPECT_GT(count(html, part), 0u) << part;
  EXPECT_EQ(count(html, "<svg viewBox"), 3u);  // error by frame, time by pass, colour scale
  EXPECT_GT(count(html, "\u00d70.5"), 0u);     // ratio of lag to unweighted
}

TEST(Report, EscapesNamesTitlesAndSettings) {
  const std::string html = reportHtml(example());
  EXPECT_EQ(count(html, "<script>alert"), 0u);
  EXPECT_EQ(count(html, "lag<b>"), 0u);
  EXPECT_GT(count(html, "lag&lt;b&gt;"), 2u);
  EXPECT_GT(count(html, "Market &lt;at&gt; night &amp; &quot;day&quot;"), 0u);
}

TEST(Report, MarksTheBestButNeverTheOracle) {
  const std::string html = reportHtml(example());
  EXPECT_EQ(count(html, "class=\"best\""), 1u);
  EXPECT_NE(html.find("<tr><td>lag&lt;b&gt;</td><td class=\"best\">1.15"), std::string::npos);
}

TEST(Report, OfEmptyResultsIsStillAPage) {
  const std::string html = reportHtml({});
  EXPECT_EQ(html.rfind("<!DOCTYPE html>", 0), 0u);
  EXPECT_NE(html.find("</html>"), std::string::npos);
}

TEST(Report, TagsAreBalanced) {
  const std::string html = reportHtml(example());
  for (const char* tag : {"table", "tr", "td", "svg", "div", "figure", "details", "g", "dl", "script", "style"})
    EXPECT_EQ(count(html, "<" + std::string(tag) + ">") + count(html, "<" + std::string(tag) + " "),
              count(html, "</" + std::string(tag) + ">"))
        << tag;
}

TEST(Markup, Base64AgreesWithRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Plot, TicksAreRoundAndInside) {
  EXPECT_EQ(linearTicks(0, 60), (std::vector<double>{0, 20, 40, 60}));
  EXPECT_EQ(logarithmicTicks(0.01, 1), (std::vector<double>{0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1}));
  EXPECT_EQ(logarithmicTicks(1e-4, 10).size(), 6u);
  for (const double high : {1.001, 1.3, 2.0, 7.0, 1e6}) {
    const std::vector<double> ticks = logarithmicTicks(1, high);
    EXPECT_GE(ticks.size(), 2u) << high;
    for (const double tick : ticks) EXPECT_TRUE(tick >= 1 - 1e-9 && tick <= high * (1 + 1e-9)) << tick;
  }
}

TEST(Plot, LeavesGapsWhereALogarithmHasNoValue) {
  const LinePlot plot{"t", "x", "y", true, {{"a", 0, {0, 1, 2, 3}, {1, -1, std::nan(""), 0.1}}}};
  const std::string svg = svgLinePlot(plot);
  EXPECT_EQ(count(svg, "<circle"), 2u);
  EXPECT_EQ(count(svg, "nan"), 0u);
  EXPECT_EQ(count(svg, "inf"), 0u);
  EXPECT_EQ(svgLinePlot({"t", "x", "y", true, {{"a", 0, {0}, {-1}}}}), "");
  const std::string single = svgLinePlot({"t", "x", "y", true, {{"a", 0, {5}, {2}}}});
  EXPECT_EQ(count(single, "<circle"), 1u);
  EXPECT_EQ(count(single, "r=\"4\""), 1u);  // a single point is larger, as no line leads to it
  EXPECT_EQ(count(svg, "r=\"4\""), 0u);
  EXPECT_EQ(count(svgLinePlot({"t", "x", "y", false, {{"a", 0, {5}, {0}}}}), "nan"), 0u);
  EXPECT_EQ(count(svgLinePlot({"t", "x", "y", false, {{"point a", 0, {5}, {0}}}, true}), ">point a<"), 1u);
}

TEST(Picture, ToneMapKeepsOrderAndShowsWhatIsNotFinite) {
  core::Planes image(3, 1);
  image.view().store(0, 0, core::vec3(0));
  image.view().store(1, 0, core::vec3(1));
  image.view().store(2, 0, core::vec3(core::kInfinity));
  const Picture picture = toneMappedPicture(image.view());
  EXPECT_EQ(picture.at(0, 0)[0], 0);
  EXPECT_EQ(picture.at(1, 0)[0], 188);  // sRGB of 1/2
  EXPECT_EQ(picture.at(2, 0)[0], 255);
  EXPECT_EQ(picture.at(2, 0)[1], 0);
  EXPECT_GT(toneMappedPicture(image.view(), 1).at(1, 0)[0], 188);
}

TEST(Picture, ColourMapGrowsLighter) {
  float before = -1;
  for (int i = 0; i <= 100; ++i) {
    core::vec3 c = mapColour(i / 100.0);
    for (int k = 0; k < 3; ++k) c[k] = std::pow(c[k], 2.2f);
    EXPECT_GT(core::luminance(c), before) << i;
    before = core::luminance(c);
  }
}

TEST(Picture, ErrorsRunOverTheWholeScale) {
  const core::Planes reference(3, 1, 1.0f);
  core::Planes test(3, 1, 1.0f);
  test.view().store(1, 0, core::vec3(1.1f));
  test.view().store(2, 0, core::vec3(1e4f));
  const Comparison comparison(test.view(), Reference(reference.view()));
  const Picture picture = errorPicture(comparison, {1e-4, 10});
  const core::vec3 low = 255.0f * mapColour(0), high = 255.0f * mapColour(1);
  EXPECT_NEAR(picture.at(0, 0)[0], low.r, 1);
  EXPECT_NEAR(picture.at(2, 0)[0], high.r, 1);
  EXPECT_GT(picture.at(1, 0)[0], picture.at(0, 0)[0]);
  EXPECT_LT(picture.at(1, 0)[1], picture.at(2, 0)[1]);
}

TEST(Picture, CirclesAreDrawnWhereTheyBelong) {
  Picture picture(40, 40);
  for (auto& byte : picture.bytes) byte = 128;
  drawCircle(picture, {20, 20}, 10);
  EXPECT_EQ(picture.at(20, 20)[0], 128);  // the middle stays
  EXPECT_GT(picture.at(29, 20)[0], 200);  // 10 pixels right of it
  EXPECT_LT(picture.at(31, 20)[0], 128);  // the dark rim
  EXPECT_EQ(picture.at(39, 39)[0], 128);
  const Picture before = picture;
  drawCircle(picture, {1e30f, 0}, 10);
  drawCircle(picture, {std::nanf(""), 0}, 10);
  EXPECT_EQ(picture.bytes, before.bytes);
}

TEST(Progress, CountsFromManyThreadsAndSaysWhatItTook) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  {
    Progress progress("market", 400, file);
    progress.skip(200);
    std::thread other([&] {
      for (int i = 0; i < 100; ++i) progress.advance();
    });
    for (int i = 0; i < 100; ++i) progress.advance();
    other.join();
  }
  std::rewind(file);
  char text[200] = "";
  ASSERT_NE(std::fgets(text, sizeof text, file), nullptr);
  EXPECT_EQ(std::string(text).rfind("market: 400/400, took", 0), 0u) << text;
  EXPECT_EQ(std::fgets(text, sizeof text, file), nullptr) << "lines are rate-limited, but got " << text;
  std::fclose(file);
}

TEST(Progress, DurationsReadWell) {
  EXPECT_EQ(durationText(0.2), "1 s");
  EXPECT_EQ(durationText(185), "3 min 05 s");
  EXPECT_EQ(durationText(7800), "2 h 10 min");
}

}  // namespace
}  // namespace experiments
