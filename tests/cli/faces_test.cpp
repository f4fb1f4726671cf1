// faces, bounds and sigma: their tables as JSON, their pictures, their complaints.
#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

using Json = nlohmann::json;

class Faces : public ProgramTest {};

TEST_F(Faces, SharesAndExperiments) {
  const Outcome outcome = run({"faces", "generate:plant:objects=80", "--frames", "3", "--mask", file("mask.png"),
                               "--volume", file("volume.png"), "--mask-speed", file("masks.svg"), "--cluster-speed",
                               file("clusters.svg"), "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_EQ(json.at("schema"), "sightline.faces/1");
  EXPECT_GT(json.at("meshes").at("solid").at("meshes"), 0);
  EXPECT_GT(json.at("back_facing"), 0.2);
  EXPECT_LT(json.at("back_facing"), 0.8);
  ASSERT_GE(json.at("rows").size(), 4u);
  for (const Json& row : json.at("rows")) {
    EXPECT_GE(row.at("found"), 0.0);
    EXPECT_LE(row.at("found"), 1.001) << row.at("method");
  }
  EXPECT_GT(json.at("rows")[0].at("found"), 0.9);
  EXPECT_EQ(json.at("rows")[0].at("found"), json.at("rows")[1].at("found"));  // scalar and SIMD
  EXPECT_EQ(json.at("rotated_frames").size(), 4u);
  EXPECT_GE(json.at("sweep").size(), 5u);
  for (const char* picture : {"mask.png", "volume.png"}) EXPECT_EQ(read_file(file(picture)).substr(1, 3), "PNG");
  for (const char* plot : {"masks.svg", "clusters.svg"}) {
    const std::string svg = read_file(file(plot));
    EXPECT_EQ(svg.find("<svg"), 0u);
    EXPECT_NE(svg.find("scalar"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
  }
  EXPECT_NE(run({"faces", "generate:soup:objects=20", "--frames", "1"}).out.find("solid"), std::string::npos);
}

TEST_F(Faces, BoundsTable) {
  const Outcome outcome = run({"bounds", "generate:plant:objects=120", "--frames", "4", "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  double hull = 0, sphere = 0;
  for (const Json& row : json.at("rows")) {
    EXPECT_EQ(row.at("missed"), 0) << row.at("bound");
    EXPECT_GE(row.at("volume"), 0.999) << row.at("bound");
    EXPECT_GE(row.at("area"), 0.999) << row.at("bound");
    if (row.at("bound") == "convex hull") hull = row.at("false_visible");
    if (row.at("bound") == "sphere") sphere = row.at("false_visible");
  }
  EXPECT_LE(hull, sphere);
  EXPECT_NE(run({"bounds", "generate:city:objects=30", "--frames", "1"}).out.find("26-dop"), std::string::npos);
}

TEST_F(Faces, SigmaSweep) {
  const Outcome outcome = run({"sigma", "generate:plant:objects=200", "--frames", "3", "--size", "320x180", "--sigma",
                               "1,1.4,3", "-o", file("boxes.png"), "--plot", file("sigma.svg"), "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json rows = outcome.json().at("rows");
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("missed"), 0);
    if (i == 0) continue;
    EXPECT_LE(rows[i].at("false_visible"), rows[i - 1].at("false_visible"));
    EXPECT_GE(rows[i].at("boxes_per_object"), rows[i - 1].at("boxes_per_object"));
  }
  EXPECT_EQ(rows[0].at("boxes_per_object"), 1.0);
  EXPECT_EQ(read_file(file("boxes.png")).substr(1, 3), "PNG");
  EXPECT_NE(read_file(file("sigma.svg")).find("false-visible"), std::string::npos);
}

TEST_F(Faces, SigmaSweepsEveryOcclusionCuller) {
  for (const char* method : {"occlusion_masked", "occlusion_horizon", "occlusion_hzb", "occlusion_hom:block=8",
                             "occlusion_map", "occlusion_virtual:step=1"}) {
    const Outcome outcome = run({"sigma", "generate:building:objects=400", "--frames", "6", "--size", "320x180",
                                 "--sigma", "1,1.4", "--method", method, "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << method << ": " << outcome.err;
    const Json rows = outcome.json().at("rows");
    EXPECT_LE(rows[1].at("reported"), rows[0].at("reported")) << method;
    EXPECT_GT(rows[1].at("queries"), rows[0].at("queries")) << method;
  }
}

TEST_F(Faces, WalkTellsLostPixels) {
  const Outcome outcome =
      run({"walk", "generate:city:objects=400", "--frames", "4", "--size", "320x180", "--method", "detail:pixels=500"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;  // approximate: no broken promise
  EXPECT_NE(outcome.out.find("pixels lost a frame"), std::string::npos) << outcome.out;
}

TEST_F(Faces, DetailCountsLostPixels) {
  const Outcome outcome = run({"detail", "generate:city:objects=400", "--frames", "3", "--size", "160x90", "--method",
                               "detail:pixels=300", "-o", file("pair.png"), "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_LT(json.at("drawn"), json.at("in_frustum"));
  EXPECT_GT(json.at("lost_pixels"), 0.0);
  EXPECT_LT(json.at("lost_pixels"), json.at("covered_pixels"));
  EXPECT_EQ(read_file(file("pair.png")).substr(1, 3), "PNG");
}

TEST_F(Faces, Complaints) {
  expect_complaint({"faces", "generate:city:objects=9", "--method", "frustum_linear"}, 2, "face culler");
  expect_complaint({"faces", "generate:city:objects=9", "--method", "normal_mask:n=40"}, 2, "normal_mask");
  expect_complaint({"sigma", "generate:city:objects=9", "--sigma", "0.5"}, 2, "--sigma");
  expect_complaint({"sigma", "generate:city:objects=9", "--method", "frustum_linear"}, 2, "tight");
  expect_complaint({"sigma", "generate:city:objects=9", "--method", "occlusion_wide"}, 2, "occlusion_wide");
  expect_complaint({"bounds", file("none.glb")}, 3, "none.glb");
}

}  // namespace
}  // namespace sightline::cli_test
