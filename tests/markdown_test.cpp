// Tables as Markdown: what they hold, what they leave out, what they refuse.
#include "experiments/markdown.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/check.h"

namespace experiments {
namespace {

/// Two scenes, three variants, two seeds; `b` has half of `a`'s error in one scene and twice as much in the other.
Results example() {
  Results r;
  r.baseline = "a";
  for (const std::uint64_t seed : {1, 2})
    for (const char* scene : {"hall", "yard"})
      for (const char* region : {"full", "fovea"}) {
        const double error = (seed == 1 ? 1.0 : 1.1) * (region[1] == 'u' ? 4 : 1);
        r.rows.push_back({scene, "a", seed, region, "relMSE", error});
        r.rows.push_back({scene, "b", seed, region, "relMSE", error * (scene[0] == 'h' ? 0.5 : 2)});
        r.rows.push_back({scene, "c|d", seed, region, "relMSE", region[1] == 'u' ? error : NAN});
      }
  return r;
}

TEST(Markdown, HoldsMeansPairedRatiosAndTheWorstScene) {
  const std::string text = markdownTables(example(), {});
  EXPECT_NE(text.find("**hall, relMSE**\n\n| variant | full | over a | fovea | over a |\n|---|---|---|---|---|\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| a | 4.2 | 1 | 1.05 | 1 |\n"), std::string::npos) << text;
  EXPECT_NE(text.find("| b | 2.1 | 0.500 [0.500, 0.500] | 0.525 | 0.500 [0.500, 0.500] |\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("**all scenes, relMSE**"), std::string::npos);
  EXPECT_NE(text.find("| b | 1.000 | 2.000, yard | 1.000 | 2.000, yard |\n"), std::string::npos) << text;
}

TEST(Markdown, ShowsWhatIsMissingAndNoBarInsideACell) {
  const std::string text = markdownTables(example(), {});
  EXPECT_NE(text.find("| c\\|d | 4.2 | 1.000 [1.000, 1.000] | \u2013 | \u2013 |\n"), std::string::npos) << text;
}

TEST(Markdown, SelectsAndComparesWithWhatIsAskedFor) {
  MarkdownSelection s;
  s.scenes = {"yard"}, s.regions = {"fovea"}, s.variants = {"b", "a"}, s.baseline = "b";
  EXPECT_EQ(markdownTables(example(), s),
            "**yard, relMSE**\n\n| variant | fovea | over b |\n|---|---|---|\n| b | 2.1 | 1 |\n"
            "| a | 1.05 | 0.500 [0.500, 0.500] |\n\n");
}

// Contrasts are roots: of 4e-4 +- 12.7 * 1e-5 (Student's t of two seeds), and of 1e-4; negative ones are 0.
TEST(Markdown, ShowsBordersAsContrastsRegionByRegion) {
  Results r;
  r.baseline = "a";
  for (const std::uint64_t seed : {1, 2}) {
    const double sign = seed == 1 ? 1 : -1;
    for (const char* variant : {"a", "b"}) {
      const double scale = variant[0] == 'a' ? 1 : -1;
      r.rows.push_back({"pulse", variant, seed, "fovea", "border_contrast2", scale * (4e-4 + 1e-5 * sign)});
      r.rows.push_back({"pulse", variant, seed, "fovea", "border_noise", 1.5});
      r.rows.push_back({"pulse", variant, seed, "recently_foveal", "border_contrast2", scale * 1e-4});
      r.rows.push_back({"still", variant, seed, "recently_foveal", "border_contrast2", 4e-4});
    }
  }
  MarkdownSelection s;
  s.metrics = {"border_contrast2"};
  EXPECT_EQ(markdownTables(r, s),
            "**contrast of the border in %, noise outside over inside; fovea, recently_foveal**\n\n"
            "| scene | a | b |\n|---|---|---|\n"
            "| pulse | 2.0 [1.7, 2.3], x1.50 \\| 1.0 [1.0, 1.0] | 0.0 [0.0, 0.0], x1.50 \\| 0.0 [0.0, 0.0] |\n"
            "| still | \u2013 \\| 2.0 [2.0, 2.0] | \u2013 \\| 2.0 [2.0, 2.0] |\n\n");
}

TEST(Markdown, RefusesNamesThatAreNotThere) {
  for (const auto& list : {&MarkdownSelection::scenes, &MarkdownSelection::metrics, &MarkdownSelection::regions,
                           &MarkdownSelection::variants}) {
    MarkdownSelection s;
    s.*list = {"nothing"};
    EXPECT_THROW(markdownTables(example(), s), core::UsageError);
  }
  MarkdownSelection s;
  s.baseline = "nothing";
  EXPECT_THROW(markdownTables(example(), s), core::UsageError);
}

}  // namespace
}  // namespace experiments
