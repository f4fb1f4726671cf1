// raster-report, and what render shows of the rasterisers' work.
#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

class RasterReport : public ProgramTest {};

TEST_F(RasterReport, MeasuresAndDraws) {
  const std::string folder = file("report").string();
  const Outcome outcome = run({"raster-report", "generate:city:objects=150", "--size", "320x180", "--frames", "2",
                               "--instances", "3", "-o", folder, "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json json = outcome.json();
  EXPECT_EQ(json["schema"], "sightline.raster-report/1");
  for (const char* scene : {"overdraw", "instances"}) {
    EXPECT_TRUE(json[scene]["same_image"]) << scene;
    EXPECT_LE(json[scene]["hierarchical"]["writes_per_covered_pixel"].get<double>(),
              json[scene]["plain"]["writes_per_covered_pixel"].get<double>());
    EXPECT_GE(json[scene]["hierarchical"]["writes_per_covered_pixel"].get<double>(), 1.0);
  }
  // E8: the slide's words make 104.9 MB a frame and 6.3 GB/s at 60 Hz; 18 GB/s takes 172 Hz.
  EXPECT_NEAR(json["bandwidth"][0]["megabytes_per_frame"].get<double>(), 104.9, 0.05);
  EXPECT_NEAR(json["bandwidth"][0]["gigabytes_per_second"].get<double>(), 6.3, 0.01);
  EXPECT_NEAR(json["bandwidth"][1]["frames_per_second"].get<double>(), 172, 0.5);
  EXPECT_NEAR(json["bandwidth"][2]["frames_per_second"].get<double>(), 78, 0.5);
  // 6.08, E10: simulated in the pipeline.
  for (const auto& row : json["harmonic"]) {
    EXPECT_NEAR(row["random"].get<double>() / row["harmonic"].get<double>(), 1.0, 0.12) << row["n"];
    EXPECT_EQ(row["front_to_back"].get<double>(), 1.0);
    EXPECT_EQ(row["back_to_front"].get<double>(), row["n"].get<double>());
  }
  // 4.06: after a pre-pass the program runs as often in every order.
  const auto& early = json["early_z"];
  EXPECT_EQ(early["random"]["depth_pre_pass"]["program_runs"],
            early["back_to_front"]["depth_pre_pass"]["program_runs"]);
  EXPECT_LE(early["random"]["depth_pre_pass"]["program_runs"], early["random"]["early_tests"]["program_runs"]);
  EXPECT_LE(early["random"]["early_tests"]["program_runs"], early["random"]["late_tests"]["program_runs"]);
  // E9: three ways of counting the same layers; rays see surfaces at one depth as one. The seen one lies before the
  // rest.
  const auto& complexity = json["complexity"];
  const double a = complexity["a_intersections_per_ray"], b = complexity["b_polygons_per_pixel"];
  EXPECT_EQ(complexity["c_visible_if_transparent"].get<double>(), b);
  EXPECT_LE(a, 1.02 * b);
  EXPECT_GT(a, 0.7 * b);
  EXPECT_LE(complexity["d_polygons_behind"].get<double>(), b - 1.0);
  EXPECT_GT(complexity["d_polygons_behind"].get<double>(), 0.7 * (b - 1.0));
  EXPECT_LT(complexity["e_depth_tests_back_faces_culled"].get<double>(), b);
  // Drawn and predicted distances of z-fighting agree where the format is coarse against the rounding of corners.
  for (const auto& row : json["fighting"]) {
    if (row["format"] == "unorm16" || row["format"] == "unorm20") {
      EXPECT_NEAR(row["measured_metres"].get<double>() / row["predicted_metres"].get<double>(), 1.0, 0.06);
    }
    EXPECT_GT(row["half_lost_metres"].get<double>(), row["measured_metres"].get<double>());
  }
  EXPECT_GT(json["traffic"]["all"]["gain"].get<double>(), json["traffic"]["fast_clear"]["gain"].get<double>());
  EXPECT_GT(json["compression"]["ratio"].get<double>(), json["compression"]["first_order_dpcm"].get<double>());
  for (const char* name :
       {"overdraw.svg", "orders.svg", "compression.svg", "traffic.svg", "early_z.svg", "just_noticeable.svg",
        "overdraw_plain.png", "overdraw_hierarchical.png", "tiles.png", "instances_plain.png", "stencil_mask.png",
        "csg.png", "dissolve.png", "two_sided.png", "blending_orders.png", "colour_filters.png", "glass.png"})
    EXPECT_GT(read_file(std::filesystem::path(folder) / name).size(), 200u) << name;
}

TEST_F(RasterReport, ComplainsInOneLine) {
  expect_complaint({"raster-report", "generate:city:objects=20", "--instances", "-1"}, 2, "--instances");
  expect_complaint({"raster-report", file("none.glb").string()}, 3, "none.glb");
  expect_complaint(
      {"render", "generate:city:objects=20", "--method", "oracle", "--show", "overdraw", "-o", file("x.png").string()},
      2, "overdraw");
}

TEST_F(RasterReport, RenderShowsTheWork) {
  for (const char* method : {"zbuffer", "zbuffer_tiled", "hzb"})
    for (const char* show : {"colour", "depth", "overdraw", "tiles", "stencil"}) {
      const std::string picture = file(std::string(method) + show + ".png").string();
      const Outcome outcome = run({"render", "generate:city:objects=100", "--size", "200x100", "--frames", "2",
                                   "--method", method, "--show", show, "--quiet", "-o", picture});
      EXPECT_EQ(outcome.code, 0) << method << " " << show << outcome.err;
      EXPECT_GT(read_file(picture).size(), 200u) << method << " " << show;
    }
}

}  // namespace
}  // namespace sightline::cli_test
