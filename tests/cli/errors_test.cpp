// Every class of error has its exit code and one clear line.
#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

class Errors : public ProgramTest {};

constexpr const char* scene = "generate:city:objects=50";

TEST_F(Errors, UsageOfVerbsAndMethods) {
  expect_complaint({}, 2, "info");
  expect_complaint({"fly"}, 2, "'fly'");
  expect_complaint({"walk"}, 2, "SCENE");
  expect_complaint({"walk", scene, "--bogus"}, 2, "--bogus");
  expect_complaint({"walk", scene, "--method", "clairvoyance"}, 2, "clairvoyance");
  expect_complaint({"walk", scene, "--method", "zbuffer"}, 2, "zbuffer");
  expect_complaint({"walk", scene, "--method", "frustum_linear:speed=9"}, 2, "speed");
  expect_complaint({"walk", scene, "--method", "frustum_linear,,none"}, 2, "--method");
  expect_complaint({"walk", scene, "--method", "none,none"}, 2, "twice");
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
