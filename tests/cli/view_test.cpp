// sightline view as a person starts it: a picture without a display, a window under Xvfb with keys pressed, bad input.
#include <cstdlib>

#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

class View : public ProgramTest {
 protected:
  [[nodiscard]] static bool there_is(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
  }
};

TEST_F(View, DrawsAPictureWithoutADisplay) {
  const Outcome outcome = run({"view", "generate:city:objects=100", "--size", "320x200", "--screenshot",
                               file("picture.png").string(), "--press", "CV", "--click", "160,150"});
  if (outcome.code == 4 || outcome.code == 2) GTEST_SKIP() << "NO OPENGL OR VIEWER: " << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_file(file("picture.png")).substr(1, 3), "PNG");
}

TEST_F(View, RefusesWhatMakesNoSense) {
  expect_complaint({"view", "generate:city:objects=10", "--press", "C"}, 2, "--screenshot");
  expect_complaint({"view", "generate:city:objects=10", "--screenshot", file("a.png").string(), "--click", "1"}, 2,
                   "--click");
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

TEST_F(View, KeysReachTheWindow) {
  if (!there_is("xvfb-run") || !there_is("xdotool")) GTEST_SKIP() << "NO XVFB: xvfb-run or xdotool is missing";
  // Escape must end the program with 0; the other keys must not end it. The script prints how long it lived.
  const std::string script =
      std::string("'") + SIGHTLINE_TOOL +
      "' view generate:city:objects=60 --size 320x200 & pid=$!; "
      "for i in $(seq 100); do xdotool search --name sightline >/dev/null 2>&1 && break; sleep 0.2; done; sleep 1; "
      "for key in c v b z o m question n space; do xdotool key $key; sleep 0.1; done; "
      "kill -0 $pid || exit 41; xdotool key Escape; "
      "for i in $(seq 100); do kill -0 $pid 2>/dev/null || break; sleep 0.1; done; "
      "kill -9 $pid 2>/dev/null && exit 42; wait $pid";
  std::string escaped;
  for (const char c : script) escaped += c == '$' ? std::string("\\$") : std::string(1, c);
  const int status = std::system(
      ("xvfb-run -a -s '-screen 0 320x200x24' bash -c \"" + escaped + "\" > '" + file("log").string() + "' 2>&1")
          .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 0) << read_file(file("log"));
}

}  // namespace
}  // namespace sightline::cli_test
