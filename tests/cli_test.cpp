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
  for (const char* command : {"run", "render", "compare", "scene", "lab", "efficiency", "predict", "table"}) {
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
        "scene cornell", "scene nowhere -o x.glb", "compare a b c", "run", "render", "table"})
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
        "--decay inf --counts 1", "--decay x --counts 1", "--decay '' --counts 1", "--decay 0x1p-1 --counts 1",
        "--decay '0.5 ' --counts 1", "--decay 0.9 --counts 0x10", "--decay 0.9 --counts 1e400",
        "--decay 0.9 --counts 1,-1", "--decay 0.9 --counts=-1", "--decay 0.9 --counts nan", "--decay 0.9 --counts inf",
        "--decay 0.9 --counts ''", "--decay 0.9 --counts 1,,1", "--decay 0.9", "--counts 1"})
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

TEST_F(Cli, TableRefusesWhatHoldsNoResults) {
  expectFailure("table '" + file("absent.json") + "'", 1, "absent.json");
  write("broken.json", "{\"rows\": 3}");
  expectFailure("table '" + file("broken.json") + "'", 1, "broken.json");
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

/// A triangle whose buffer and texture lie in files that need not exist.
std::string gltfWith(const std::string& buffer, const std::string& texture) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
    "textures":[{"source":0}],"images":[{"uri":")" +
         texture + R"("}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
    "min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":")" +
         buffer + R"("}]})";
}

TEST_F(Cli, BrokenScenesEndRenderAndRunWithOneLineAndNoFile) {
  write("text.gltf", "this is no scene");
  write("empty.glb", "");
  write("buffer.gltf", gltfWith("absent.bin", "absent.png"));
  write("triangle.bin", std::string(36, '\0'));
  write("texture.gltf", gltfWith("triangle.bin", "absent.png"));
  for (const char* scene : {"text.gltf", "empty.glb", "buffer.gltf", "texture.gltf", "nowhere.gltf"}) {
    expectFailure("render '" + file(scene) + "' -o '" + file("out.exr") + "'", 1, scene);
    EXPECT_FALSE(fs::exists(file("out.exr")));
    write("config.json", R"({"scenes":[")" + file(scene) + R"("],"frames":1,"width":8,"height":8})");
    expectFailure("run '" + file("config.json") + "' -o '" + file("results") + "'", 1, scene);
    EXPECT_FALSE(fs::exists(file("results")));
  }
}

TEST_F(Cli, RenderRefusesOptionsThatMeanNothing) {
  const std::string out = " -o '" + file("out.exr") + "' ";
  for (const char* wrong :
       {"--resolution 4294967328x24", "--resolution 12", "--resolution 0x8", "--seed -1", "--seed 99999999999999999999",
        "--reference 0", "--reference 4 --raw", "--frames 0", "--set restir.demodulate=false", "--set nothing=1",
        "--set foveation.kind=map", "--set gaze.kind=file", "--threads -1"})
    expectUsageError("render cornell " + out + wrong);
  expectUsageError("render cornell -o '" + file("out.png") + "'");
  EXPECT_FALSE(fs::exists(file("out.exr")));
}

TEST_F(Cli, RunRefusesNamesThatCollideOrEscape) {
  const std::string base = "run '" + file("config.json") + "' -o '" + file("results") + "' --set ";
  write("config.json", R"({"frames":1,"width":8,"height":8,"seeds":[1]})");
  for (const char* wrong :
       {"'seeds=[1,1]'", "baseline=nosuch", R"('scenes=["cornell","cornell"]')",
        R"('variants=["unweighted","unweighted"]')", R"('variants=["unweighted",{"like":"seed","name":"../evil"}]')",
        R"('variants=[{"like":"lag-uw","name":"c","blend":{"correction":1}}]')"})
    expectUsageError(base + wrong);
  EXPECT_FALSE(fs::exists(file("results")));
}

TEST_F(Cli, EfficiencyRefusesWrongConfigurations) {
  const std::string output = " -o '" + file("results") + "' ";
  write("unknown.json", R"({"no_such_key": 1})");
  expectUsageError("efficiency '" + file("unknown.json") + "'" + output, "no_such_key");
  expectUsageError("efficiency '" + file("absent.json") + "'" + output);
  for (const char* wrong : {"methods=[]", "counts=[0]", "counts=[2,1]", "target=nosuch", "'seeds=[1,1]'", "frames=0",
                            "methods.0.name=balance", "methods.0.restir.reuse=some"})
    expectUsageError("efficiency" + output + "--set " + wrong);
  expectUsageError("efficiency --threads -1" + output);
  write("text.gltf", "this is no scene");
  expectFailure("efficiency" + output + R"(--set 'scenes=[")" + file("text.gltf") + R"("]')", 1, "text.gltf");
  EXPECT_FALSE(fs::exists(file("results")));
}

TEST_F(Cli, ASceneWithoutLightIsBlackWithOneWarning) {
  write("dark.gltf", R"({"asset":{"version":"2.0"}})");
  const Outcome o = run("render '" + file("dark.gltf") + "' --resolution 8x8 -o '" + file("out.exr") + "'");
  EXPECT_EQ(o.code, 0) << o.error;
  EXPECT_NE(o.error.find("no light"), std::string::npos) << o.error;
  EXPECT_TRUE(fs::exists(file("out.exr")));
}

// Parts of an interrupted experiment are named by the executable's content: an edited blend must not find old ones.
TEST_F(Cli, ARebuiltProgramDoesNotResumeWhatAnotherOneFinished) {
  const auto countParts = [&] {
    return std::distance(fs::directory_iterator(file("out/parts")), fs::directory_iterator());
  };
  const std::string arguments = "run '" + file("tiny.json") + "' -o '" + file("out") + "'";
  write("tiny.json", R"({"scenes": ["cornell"], "frames": 2, "width": 16, "height": 16, "seeds": [1],
    "variants": ["unweighted"], "reference": {"samples": 1, "every": 2}})");
  ASSERT_EQ(run(arguments).code, 0);
  ASSERT_EQ(countParts(), 1);
  EXPECT_EQ(run(arguments).code, 0);
  EXPECT_EQ(countParts(), 1) << "control: the same program resumes";

  const std::string rebuilt = file("rebuilt");
  fs::copy_file(TWOFOLD_PROGRAM, rebuilt);
  std::ofstream(rebuilt, std::ios::app) << "another build";  // which a loader does not look at
  ASSERT_EQ(std::system(("'" + rebuilt + "' " + arguments + " >/dev/null 2>&1").c_str()), 0);
  EXPECT_EQ(countParts(), 2);
}

}  // namespace
