// sightline raster-report: tables and plots of what rasterising a view costs (checklist 27.06-27.08, 27.10).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "camera.hpp"
#include "heat_picture.hpp"
#include "json_output.hpp"
#include "plot.hpp"
#include "raster_measures.hpp"
#include "raster_pictures.hpp"
#include "scene_argument.hpp"
#include "sightline/scene/generate/raster_scenes.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

/// The readable pipeline draws about a million triangles a second.
constexpr std::uint64_t most_pipeline_triangles = 5'000'000;

void write_file(const std::string& folder, const std::string& name, const std::string& bytes) {
  OutputFile file(std::filesystem::path(folder) / name);
  file.write(bytes);
  file.commit();
}

void write_heat(const std::string& folder, const std::string& name, const Frame& frame) {
  write_file(folder, name,
             encode_png(paint_counts(frame.width, frame.height, std::span<const std::uint32_t>(frame.writes),
                                     most_layers_shown)));
}

std::vector<std::pair<double, double>> column(const Json& rows, const char* key) {
  std::vector<std::pair<double, double>> points;
  for (const Json& row : rows) points.emplace_back(row["n"].get<double>(), row[key].get<double>());
  return points;
}

void write_plots(const std::string& folder, const Json& json) {
  const Json& rows = json["harmonic"];
  write_file(folder, "overdraw.svg",
             line_chart("Colour writes per pixel, n triangles in random order", "depth complexity n", "writes",
                        {{"simulated", column(rows, "random")},
                         {"H(n)", column(rows, "harmonic")},
                         {"ln n + 0.577", column(rows, "ln_n_plus_gamma")},
                         {"ln n + 0.5 (slide)", column(rows, "ln_n_plus_half")}},
                        true));
  write_file(folder, "orders.svg",
             line_chart("Colour writes per pixel by order of drawing", "depth complexity n", "writes",
                        {{"back to front", column(rows, "back_to_front")},
                         {"random", column(rows, "random")},
                         {"front to back", column(rows, "front_to_back")}}));
  std::vector<std::pair<std::string, double>> bars;
  const Json& histogram = json["compression"]["histogram"];
  for (std::size_t i = 1; i < histogram.size(); ++i) bars.emplace_back(std::to_string(i), histogram[i].get<double>());
  write_file(folder, "compression.svg", bar_chart("Depth tiles by compression ratio (n to n + 1 : 1)", "tiles", bars));
  std::vector<Series> noticeable;
  for (const auto& [key, unused] : json["just_noticeable"][0].items()) {
    if (key == "metres" || key == "unorm20") continue;  // five curves can be told apart
    Series series{key, {}};
    for (const Json& row : json["just_noticeable"])
      series.points.emplace_back(row["metres"].get<double>(), std::max(0.0, -std::log10(row[key].get<double>())));
    noticeable.push_back(std::move(series));
  }
  write_file(folder, "just_noticeable.svg",
             line_chart("Just noticeable depth: digits of the distance", "distance, metres", "-log10 of the share",
                        noticeable, true));
  if (json["traffic"].is_null()) return;
  bars.clear();
  for (const auto& [name, row] : json["traffic"].items()) bars.emplace_back(name, row["gain"].get<double>());
  write_file(folder, "traffic.svg", bar_chart("Depth traffic: gain by feature", "times less", bars));
  bars.clear();
  for (const char* way : {"late_tests", "early_tests", "depth_pre_pass"})
    bars.emplace_back(way, json["early_z"]["random"][way]["program_runs"].get<double>());
  write_file(folder, "early_z.svg", bar_chart("Fragment program runs, random order", "runs", bars));
}

void print_overdraw(const char* title, const Json& row) {
  fmt::print("\n{}: {} triangles, {} pixels covered, images {}\n", title, row["triangles"].get<std::uint64_t>(),
             row["covered_pixels"].get<std::uint64_t>(), row["same_image"].get<bool>() ? "equal" : "DIFFER");
  for (const char* way : {"plain", "hierarchical"})
    fmt::print("  {:<13} {:>9.3f} writes per covered pixel, {:>10} triangles drawn, {:>10.1f} ms\n", way,
               row[way]["writes_per_covered_pixel"].get<double>(), row[way]["triangles_drawn"].get<std::uint64_t>(),
               row[way]["ms"].get<double>());
}

void print_pipeline(const Json& json) {
  fmt::print("\ndepth complexity (per covered pixel)\n");
  for (const auto& [key, value] : json["complexity"].items())
    if (value.is_number_float()) fmt::print("  {:<36} {:.3f}\n", key, value.get<double>());
  for (const auto& [order, row] : json["complexity"]["orders"].items())
    fmt::print("  {:<15} z-tests {:.3f}, z-writes {:.3f}, colour writes {:.3f}\n", order,
               row["depth_tests_per_covered_pixel"].get<double>(), row["depth_writes_per_covered_pixel"].get<double>(),
               row["colour_writes_per_covered_pixel"].get<double>());
  fmt::print("\nearly z: program runs (ms)\n");
  for (const char* order : {"front_to_back", "back_to_front", "random"}) {
    const Json& row = json["early_z"][order];
    fmt::print("  {:<15}", order);
    for (const char* way : {"late_tests", "early_tests", "depth_pre_pass"})
      fmt::print(" {} {} ({:.0f})", way, row[way]["program_runs"].get<std::uint64_t>(), row[way]["ms"].get<double>());
    fmt::print("\n");
  }
  fmt::print("  z only {:.2f} ms, z and ids {:.2f} ms: {:.2f} x\n", json["early_z"]["z_only_ms"].get<double>(),
             json["early_z"]["z_and_ids_ms"].get<double>(), json["early_z"]["z_only_gain"].get<double>());
  fmt::print("  z only with the hierarchy (depth pre-pass) {:.2f} ms: {:.2f} x\n",
             json["early_z"]["z_only_hierarchical_ms"].get<double>(),
             json["early_z"]["hierarchical_pre_pass_gain"].get<double>());
  fmt::print("\ndepth traffic of the two-level z-buffer\n");
  for (const auto& [name, row] : json["traffic"].items())
    fmt::print("  {:<12} {:>12} bytes, gain {:.2f}; tile visits {}, fetched {}\n", name,
               row["bytes"].get<std::uint64_t>(), row["gain"].get<double>(), row["tile_visits"].get<std::uint64_t>(),
               row["fetches"].get<std::uint64_t>());
}

