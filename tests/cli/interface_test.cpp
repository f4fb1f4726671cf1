// Manual page and completions say what --help says; progress, colours, strictness and interrupts.
#include <pty.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

using Json = nlohmann::json;

class Interface : public ProgramTest {
 protected:
  /// What a shell prints for a script.
  static std::string shell(const std::string& command) {
    FILE* const pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return "";
    std::string text;
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    return pclose(pipe) == 0 ? text : text + "(failed)";
  }
  static bool there_is(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
  }

  /// What bash offers for these words, the last of which is being typed.
  std::string bash_offers(const std::vector<std::string>& words) const {
    std::string array;
    for (const std::string& word : words) array += " '" + word + "'";
    return shell("bash -c \"source '" + file("bash").string() + "'; COMP_WORDS=(" + array + "); COMP_CWORD=" +
                 std::to_string(words.size() - 1) + R"(; _sightline; printf '%s ' \"\${COMPREPLY[@]}\"")");
  }
};

TEST_F(Interface, BashCompletes) {
  std::ofstream(file("bash")) << run({"completion", "bash"}).out;
  EXPECT_EQ(bash_offers({"sightline", "ex"}), "explain ");
  EXPECT_EQ(bash_offers({"sightline", "walk", "--meth"}), "--method ");
  EXPECT_EQ(bash_offers({"sightline", "walk", "--method", "frustum_l"}), "frustum_linear ");
  EXPECT_EQ(bash_offers({"sightline", "render", "--method", "zbuffer_"}), "zbuffer_tiled ");
  EXPECT_EQ(bash_offers({"sightline", "walk", "--method", "backf"}), " ");
  EXPECT_EQ(bash_offers({"sightline", "faces", "--method", "backf"}), "backface ");
  EXPECT_EQ(bash_offers({"sightline", "explain", "--method", "gl_"}), " ");
  EXPECT_EQ(bash_offers({"sightline", "render", "--show", "d"}), "depth ");
  EXPECT_EQ(bash_offers({"sightline", "generate", "fo"}), "forest ");
  EXPECT_EQ(bash_offers({"sightline", "walk", "--seed", "1"}), " ");
  EXPECT_EQ(bash_offers({"sightline", "info", file("ba").string()}), file("bash").string() + " ");
  EXPECT_EQ(bash_offers({"sightline", "man"}), " ") << "hidden verbs are not offered";
}

TEST_F(Interface, FishCompletes) {
  if (!there_is("fish")) GTEST_SKIP() << "SKIPPED: no fish on this machine";
  std::ofstream(file("s.fish")) << run({"completion", "fish"}).out;
  const auto offers = [&](const std::string& line) {
    return shell("HOME='" + file("").string() + "' fish --no-config -c \"source '" + file("s.fish").string() +
                 "'; complete -C '" + line + "'\"");
  };
  EXPECT_EQ(offers("sightline ex"), "explain\twhy an object is seen or culled\n");
  EXPECT_EQ(offers("sightline walk --metho").substr(0, 9), "--method\t");
  EXPECT_EQ(offers("sightline walk --method frustum_l").substr(0, 14), "frustum_linear");
  EXPECT_EQ(offers("sightline generate fo").substr(0, 6), "forest");
}

TEST_F(Interface, ZshScriptIsSound) {
  if (!there_is("zsh")) GTEST_SKIP() << "SKIPPED: no zsh on this machine";
  std::ofstream(file("_sightline")) << run({"completion", "zsh"}).out;
  EXPECT_EQ(shell("zsh -n '" + file("_sightline").string() + "' 2>&1"), "");
  // The completion system takes it for the command, by the first line and when sourced.
  EXPECT_EQ(shell("cd '" + file("").string() +
                  "' && HOME=. zsh -fc 'fpath=($PWD $fpath); autoload -Uz compinit; compinit -u -D; "
                  "print $_comps[sightline]; source ./_sightline; print $_comps[sightline]' 2>&1"),
            "_sightline\n_sightline\n");
}

TEST_F(Interface, ManualNamesEveryOption) {
  const Outcome manual = run({"manual"});
  ASSERT_EQ(manual.code, 0);
  EXPECT_EQ(manual.out.substr(0, 15), ".TH SIGHTLINE 1");
  for (const char* part : {"\\fB\\-\\-method\\fR", "\\fB\\-\\-object\\fR", ".SH EXIT STATUS", "NO_COLOR"})
    EXPECT_NE(manual.out.find(part), std::string::npos) << part;
  EXPECT_EQ(run({"--help"}).out.find("manual"), std::string::npos);
  if (!there_is("man")) GTEST_SKIP() << "SKIPPED: no man on this machine";
  std::ofstream(file("sightline.1")) << manual.out;
  const std::string page =
      shell("MANWIDTH=120 LC_ALL=C.UTF-8 man --warnings -l '" + file("sightline.1").string() + "' 2>&1 | col -b");
  EXPECT_NE(page.find("sightline explain SCENE"), std::string::npos) << page;
  EXPECT_EQ(page.find("warning"), page.find("warnings")) << "man complains:\n" << page.substr(0, 2000);
}

