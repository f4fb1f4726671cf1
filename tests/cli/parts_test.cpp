// Parts of the program that cannot be reached with honest methods from outside: verdicts on answers that miss
// something, and what keeps the data of a report inside of its script.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base64.hpp"
#include "report.hpp"
#include "walk_json.hpp"
#include "walk_report.hpp"

namespace sightline::cli {
namespace {

Mesh triangles(std::vector<glm::uvec3> indices) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = std::move(indices);
  return mesh;
}

/// Two frames of a scene with four triangles in two objects; the second frame misses object 1.
struct Fixture {
  Scene scene;
  WalkReport report;

  explicit Fixture(Promise promise) {
    SceneBuilder builder;
    const MeshId mesh = builder.add_mesh(triangles({{0, 1, 2}, {2, 1, 0}}));
    for (int i = 0; i < 2; ++i) builder.add_object(mesh, identity_affine(), "</script><!--");
    scene = builder.build();
    report.scene = &scene;
    report.verified = true;
    report.views.resize(2);
    for (std::size_t i = 0; i < 2; ++i) {
      report.views[i].frame = i;
      report.views[i].truth = 2;
    }
    WalkRun run;
    run.method = "test";
    run.promise = promise;
    run.answers.resize(2);
    run.answers[0].visible = 2;
    run.answers[0].triangles_submitted = 4;
    run.answers[0].cull_ms = 3.0;
    run.answers[1].visible = 1;
    run.answers[1].triangles_submitted = 2;
    run.answers[1].cull_ms = 1.0;
    run.answers[1].missed = {1};
    report.runs.push_back(run);
  }
};

TEST(WalkVerdict, MissingAnObjectBreaksAPromise) {
  for (const Promise promise : {Promise::exact, Promise::conservative, Promise::conservative_continuous}) {
    const Fixture fixture(promise);
    const WalkSummary summary = summarise(fixture.report, fixture.report.runs[0]);
    EXPECT_EQ(summary.missed, 1u);
    EXPECT_EQ(summary.verdict, "missed");
    EXPECT_DOUBLE_EQ(summary.overestimate.value(), 0.75);
    EXPECT_DOUBLE_EQ(summary.triangles_fraction.value(), 0.75);
    EXPECT_DOUBLE_EQ(summary.cull_ms_median.value(), 2.0);
    EXPECT_EQ(exit_code(fixture.report), exit_missed);
    EXPECT_NE(verdict_line(fixture.report, fixture.report.runs[0]).find("first object 1 in frame 1"),
              std::string::npos);
  }
}

TEST(WalkVerdict, AnApproximationMayMiss) {
  const Fixture fixture(Promise::approximate);
  EXPECT_EQ(summarise(fixture.report, fixture.report.runs[0]).verdict, "approximate: 1 missed");
  EXPECT_EQ(exit_code(fixture.report), exit_ok);
}

TEST(WalkVerdict, WhatLiesBetweenPixelCentresIsNoBrokenPromise) {
  Fixture fixture(Promise::conservative);
  fixture.report.runs[0].answers[1].unpromised = 1;
  EXPECT_EQ(summarise(fixture.report, fixture.report.runs[0]).verdict, "ok at pixel centres: 1 missed");
  EXPECT_EQ(exit_code(fixture.report), exit_ok);
  fixture.report.runs[0].answers[1].missed = {0, 1};
  EXPECT_EQ(exit_code(fixture.report), exit_missed);
}

TEST(WalkVerdict, MissedWinsOverInterrupted) {
  Fixture fixture(Promise::exact);
  fixture.report.interrupted = true;
  EXPECT_EQ(exit_code(fixture.report), exit_missed);
  fixture.report.runs[0].answers[1].missed.clear();
  EXPECT_EQ(exit_code(fixture.report), exit_interrupted);
}

TEST(WalkJson, NamesCannotLeaveTheScript) {
  const Fixture fixture(Promise::exact);
  std::string text;
  write_walk_json(fixture.report, true, [&](std::string_view piece) { text += piece; });
  ASSERT_NE(text.find("</script"), std::string::npos);
  const std::string safe = script_safe(text);
  EXPECT_EQ(safe.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(safe), nlohmann::json::parse(text));
}

TEST(WalkJson, NamesThatAreNoTextAreReplaced) {
  SceneBuilder builder;
  const MeshId mesh = builder.add_mesh(triangles({{0, 1, 2}}));
  builder.add_object(mesh, identity_affine(), "\xff\"\n\x01");
  const Scene scene = builder.build();
  WalkReport report;
  report.scene = &scene;
  report.runs.resize(1);
  std::string text;
  write_walk_json(report, true, [&](std::string_view piece) { text += piece; });
  EXPECT_EQ(nlohmann::json::parse(text).at("objects")[0].at("name"), "\xEF\xBF\xBD\"\n\x01");
}

TEST(Base64, MatchesTheExamplesOfTheStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace sightline::cli
