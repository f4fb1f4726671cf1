// sightline view as a person starts it: a picture without a display, a window under Xvfb with keys pressed, bad input.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

class View : public ProgramTest {
 protected:
  [[nodiscard]] static bool there_is(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
  }
  [[nodiscard]] static bool there_is_xvfb() { return there_is("xvfb-run") && there_is("xdotool"); }
};

TEST_F(View, DrawsAPictureWithoutADisplay) {
  const Outcome outcome = run({"view", "generate:city:objects=100", "--size", "320x200", "--screenshot",
                               file("picture.png").string(), "--press", "CV", "--click", "160,150", "--json", "-"});
  if (outcome.code == 4 || outcome.code == 2) GTEST_SKIP() << "NO OPENGL OR VIEWER: " << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_file(file("picture.png")).substr(1, 3), "PNG");
  EXPECT_EQ(outcome.json()["size"], nlohmann::json({320, 200}));
  expect_complaint({"view", "generate:city:objects=10", "--screenshot", file("a.png").string(), "--press", "CX"}, 2,
                   "'X'");
}

TEST_F(View, RefusesWhatMakesNoSense) {
  expect_complaint({"view", "generate:city:objects=10", "--press", "C"}, 2, "--screenshot");
  expect_complaint({"view", "generate:city:objects=10", "--screenshot", file("a.png").string(), "--click", "1"}, 2,
                   "--click");
  expect_complaint({"view", "generate:city:objects=10", "--screenshot", file("a.png").string(), "--click", "1280,0"}, 2,
                   "--click");
  expect_complaint({"view", "generate:city:objects=10", "--json", file("a.json").string()}, 2, "--screenshot");
  expect_complaint({"view", "generate:city:objects=10", "--method", "none,zbuffer"}, 2, "gl_chc");
  expect_complaint({"view", file("none.glb").string(), "--screenshot", file("a.png").string()}, 3, "none.glb");
  EXPECT_FALSE(std::filesystem::exists(file("a.png")));
}

TEST_F(View, WithoutADisplayIsOneLine) {
  const Outcome probe = run({"view", "generate:city:objects=10", "--screenshot", file("probe.png").string()});
  if (probe.code != 0) GTEST_SKIP() << "NO OPENGL OR VIEWER: " << probe.err;
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  expect_complaint({"view", "generate:city:objects=10"}, 4, "window");
}

/// Starts the program under Xvfb, runs `keys` once its window is there, then `end`, and waits for its end; what it and
/// the shell wrote goes to `log`. Returns the program's exit code, 41 if it ended before `end`, 42 if it did not end
/// after.
int with_window(const std::string& arguments, const std::string& keys, const std::string& end,
                const std::filesystem::path& log) {
  const std::string script = std::string("'") + SIGHTLINE_TOOL + "' " + arguments +
                             " & pid=$!; "
                             "for i in $(seq 100); do xdotool search --name sightline >/dev/null 2>&1 && break; sleep "
                             "0.2; done; sleep 1; " +
                             keys + " kill -0 $pid || exit 41; " + end +
                             "; "
                             "for i in $(seq 100); do kill -0 $pid 2>/dev/null || break; sleep 0.1; done; "
                             "kill -9 $pid 2>/dev/null && exit 42; wait $pid";
  std::string escaped;
  for (const char c : script) escaped += c == '$' ? std::string("\\$") : std::string(1, c);
  const int status = std::system(
      ("xvfb-run -a -s '-screen 0 320x200x24' bash -c \"" + escaped + "\" > '" + log.string() + "' 2>&1").c_str());
  return WEXITSTATUS(status);
}

TEST_F(View, KeysReachTheWindow) {
  if (!there_is_xvfb()) GTEST_SKIP() << "NO XVFB: xvfb-run or xdotool is missing";
  // Escape must end the program with 0; the other keys must not end it.
  EXPECT_EQ(with_window("view generate:city:objects=60 --size 320x200",
                        "for key in c v b z o m question n space; do xdotool key $key; sleep 0.1; done;",
                        "xdotool key Escape", file("log")),
            0)
      << read_file(file("log"));
}

// The window goes while frames are drawn without pause: destroyed by somebody else, or cut off with its connection.
TEST_F(View, AWindowThatGoesInMidFrameIsOneLine) {
  if (!there_is_xvfb()) GTEST_SKIP() << "NO XVFB: xvfb-run or xdotool is missing";
  for (const char* how : {"windowclose", "windowkill"}) {
    EXPECT_EQ(with_window("view generate:city:objects=2000 --size 320x200", "",
                          std::string("xdotool search --name sightline ") + how, file("log")),
              4)
        << how;
    EXPECT_EQ(read_file(file("log")), "sightline: the window was taken away\n") << how;
  }
}

TEST_F(View, TheMazeIsWalkedInAWindow) {  // 13.17
  if (!there_is_xvfb()) GTEST_SKIP() << "NO XVFB: xvfb-run or xdotool is missing";
  EXPECT_EQ(with_window("maze --play --size 320x200", "xdotool keydown w; sleep 0.7; xdotool keyup w;", "xdotool key q",
                        file("log")),
            0)
      << read_file(file("log"));
  const std::string log = read_file(file("log"));
  const std::size_t at = log.find("stopped at ");
  ASSERT_NE(at, std::string::npos) << log;
  double x = 0, z = 0;
  ASSERT_EQ(std::sscanf(log.c_str() + at, "stopped at %lf %lf", &x, &z), 2);
  EXPECT_GT(std::abs(x - 1.5) + std::abs(z - 1.5), 0.3) << "the walker did not move";
}

}  // namespace
}  // namespace sightline::cli_test
