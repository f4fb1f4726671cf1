// Every class of error has its exit code and one clear line.
#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

class Errors : public ProgramTest {};

constexpr const char* scene = "generate:city:objects=50";

TEST_F(Errors, UsageOfVerbsAndMethods) {
  expect_complaint({}, 2, "info");
  expect_complaint({"fly"}, 2, "'fly'");
  expect_complaint({"--fly"}, 2, "'--fly'");
  expect_complaint({"walk"}, 2, "SCENE");
  expect_complaint({"walk", scene, "--bogus"}, 2, "--bogus");
  expect_complaint({"walk", scene, "--method", "clairvoyance"}, 2, "clairvoyance");
  expect_complaint({"walk", scene, "--method", "zbuffer"}, 2, "zbuffer");
  expect_complaint({"walk", scene, "--method", "frustum_linear:speed=9"}, 2, "speed");
  expect_complaint({"walk", scene, "--method", "frustum_linear,,none"}, 2, "--method");
  expect_complaint({"walk", scene, "--method", "none,none"}, 2, "twice");
  expect_complaint({"compare", scene, "--methods", "all,none,none"}, 2, "twice");
  expect_complaint({"faces", scene, "--method", "backface,normal_mask,backface"}, 2, "twice");
  expect_complaint({"structures", scene, "--structure", "grid,grid"}, 2, "twice");
  expect_complaint({"bsp", scene, "--splitter", "first,first"}, 2, "twice");
  expect_complaint({"render", scene, "--method", "frustum_linear", "-o", file("x.png")}, 2, "frustum_linear");
  expect_complaint({"generate", "town", "-o", file("x.glb")}, 2, "town");
  expect_complaint({"generate", "city"}, 2, "output");
  expect_complaint({"info", "generate:town"}, 2, "town");
  expect_complaint({"info", "generate:city:floors=3"}, 2, "floors");
  expect_complaint({"info", "generate:city:objects=0"}, 2, "objects");
  expect_complaint({"explain", scene}, 2, "--object");
  expect_complaint({"explain", scene, "--object", "50000000"}, 2, "--object");
  expect_complaint({"explain", scene, "--object", "no such thing"}, 2, "no such thing");
  expect_complaint({"explain", scene, "--object", "car"}, 2, "car");
  expect_complaint({"explain", scene, "--object", "1", "--random", "3"}, 2, "--random");
  expect_complaint({"explain", scene, "--object", "1", "--method", "zbuffer"}, 2, "the names are: none");
  expect_complaint({"completion", "tcsh"}, 2, "tcsh");
  expect_complaint({"walk", scene, "--progress", "loud"}, 2, "--progress");
  EXPECT_FALSE(std::filesystem::exists(file("x.glb")));
  EXPECT_FALSE(std::filesystem::exists(file("x.png")));
}

TEST_F(Errors, UsageOfNumbers) {
  const std::vector<std::pair<std::string, std::string>> bad{
      {"--frames", "0"},    {"--frames", "-3"},  {"--frames", "12x"},   {"--frames", ""},    {"--size", "0x720"},
      {"--size", "1280"},   {"--size", "1x2x3"}, {"--size", "99999x2"}, {"--fov", "0"},      {"--fov", "180"},
      {"--fov", "nan"},     {"--fov", "-60"},    {"--near", "0"},       {"--near", "nan"},   {"--near", "inf"},
      {"--far", "nan"},     {"--ortho", "0"},    {"--ortho", "inf"},    {"--moving", "1.5"}, {"--moving", "-0.1"},
      {"--moving", "some"}, {"--samples", "0"},  {"--samples", "1e9"},  {"--seed", "-1"},    {"--seed", "1.5"},
      {"--far", "0"},       {"--near", "1e-30"}, {"--ortho", "1e-300"}, {"--fov", "0.001"},  {"--fov", "179.999"},
      {"--threads", "two"}, {"--threads", "-1"}};
  for (const auto& [option, value] : bad)
    expect_complaint({"walk", scene, "--method", "none", option, value}, 2, option);
  expect_complaint({"walk", scene, "--method", "none", "--near", "5", "--far", "5"}, 2, "--near");
  expect_complaint({"walk", scene, "--method", "none", "--ortho", "5", "--far", "inf"}, 2, "far");
  expect_complaint({"render", scene, "-o", file("x.png"), "--eye", "1,2"}, 2, "--eye");
  expect_complaint({"render", scene, "-o", file("x.png"), "--eye", "1,2,nan"}, 2, "--eye");
  expect_complaint({"render", scene, "-o", file("x.png"), "--eye", "1,2,3", "--look", "0,0,0"}, 2, "--look");
  expect_complaint({"render", scene, "-o", file("x.png"), "--show", "soul"}, 2, "--show");
  expect_complaint({"render", scene, "-o", file("x.png"), "--frames", "3", "--frame", "3"}, 2, "--frame");
}

TEST_F(Errors, BadInput) {
  expect_complaint({"info", file("absent.glb")}, 3, "absent.glb");
  expect_complaint({"walk", file("absent.glb"), "--method", "none"}, 3, "absent.glb");
  std::ofstream(file("broken.glb")) << "glTF but not really";
  expect_complaint({"info", file("broken.glb")}, 3, "broken.glb");
  std::ofstream(file("scene.unknown")) << "?";
  expect_complaint({"info", file("scene.unknown")}, 3, "scene.unknown");
  expect_complaint({"walk", scene, "--method", "none", "--path", file("absent.txt")}, 3, "absent.txt");
  std::ofstream(file("path.txt")) << "1 2 3\n4 five 6\n";
  expect_complaint({"walk", scene, "--method", "none", "--path", file("path.txt")}, 3, "path.txt");
}

