// The program from outside: exit codes, one line for every failure, JSON on standard output.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/exr.h"
#include "core/files.h"

namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string out, error;
  std::ptrdiff_t errorLines() const { return std::count(error.begin(), error.end(), '\n'); }
};

class Cli : public testing::Test {
 protected:
  Cli() : folder_(fs::temp_directory_path() / ("twofold-cli-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Cli() override { fs::remove_all(folder_); }

  /// Runs the program with arguments as a shell would split them; never with unquoted names from outside.
  Outcome run(const std::string& arguments) const {
    const std::string out = file("out.txt"), error = file("error.txt");
    const int status =
        std::system(("'" TWOFOLD_PROGRAM "' " + arguments + " >'" + out + "' 2>'" + error + "'").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, core::readFile(out), core::readFile(error)};
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(file(name)) << text; }

  void expectUsageError(const std::string& arguments, const std::string& part = "") const {
    expectFailure(arguments, 2, part);
  }
  void expectFailure(const std::string& arguments, int code, const std::string& part = "") const {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.code, code) << arguments << "\n" << o.error;
    EXPECT_EQ(o.errorLines(), 1) << arguments << "\n" << o.error;
    EXPECT_EQ(o.error.rfind("twofold: ", 0), 0u) << o.error;
    EXPECT_EQ(o.out, "") << arguments;
    EXPECT_NE(o.error.find(part), std::string::npos) << o.error;
  }

 private:
  fs::path folder_;
};

TEST_F(Cli, HelpIsForEverySubcommand) {
  const Outcome all = run("--help");
  EXPECT_EQ(all.code, 0);
  for (const char* command : {"run", "render", "compare", "scene", "predict"}) {
    EXPECT_NE(all.out.find(command), std::string::npos) << command;
    const Outcome one = run(std::string(command) + " --help");
    EXPECT_EQ(one.code, 0) << command;
    EXPECT_NE(one.out.find("--help"), std::string::npos) << command;
    EXPECT_EQ(one.error, "") << command;
  }
  EXPECT_EQ(run("--version").code, 0);
}

TEST_F(Cli, WrongUsageExitsWithTwoAndOneLine) {
  for (const char* wrong :
       {"", "fly", "--fly", "predict", "predict --decay", "compare", "compare one.exr", "scene", "scene --list cornell",
        "scene cornell", "scene nowhere -o x.glb", "compare a b c", "run", "render"})
    expectUsageError(wrong);
}

TEST_F(Cli, PredictPrintsWhatIssueAsksFor) {
  const Outcome o = run("predict --decay 0.5 --counts 0,1,8");
  ASSERT_EQ(o.code, 0) << o.error;
  const auto frames = nlohmann::json::parse(o.out).at("frames");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(frames[0]["p"].is_null());
  EXPECT_EQ(frames[2]["n"], 8);
  EXPECT_EQ(frames[2]["weight"]["frames"], 1.5);
  EXPECT_EQ(frames[2]["weight"]["samples"], 8.5);
  EXPECT_EQ(frames[2]["power_sums"]["-1"], 0.375);
  EXPECT_EQ(frames[2]["power_sums"]["0"], 1.25);
  EXPECT_EQ(frames[2]["power_sums"]["1"], 8.25);
  EXPECT_DOUBLE_EQ(frames[2]["age"]["frames"], 0.5 / 1.5);
  EXPECT_LE(frames[2]["variance"]["blend"], frames[2]["variance"]["weighted"]);
  EXPECT_LE(frames[2]["variance"]["blend"], frames[2]["variance"]["unweighted"]);
}

TEST_F(Cli, PredictReadsCountsFromAFile) {
  write("counts.txt", "1 1\n8,0\n1\n");
  EXPECT_EQ(run("predict --decay 0.95 --counts-file '" + file("counts.txt") + "'").out,
            run("predict --decay 0.95 --counts 1,1,8,0,1").out);
}

TEST_F(Cli, PredictRefusesBadInput) {
  write("counts.txt", "1 1");
  write("words.txt", "one two");
  write("empty.txt", "\n");
  for (const std::string bad :
       {"--decay 1.5 --counts 1", "--decay -0.5 --counts 1", "--decay=-0.5 --counts 1", "--decay nan --counts 1",
        "--decay inf --counts 1", "--decay x --counts 1", "--decay 0.9 --counts 1,-1", "--decay 0.9 --counts=-1",
        "--decay 0.9 --counts nan", "--decay 0.9 --counts inf", "--decay 0.9 --counts ''", "--decay 0.9 --counts 1,,1",
        "--decay 0.9", "--counts 1"})
    expectUsageError("predict " + bad);
  expectUsageError("predict --decay 0.9 --counts 1 --counts-file '" + file("counts.txt") + "'", "both");
  for (const char* name : {"words.txt", "empty.txt", "absent.txt", ""})
    expectUsageError("predict --decay 0.9 --counts-file '" + file(name) + "'");
}

TEST_F(Cli, ComparePrintsMetrics) {
  core::writeExrRgb(file("a.exr"), core::Planes(32, 24, 0.5f).view());
  core::writeExrRgb(file("b.exr"), core::Planes(32, 24, 0.75f).view());
  const Outcome o = run("compare '" + file("a.exr") + "' '" + file("b.exr") + "'");
  ASSERT_EQ(o.code, 0) << o.error;
  const auto metrics = nlohmann::json::parse(o.out);
  EXPECT_NEAR(metrics["relMSE"], 0.0625 / 0.26, 1e-9);
  EXPECT_NEAR(metrics["relMSE_trimmed"], 0.0625 / 0.26, 1e-9);
  EXPECT_NEAR(metrics["energy_ratio"], 1.5, 1e-9);
  EXPECT_LT(metrics["SSIM"], 1.0);
  EXPECT_NEAR(metrics["MSE"], 0.0625, 1e-9);
}

TEST_F(Cli, CompareRefusesWhatCannotBeCompared) {
  core::Planes spoiled(32, 24, 0.5f);
  spoiled.view().store(3, 4, core::vec3(std::nanf("")));
  core::writeExrRgb(file("a.exr"), core::Planes(32, 24, 0.5f).view());
  core::writeExrRgb(file("small.exr"), core::Planes(32, 23, 0.5f).view());
  core::writeExrRgb(file("nan.exr"), spoiled.view());
  write("text.exr", "no image");
  const std::string good = "'" + file("a.exr") + "' ";
  expectFailure("compare " + good + "'" + file("small.exr") + "'", 1, "32x23");
  expectFailure("compare " + good + "'" + file("nan.exr") + "'", 1, "nan.exr: pixel (3, 4)");
  expectFailure("compare " + good + "'" + file("text.exr") + "'", 1, "text.exr");
  expectFailure("compare " + good + "'" + file("absent.exr") + "'", 1, "absent.exr");
  expectFailure("compare " + good + good + "--layer albedo", 1, "albedo");
}

TEST_F(Cli, ScenesAreListedAndWritten) {
  const Outcome list = run("scene --list");
  EXPECT_EQ(list.code, 0);
  for (const char* name : {"cornell", "ajar", "market"}) EXPECT_NE(list.out.find(name), std::string::npos) << name;
  const Outcome written = run("scene cornell -o '" + file("cornell.glb") + "'");
  EXPECT_EQ(written.code, 0) << written.error;
  EXPECT_EQ(core::readFile(file("cornell.glb")).substr(0, 4), "glTF");
  expectFailure("scene cornell -o '" + file("no/such/folder.glb") + "'", 1);
}

TEST_F(Cli, WrongConfigurationsExitWithTwo) {
  write("unknown.json", R"({"no_such_key": 1})");
  write("broken.json", "{\n\"frames\": \n}");
  expectUsageError("run '" + file("unknown.json") + "' -o '" + file("out") + "'", "no_such_key");
  expectUsageError("run '" + file("broken.json") + "' -o '" + file("out") + "'", "line 3");
  expectUsageError("run '" + file("absent.json") + "' -o '" + file("out") + "'");
  expectUsageError("render cornell --set no.such.key=1 -o '" + file("x.exr") + "'", "config.no: is not a known key");
  EXPECT_FALSE(fs::exists(file("x.exr")));
}

TEST_F(Cli, OutputThatCannotBeWrittenIsAFailure) {
  const int status = std::system("'" TWOFOLD_PROGRAM "' predict --decay 0.5 --counts 1 >/dev/full 2>/dev/null");
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

}  // namespace
