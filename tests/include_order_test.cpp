// The folders include each other in one direction only, and each third-party library is seen by one file of core:
//   core <- twohistory <- {restir, svgf} <- experiments; tests sees all.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Paths = std::set<std::string>;
using Sources = std::map<std::string, std::string>;  ///< path below the top level -> text

const std::map<std::string, Paths> kMayInclude{
    {"core", {"core"}},
    {"twohistory", {"core", "twohistory"}},
    {"restir", {"core", "twohistory", "restir"}},
    {"svgf", {"core", "twohistory", "svgf"}},
    {"experiments", {"core", "twohistory", "restir", "svgf", "experiments"}},
    {"tests", {"core", "twohistory", "restir", "svgf", "experiments", "tests"}},
};

/// Start of a third-party header's path -> the one file that may include it.
const std::map<std::string, std::string> kSoleUser{
    {"tiny_gltf", "core/gltf.cpp"}, {"embree", "core/tracer.cpp"}, {"OpenEXR/", "core/exr.cpp"},
    {"Imf", "core/exr.cpp"},        {"Imath", "core/exr.cpp"},     {"png.h", "core/png.cpp"},
};

const Paths kTopLevel{"CMakeLists.txt",
                      "CMakePresets.json",
                      "README.md",
                      "LICENSE",
                      "CHANGELOG.md",
                      ".clang-format",
                      ".clang-tidy",
                      ".gitignore",
                      ".git",
                      ".ci",
                      "docs",
                      "core",
                      "restir",
                      "svgf",
                      "twohistory",
                      "experiments",
                      "tests",
                      "build",
                      "out",
                      ".cache",
                      ".github",
                      "compile_commands.json"};

std::string folderOf(const std::string& path) { return path.substr(0, path.find('/')); }

std::vector<std::string> includesOf(const std::string& text) {
  static const std::regex kInclude(R"re((?:^|\n)[ \t]*#[ \t]*include[ \t]*[<"]([^">]+)[">])re");
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), kInclude), end; i != end; ++i) found.push_back((*i)[1]);
  return found;
}

/// Empty, or what is wrong with path including header.
std::string complaint(const std::string& path, const std::string& header) {
  const std::string folder = folderOf(path), target = folderOf(header);
  if (kMayInclude.count(target) && !kMayInclude.at(folder).count(target)) return path + " includes " + header;
  if (header.starts_with("../")) return path + " includes " + header + " by a relative path";
  for (const auto& [library, user] : kSoleUser)
    if (header.starts_with(library) && path != user && folder != "tests")
      return path + " includes " + header + ", which only " + user + " may";
  return "";
}

std::vector<std::string> complaints(const Sources& sources) {
  std::vector<std::string> found;
  for (const auto& [path, text] : sources)
    for (const std::string& header : includesOf(text))
      if (const std::string wrong = complaint(path, header); !wrong.empty()) found.push_back(wrong);
  return found;
}

std::string contentsOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

Sources readSources() {
  Sources sources;
  const fs::path top = TWOFOLD_SOURCE_DIR;
  for (const auto& [folder, targets] : kMayInclude)
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      const std::string path = entry.path().lexically_relative(top).generic_string();
      const bool source = entry.path().extension() == ".h" || entry.path().extension() == ".cpp";
      if (source && !path.starts_with("tests/package/")) sources[path] = contentsOf(entry.path());
    }
  return sources;
}

TEST(IncludeOrder, FoldersAndLibrariesAreSeenWhereTheyMay) {
  const Sources sources = readSources();
  ASSERT_GT(sources.size(), 40u);
  for (const std::string& wrong : complaints(sources)) ADD_FAILURE() << wrong;
}

TEST(IncludeOrder, TopLevelHoldsNothingElse) {
  for (const auto& entry : fs::directory_iterator(TWOFOLD_SOURCE_DIR)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(kTopLevel.count(name) || name.starts_with("build")) << name;
  }
}

/// Negative controls: every kind of wrong include is found, and right ones are not.
TEST(IncludeOrder, WrongIncludesAreFound) {
  const auto count = [](const std::string& path, const std::string& text) { return complaints({{path, text}}).size(); };
  EXPECT_EQ(count("core/a.h", "#include \"twohistory/ledger.h\"\n"), 1u);
  EXPECT_EQ(count("twohistory/a.cpp", "// x\n#include \"restir/restir.h\"\n"), 1u);
  EXPECT_EQ(count("restir/a.cpp", "  #  include \"svgf/svgf.h\"\n"), 1u);
  EXPECT_EQ(count("svgf/a.cpp", "#include <restir/restir.h>\n#include \"restir/target.h\"\n"), 2u);
  EXPECT_EQ(count("svgf/a.cpp", "#include \"../restir/restir.h\"\n"), 1u);
  EXPECT_EQ(count("svgf/a.cpp", "#include \"experiments/pipeline.h\"\n"), 1u);
  EXPECT_EQ(count("experiments/a.cpp", "#include \"tests/helper.h\"\n"), 1u);
  EXPECT_EQ(count("core/gbuffer.cpp", "#include <embree3/rtcore.h>\n"), 1u);
  EXPECT_EQ(count("experiments/a.cpp", "#include <tiny_gltf.h>\n#include <png.h>\n#include <ImfArray.h>\n"), 3u);
}

TEST(IncludeOrder, RightIncludesPass) {
  const auto count = [](const std::string& path, const std::string& text) { return complaints({{path, text}}).size(); };
  EXPECT_EQ(count("experiments/a.cpp", "#include \"svgf/svgf.h\"\n#include \"restir/restir.h\"\n#include <vector>\n"),
            0u);
  EXPECT_EQ(count("core/tracer.cpp", "#include <embree3/rtcore.h>\n#include \"core/tracer.h\"\n"), 0u);
  EXPECT_EQ(count("core/a.h", "// #include \"svgf/svgf.h\" would be wrong\n"), 0u);
}

}  // namespace