void print_text(const Json& json) {
  print_overdraw("this view", json["overdraw"]);
  if (!json["instances"].is_null()) print_overdraw("instances", json["instances"]);
  const Json& c = json["compression"];
  fmt::print(
      "\ndepth tiles: {} cleared, {} not; ratio {:.2f} (first-order DPCM {:.2f}, second-order {:.2f}), {:.0f} % "
      "of tiles at least 4:1\n",
      c["tiles_cleared"].get<int>(), c["tiles"].get<int>(), c["ratio"].get<double>(),
      c["first_order_dpcm"].get<double>(), c["second_order_dpcm"].get<double>(),
      100 * c["share_at_least_4"].get<double>());
  if (json["complexity"].is_null())
    fmt::print("\nskipped: depth complexity, early z and traffic (more than {} triangles)\n", most_pipeline_triangles);
  else
    print_pipeline(json);
  fmt::print("\ncolour writes in random order: n, simulated, H(n), ln n + 0.5\n");
  for (const Json& row : json["harmonic"])
    fmt::print("  {:>3} {:.3f} {:.3f} {:.3f}\n", row["n"].get<int>(), row["random"].get<double>(),
               row["harmonic"].get<double>(), row["ln_n_plus_half"].get<double>());
  fmt::print("\nbandwidth = width * height * depth complexity * words * 4 * frames per second\n");
  for (const Json& row : json["bandwidth"])
    fmt::print("  {:.0f} * {:.0f} * {:.2f} * {:.0f} * 4 * {:.0f} = {:.2f} GB/s ({})\n", row["width"].get<double>(),
               row["height"].get<double>(), row["depth_complexity"].get<double>(),
               row["words_per_fragment"].get<double>(), row["frames_per_second"].get<double>(),
               row["gigabytes_per_second"].get<double>(), row["case"].get<std::string>());
  fmt::print("\nplanes 1 cm apart fall together from (predicted, first pixel drawn wrong, half of the pixels)\n");
  for (const Json& row : json["fighting"])
    fmt::print("  {:<8} {:>10.2f} m {:>10.2f} m {:>10.2f} m\n", row["format"].get<std::string>(),
               row["predicted_metres"].get<double>(), row["measured_metres"].get<double>(),
               row["half_lost_metres"].get<double>());
}

}  // namespace

int run_raster_report(const RasterReportOptions& options) {
  JsonOutput output(options.common);
  if (!options.output.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.output, error);
    if (error) throw InputError(options.output, "", "cannot make the folder: " + error.message());
  }
  const LoadedScene loaded = open_scene(options.render.scene, options.common);
  const View view = single_view(options.render.view, loaded, options.common.seed);
  Frame plain, hierarchical;
  Json json{{"schema", "sightline.raster-report/1"}, {"scene", options.render.scene}, {"view", describe(view)}};
  json["overdraw"] = measure_overdraw(loaded.scene, view, plain, hierarchical);
  json["instances"] = nullptr;
  if (!options.output.empty()) {
    write_heat(options.output, "overdraw_plain.png", plain);
    write_heat(options.output, "overdraw_hierarchical.png", hierarchical);
    write_file(options.output, "tiles.png", encode_png(paint_tiles(view, plain)));
  }
  json["compression"] = measure_compression(view, plain);
  const bool pipeline = loaded.scene.triangle_count() <= most_pipeline_triangles;
  json["complexity"] = pipeline ? measure_complexity(loaded.scene, view) : Json();
  json["early_z"] = pipeline ? measure_early_z(loaded.scene, view) : Json();
  json["traffic"] = pipeline ? measure_traffic(loaded.scene, view) : Json();
  json["harmonic"] = measure_harmonic(options.common.seed);
  json["bandwidth"] =
      measure_bandwidth(view, pipeline ? json["complexity"]["a_intersections_per_ray"].get<double>() : 0.0);
  json["fighting"] = measure_fighting(view);
  json["just_noticeable"] = measure_just_noticeable(view);
  if (options.instances > 0) {
    const SceneAndView task = instanced_spheres(options.instances);
    json["instances"] = measure_overdraw(task.scene, task.view, plain, hierarchical);
    if (!options.output.empty()) {
      write_heat(options.output, "instances_plain.png", plain);
      write_heat(options.output, "instances_hierarchical.png", hierarchical);
    }
  }
  if (!options.output.empty()) {
    write_plots(options.output, json);
    for (const auto& [name, picture] : raster_pictures())
      write_file(options.output, std::string(name) + ".png", encode_png(picture));
  }
  if (options.common.prints()) print_text(json);
  output.write(json);
  return exit_ok;
}

}  // namespace sightline::cli
