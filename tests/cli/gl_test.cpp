// Verbs that reach OpenGL, and what they do where there is none; the measure of visibility persistence.
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "cli/program.hpp"
#include "line_plot.hpp"
#include "methods.hpp"
#include "persistence_measure.hpp"

namespace sightline::cli {
namespace {

class GlProgram : public cli_test::ProgramTest {};

bool there_is_gl() {
  for (const Algorithm& row : all_algorithms())
    if (row.name.starts_with("gl_")) return true;
  return false;
}

TEST_F(GlProgram, WalkKnowsTheMethodsAndWritesATrace) {
  if (!there_is_gl()) GTEST_SKIP() << "built without OpenGL";
  const auto outcome = run({"walk", "generate:city:objects=200", "--method", "frustum_linear,gl_frustum,gl_chcpp",
                            "--frames", "4", "--size", "96x54", "--trace", file("trace.json"), "--json", "-"});
  if (outcome.code == 4) GTEST_SKIP() << "NO OPENGL HERE: " << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_NE(json.dump().find("gl_chcpp"), std::string::npos);
  const auto trace = nlohmann::json::parse(cli_test::read_file(file("trace.json")));
  EXPECT_GT(trace.at("traceEvents").size(), 8u);
}

TEST_F(GlProgram, MethodsOnTheDeviceSeeObjectsWhereTheyAreNow) {
  if (!there_is_gl()) GTEST_SKIP() << "built without OpenGL";
  const auto outcome = run({"walk", "generate:city:objects=200", "--method", "gl_frustum,occlusion_masked,gl_chcpp",
                            "--frames", "4", "--size", "96x54", "--moving", "1", "--json", "-"});
  if (outcome.code == 4) GTEST_SKIP() << "NO OPENGL HERE: " << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = outcome.json();
  for (const auto& run : json.at("runs")) {
    EXPECT_EQ(run.at("summary").at("missed"), 0) << run.at("method");
    EXPECT_EQ(run.at("summary").at("made_anew"), run.at("method") != "occlusion_masked");
  }
  expect_complaint({"walk", "generate:city:objects=50", "--method", "gl_chcpp", "--moving", "1", "--trace", "t.json"},
                   2, "--moving");
}

TEST_F(GlProgram, WithoutADriverThereIsOneLineAndCodeFour) {
  if (!there_is_gl()) GTEST_SKIP() << "built without OpenGL";
  setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
  expect_complaint({"walk", "generate:city:objects=50", "--method", "gl_chcpp", "--frames", "1"}, 4, "OpenGL");
  expect_complaint({"queries"}, 4, "OpenGL");
  // Beside others its row is skipped, with a warning.
  const auto outcome =
      run({"walk", "generate:city:objects=50", "--method", "frustum_linear,gl_chcpp", "--frames", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("gl_chcpp: skipped: "), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out.find("gl_chcpp"), std::string::npos) << outcome.out;
  unsetenv("__EGL_VENDOR_LIBRARY_DIRS");
}

TEST_F(GlProgram, AnOldOpenGLIsOneLineAndCodeFour) {
  if (!there_is_gl()) GTEST_SKIP() << "built without OpenGL";
  const std::vector<std::string> walk{"walk", "generate:city:objects=50", "--method", "gl_chcpp", "--frames", "1"};
  if (const auto probe = run(walk); probe.code == 4) GTEST_SKIP() << "NO OPENGL HERE: " << probe.err;
  setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
  if (run(walk).code == 0) {
    unsetenv("MESA_GL_VERSION_OVERRIDE");
    GTEST_SKIP() << "this driver cannot be made to look old";
  }
  expect_complaint(walk, 4, "4.5");
  unsetenv("MESA_GL_VERSION_OVERRIDE");
}

TEST_F(GlProgram, AMissingExtensionSkipsTheMethodsThatNeedIt) {
  if (!there_is_gl()) GTEST_SKIP() << "built without OpenGL";
  const std::vector<std::string> walk{"walk", "generate:city:objects=50", "--method", "gl_hzb", "--frames", "1"};
  if (const auto probe = run(walk); probe.code == 4) GTEST_SKIP() << "NO OPENGL HERE: " << probe.err;
  setenv("MESA_EXTENSION_OVERRIDE", "-GL_ARB_indirect_parameters", 1);
  if (run(walk).code == 0) {
    unsetenv("MESA_EXTENSION_OVERRIDE");
    GTEST_SKIP() << "this driver cannot be made to lose an extension";
  }
  expect_complaint(walk, 4, "GL_ARB_indirect_parameters");
  const auto outcome =
      run({"walk", "generate:city:objects=50", "--method", "gl_raster,gl_chcpp", "--frames", "1", "--size", "64x36"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("gl_raster: skipped: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("gl_chcpp"), std::string::npos) << outcome.out;
  unsetenv("MESA_EXTENSION_OVERRIDE");
}

TEST_F(GlProgram, TraceNeedsAMethodThatHasATimeline) {
  expect_complaint({"walk", "generate:city:objects=50", "--method", "frustum_linear", "--frames", "1", "--trace",
                    file("trace.json")},
                   2, "--trace");
}

TEST_F(GlProgram, QueriesGivesARowForEachBunch) {
  const auto outcome =
      run({"queries", "--queries", "64", "--size", "64x64", "--json", "-", "--picture", file("q.svg")});
  if (outcome.code == 4) GTEST_SKIP() << "NO OPENGL HERE: " << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto rows = outcome.json().at("rows");
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows.front().at("bunch"), 1);
  EXPECT_EQ(rows.back().at("bunch"), 4096);
  for (const auto& row : rows) EXPECT_GT(row.at("per_second").get<double>(), 0.0);
  EXPECT_TRUE(cli_test::read_file(file("q.svg")).starts_with("<svg"));
}

TEST_F(GlProgram, QueriesOfASceneCountsStateChanges) {
  const auto outcome = run({"queries", "--scene", "generate:city:objects=600", "--frames", "12", "--size", "160x90",
                            "--json", "-", "--picture", file("s.svg")});
  if (outcome.code == 4) GTEST_SKIP() << "NO OPENGL HERE: " << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto methods = outcome.json().at("methods");
  ASSERT_EQ(methods.size(), 3u);
  std::array<int, 3> changes{};
  for (std::size_t m = 0; m < 3; ++m) {
    ASSERT_EQ(methods[m].at("state_changes").size(), 12u);
    for (const auto& n : methods[m].at("state_changes")) changes[m] += n.get<int>();
  }
  EXPECT_GT(changes[1], 0);
  EXPECT_LT(changes[2], changes[1] / 4);  // batches
  EXPECT_NE(cli_test::read_file(file("s.svg")).find("gl_chcpp"), std::string::npos);
  expect_complaint({"queries", "--frames", "3"}, 2, "--scene");
}

TEST_F(GlProgram, QueriesInterruptedKeepsWhatIsThere) {
  struct Long {
    std::vector<std::string> words;
    const char* rows;
    std::size_t all;
  };
  const Long verbs[] = {
      {{"queries", "--queries", "10000", "--size", "64x64"}, "rows", 7},
      {{"queries", "--scene", "generate:city:objects=300", "--frames", "3000", "--size", "64x36"}, "methods", 3}};
  for (const auto& [words, rows, all] : verbs) {
    std::filesystem::remove(file("stderr"));
    std::vector<std::string> arguments = words;
    arguments.insert(arguments.end(), {"--json", file("out.json"), "--picture", file("q.svg"), "--progress", "json"});
    const pid_t child = start(arguments);
    const auto has_begun = [&] {
      const std::string told = cli_test::read_file(file("stderr"));
      return told.find("\"done\":", told.find("\"done\":0,") + 1) != std::string::npos ||
             told.find("OpenGL") != std::string::npos;
    };
    for (int tries = 0; tries < 6000 && !has_begun(); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    kill(child, SIGINT);
    const auto outcome = finish(child);
    if (outcome.code == 4) GTEST_SKIP() << "NO OPENGL HERE: " << outcome.err;
    EXPECT_EQ(outcome.code, 130) << rows << outcome.err;
    const auto json = nlohmann::json::parse(cli_test::read_file(file("out.json")));
    EXPECT_GE(json.at(rows).size(), 1u);
    EXPECT_LT(json.at(rows).size(), all) << rows;
    EXPECT_TRUE(cli_test::read_file(file("q.svg")).starts_with("<svg"));
  }
}

TEST_F(GlProgram, PersistenceMeasuresAndFits) {
  const auto outcome = run({"persistence", "generate:city:objects=400", "--frames", "30", "--size", "96x54", "--json",
                            "-", "--picture", file("p.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json.at("t").size(), 50u);
  EXPECT_GT(json.at("I")[0].get<int>(), json.at("I")[10].get<int>());
  for (const auto& p : json.at("p"))
    if (!p.is_null()) {
      EXPECT_LE(p.get<double>(), 1.0);
    }
  EXPECT_NE(cli_test::read_file(file("p.svg")).find("0.99 - 0.7"), std::string::npos);
}

VisibleSet set_of(std::size_t universe, std::initializer_list<ObjectId> ids) {
  VisibleSet set(universe);
  for (const ObjectId id : ids) set.insert(id);
  return set;
}

TEST(PersistenceMeasure, CountsRunsOfHiddenFrames) {
  Persistence persistence(3, 4);
  const VisibleSet all = VisibleSet::all(3);
  persistence.frame(all, set_of(3, {0}));                // 1 and 2 hidden for one frame
  persistence.frame(all, set_of(3, {0, 1}));             // 1 comes into sight, 2 stays hidden
  persistence.frame(set_of(3, {0, 1}), set_of(3, {0}));  // 2 leaves the frustum: neither kept nor lost
  EXPECT_EQ(persistence.hidden(), (std::vector<std::uint64_t>{4, 1, 0, 0}));
  EXPECT_EQ(persistence.observed(), (std::vector<std::uint64_t>{2, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(persistence.keep()[0], 0.5);
  EXPECT_LT(persistence.keep()[1], 0.0);
}

TEST(PersistenceMeasure, FitFindsTheCurveItWasMadeFrom) {
  for (const auto [a, b, c] : {std::array{0.99, 0.7, 1.0}, std::array{0.95, 0.3, 0.2}, std::array{0.999, 0.5, 3.0}}) {
    std::vector<double> keep;
    for (int t = 1; t <= 50; ++t) keep.push_back(a - b * std::exp(-c * t));
    const PersistenceFit fit = fit_persistence(keep, std::vector<std::uint64_t>(50, 100));
    ASSERT_TRUE(fit.valid);
    EXPECT_NEAR(fit.a, a, 1e-4);
    EXPECT_NEAR(fit.b, b, 1e-2 * b);
    EXPECT_NEAR(fit.c, c, 1e-2 * c);
    EXPECT_LT(fit.error, 1e-5);
  }
  EXPECT_FALSE(fit_persistence({0.5, -1.0}, {3, 0}).valid);
}

TEST(LinePlot, IsAnSvgWithItsCurves) {
  const LinePlot plot{
      "a < b", "x", "y", true, 0, 0, {{"one", {{1, 2}, {2, 4}, {4, 3}}, false}, {"two", {{1, 1}}, true}}};
  const std::string svg = svg_of(plot);
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
  EXPECT_NE(svg.find("<circle"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg_of({"", "", "", false, 0, 0, {}}).find("nan"), std::string::npos);
}

}  // namespace
}  // namespace sightline::cli