TEST_F(Interface, ProgressAsJsonLines) {
  const Outcome outcome = run({"walk", "generate:city:objects=50", "--frames", "3", "--size", "64x36", "--method",
                               "none", "--quiet", "--progress", "json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.err);
  std::vector<Json> all;
  for (std::string line; std::getline(lines, line);) all.push_back(Json::parse(line));
  ASSERT_GE(all.size(), 2u);
  EXPECT_EQ(all.front(), Json({{"progress", "frames"}, {"done", 0}, {"total", 3}}));
  EXPECT_EQ(all.back(), Json({{"progress", "frames"}, {"done", 3}, {"total", 3}}));
}

TEST_F(Interface, ColoursOnlyOnATerminalWithoutNoColor) {
  const auto on_terminal = [&](bool no_color) {
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
      if (no_color) setenv("NO_COLOR", "1", 1);
      execl(SIGHTLINE_TOOL, "sightline", "walk", "generate:city:objects=50", "--frames", "2", "--size", "64x36",
            "--progress", "none", nullptr);
      _exit(127);
    }
    std::string text;
    char buffer[4096];
    for (ssize_t n = 0; (n = read(terminal, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<size_t>(n));
    int status = 0;
    waitpid(child, &status, 0);
    close(terminal);
    EXPECT_EQ(status, 0) << text;
    return text;
  };
  EXPECT_NE(on_terminal(false).find("\x1b[32m"), std::string::npos);
  EXPECT_EQ(on_terminal(true).find('\x1b'), std::string::npos);
}

TEST_F(Interface, StrictMakesWarningsErrors) {
  std::ofstream(file("lines.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\n";
  EXPECT_EQ(run({"info", file("lines.obj")}).code, 0);
  for (const char* verb : {"info", "walk"}) expect_complaint({verb, file("lines.obj"), "--strict"}, 3, "lines.obj");
  const Json walk =
      run({"walk", file("lines.obj"), "--frames", "1", "--size", "64x36", "--quiet", "--json", "-"}).json();
  EXPECT_EQ(walk.at("warnings").size(), 1u);
}

TEST_F(Interface, InterruptKeepsTheFramesSoFar) {
  constexpr std::size_t frames = 20000;
  for (const char* verb : {"bounds", "detail", "persistence", "sigma"}) {
    std::filesystem::remove(file("stderr"));  // of the verb before
    const pid_t child = start({verb, "generate:city:objects=60", "--frames", std::to_string(frames), "--size", "64x36",
                               "--json", file("out.json"), "--quiet", "--progress", "json"});
    const auto has_begun = [&] { return read_file(file("stderr")).find("\"frames\"") != std::string::npos; };
    for (int tries = 0; tries < 3000 && !has_begun(); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(has_begun()) << verb;
    kill(child, SIGINT);
    EXPECT_EQ(finish(child).code, 130) << verb;
    const Json json = Json::parse(read_file(file("out.json")));
    EXPECT_GE(json.at("frames").get<std::size_t>(), 1u) << verb;
    EXPECT_LT(json.at("frames").get<std::size_t>(), frames) << verb;
  }
}

TEST_F(Interface, InterruptKeepsTheRowsSoFar) {
  struct Long {
    std::vector<std::string> arguments;
    std::string begun;
    const char* rows;
  };
  const Long verbs[] = {
      {{"structures", "generate:city:objects=300", "--rays", "400000"}, "\"structures\",\"done\":1,", "structures"},
      {{"faces", "generate:city:objects=3000", "--frames", "3000"}, "\"methods\",\"done\":1,", "rows"},
      {{"bsp", "generate:city:objects=2000", "--splitter", "first,balance"}, "\"first\"", "trees"},
      {{"raster-report", "generate:city:objects=2000"}, "\"measures\"", "overdraw"}};
  for (const Long& verb : verbs) {
    std::filesystem::remove(file("stderr"));
    std::vector<std::string> arguments = verb.arguments;
    arguments.insert(arguments.end(), {"--json", file("out.json"), "--progress", "json"});
    const pid_t child = start(arguments);
    const auto has_begun = [&] { return read_file(file("stderr")).find(verb.begun) != std::string::npos; };
    for (int tries = 0; tries < 6000 && !has_begun(); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(has_begun()) << verb.rows;
    kill(child, SIGINT);
    EXPECT_EQ(finish(child).code, 130) << verb.rows;
    const Json json = Json::parse(read_file(file("out.json")));
    EXPECT_GE(json.at(verb.rows).size(), 1u);
    EXPECT_TRUE(!json.contains("instances") || json.at("instances").is_null()) << "the last of all";
  }
}

TEST_F(Interface, InterruptLeavesNoHalfFile) {
  const pid_t child =
      start({"generate", "city", "--objects", "400000", "--triangles", "40000000", "-o", file("big.glb"), "--quiet"});
  const auto has_part = [&] {
    for (const auto& entry : std::filesystem::directory_iterator(file("")))
      if (entry.path().extension() == ".part") return true;
    return false;
  };
  bool part = false;
  for (int tries = 0; tries < 6000 && !part && kill(child, 0) == 0 && !std::filesystem::exists(file("big.glb"));
       ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    part = has_part();
  }
  kill(child, SIGINT);
  const Outcome outcome = finish(child);
  if (std::filesystem::exists(file("big.glb")))
    GTEST_SKIP() << "SKIPPED: the file was written before it could be interrupted";
  EXPECT_EQ(outcome.code, 1000 + SIGINT) << outcome.err;
  EXPECT_TRUE(part);
  EXPECT_FALSE(has_part());
}

}  // namespace
}  // namespace sightline::cli_test
