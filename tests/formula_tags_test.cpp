// Every tag of docs/history.md stands behind a line of code, not only in a comment of its own, and no tag of the code
// is without a formula. That the line computes it is for the reader to see.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

#include "core/files.h"

namespace {

namespace fs = std::filesystem;
using Tags = std::set<std::string>;

/// Tags are [family name]. Others name formulas of the literature ([SVGF (5)], [Tu24]) or of the header that they stand
/// in ([merge 1], [env 1], [tree 1]).
Tags tagsOf(const std::string& text) {
  static const std::regex kTag(R"(\[(?:ledger|blend|check|moments|clamp|told)(?: [^\]\n]*)?\])");
  Tags tags;
  for (std::sregex_iterator i(text.begin(), text.end(), kTag), end; i != end; ++i) tags.insert(i->str());
  return tags;
}

/// Without the lines that are nothing but a comment.
std::string linesOfCode(const std::string& text) {
  std::string code;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string::npos && line.compare(first, 2, "//") != 0) code += line + '\n';
  }
  return code;
}

/// read: which part of a file's text is looked at.
template <class Read>
Tags tagsOfCode(const Read& read) {
  Tags all;
  for (const char* folder : {"core", "twohistory", "restir", "svgf"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(TWOFOLD_SOURCE_DIR) / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".h" || extension == ".cpp") all.merge(tagsOf(read(core::readFile(entry.path().string()))));
    }
  return all;
}

Tags missingFrom(const Tags& all, const Tags& some) {
  Tags missing;
  std::set_difference(some.begin(), some.end(), all.begin(), all.end(), std::inserter(missing, missing.end()));
  return missing;
}

const Tags kNone;

TEST(FormulaTags, OfThePageAreInTheCodeAndThoseOfTheCodeOnThePage) {
  const Tags page = tagsOf(core::readFile(TWOFOLD_SOURCE_DIR "/docs/history.md"));
  EXPECT_GT(page.size(), 20u);
  EXPECT_EQ(missingFrom(tagsOfCode(linesOfCode), page), kNone) << "on the page and on no line of code";
  EXPECT_EQ(missingFrom(page, tagsOfCode([](const std::string& text) { return text; })), kNone)
      << "in the code and not on the page";
}

TEST(FormulaTags, ControlATagThatIsMissingIsNoticed) {
  const Tags tags = tagsOf("a [ledger 1] b [blend lag, two] c [SVGF (5)] d [0, 1] e [told]");
  EXPECT_EQ(tags, (Tags{"[ledger 1]", "[blend lag, two]", "[told]"}));
  EXPECT_EQ(missingFrom({"[ledger 1]"}, tags), (Tags{"[blend lag, two]", "[told]"}));
  EXPECT_EQ(tagsOf(linesOfCode("  // [told]\n  x = 1;  // [clamp]\n")), (Tags{"[clamp]"}));
}

}  // namespace