TEST_F(Errors, UnwritableOutput) {
  const std::string nowhere = file("no/such/folder");
  expect_complaint({"walk", scene, "--method", "none", "--json", nowhere + "/x.json"}, 3, "x.json");
  expect_complaint({"info", scene, "--json", nowhere + "/x.json"}, 3, "x.json");
  expect_complaint({"list", "--json", nowhere + "/x.json"}, 3, "x.json");
  expect_complaint({"render", scene, "-o", nowhere + "/x.png"}, 3, "x.png");
  expect_complaint({"generate", "city", "-o", nowhere + "/x.glb"}, 3, "x.glb");
  expect_complaint({"info", scene, "--json", file("")}, 3, "folder");
  std::ofstream(file("plain")) << "in the way";
  expect_complaint({"walk", scene, "--method", "none", "--report", file("plain/report")}, 3, "report");
}

TEST_F(Errors, OutputsTakeNoOtherPlace) {
  const std::string glb = file("a.glb");
  ASSERT_EQ(run({"generate", "layers", "--objects", "3", "-o", glb}).code, 0);
  const std::string before = read_file(glb);
  expect_complaint({"boolean", glb, "union", glb, "-o", file("./a.glb")}, 2, "same file");
  expect_complaint({"info", glb, "--json", glb}, 2, "same file");
  EXPECT_EQ(read_file(glb), before) << "the input was written over";
  expect_complaint({"walk", scene, "--method", "none", "--json", file("x"), "--trace", file("x")}, 2, "same file");
  expect_complaint({"render", scene, "-o", "-", "--json", "-"}, 2, "same file");
  expect_complaint({"render", scene, "-o", file("x.jpg")}, 2, ".png");
  expect_complaint({"generate", "city", "-o", file("x.gltf")}, 2, ".glb");
  expect_complaint({"info", scene, "--json", ""}, 2, "--json");
  expect_complaint({"walk", scene, "--report", ""}, 2, "--report");
  EXPECT_EQ(run({"generate", "layers", "--objects", "3", "-o", "/dev/null", "--json", "/dev/null"}).code, 0);
  // What goes to standard output is alone there.
  EXPECT_EQ(run({"generate", "layers", "--objects", "3", "-o", "-"}).out, before);
  const Outcome curve = run({"persistence", scene, "--frames", "2", "--size", "64x36", "--picture", "-"});
  EXPECT_TRUE(curve.out.starts_with("<svg")) << curve.out.substr(0, 100);
  EXPECT_TRUE(curve.out.ends_with("</svg>\n")) << curve.out;
}

TEST_F(Errors, JsonAndReportMayShareAFolder) {
  const Outcome outcome = run({"walk", scene, "--method", "none", "--frames", "1", "--size", "64x36", "--report",
                               file("report"), "--json", file("report/walk.json")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(file("report/walk.json")));
}

/// The exit code of the program with its standard streams redirected by a shell.
int code_in_shell(const std::string& words) {
  const int status = std::system((std::string("'") + SIGHTLINE_TOOL + "' " + words).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

TEST_F(Errors, StandardStreamsMayBeGone) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "SKIPPED: no /dev/full on this system";
  EXPECT_EQ(code_in_shell("fly 2>/dev/full"), 2);
  EXPECT_EQ(code_in_shell("fly 2>&-"), 2);
  EXPECT_EQ(code_in_shell("info generate:soup >/dev/null --progress json 2>/dev/full"), 0);
  EXPECT_EQ(code_in_shell("list >/dev/full 2>/dev/null"), 3);
  EXPECT_EQ(code_in_shell("list >&- 2>/dev/null"), 3);
  // A file must not take the descriptor of a closed stream, and with it what is printed there.
  const std::string json = file("walk.json");
  EXPECT_EQ(code_in_shell(std::string("walk ") + scene + " --frames 2 --size 64x36 --progress json --json '" + json +
                          "' >/dev/null 2>&-"),
            0);
  EXPECT_TRUE(nlohmann::json::accept(read_file(json))) << read_file(json);
}

TEST_F(Errors, FullDiskIsNoSuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "SKIPPED: no /dev/full on this system";
  const Outcome outcome = run({"info", scene, "--json", "/dev/full"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full")) << "the device was replaced by a file";
}

TEST_F(Errors, FailureLeavesNoFiles) {
  run({"walk", file("absent.glb"), "--method", "none", "--json", file("out.json")});
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file("")), {}), 2)
      << "more than stdout and stderr is left";
}

TEST_F(Errors, HelpIsNoError) {
  for (const char* verb :
       {"info", "list", "generate", "walk", "render", "explain", "completion", "view", "compare", "raster-report"}) {
    const Outcome outcome = run({verb, "--help"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_NE(outcome.out.find(std::string("sightline ") + verb), std::string::npos);
    EXPECT_NE(outcome.out.find("Examples:"), std::string::npos);
    for (const char* option : {"--threads", "--seed", "--json", "--quiet", "--strict", "--progress"})
      EXPECT_NE(outcome.out.find(option), std::string::npos) << verb << " lacks " << option;
  }
}

}  // namespace
}  // namespace sightline::cli_test
