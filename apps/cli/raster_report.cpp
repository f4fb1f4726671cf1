// sightline raster-report: tables and plots of what rasterising a view costs (checklist 27.06-27.08, 27.10).
// Interrupted, it tells what has been measured; the rest is null.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "camera.hpp"
#include "heat_picture.hpp"
#include "interrupt.hpp"
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

void plot_harmonic(const std::string& folder, const Json& rows) {
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
}

void plot_just_noticeable(const std::string& folder, const Json& rows) {
  std::vector<Series> noticeable;
  for (const auto& [key, unused] : rows[0].items()) {
    if (key == "metres" || key == "unorm20") continue;  // five curves can be told apart
    Series series{key, {}};
    for (const Json& row : rows)
      series.points.emplace_back(row["metres"].get<double>(), std::max(0.0, -std::log10(row[key].get<double>())));
    noticeable.push_back(std::move(series));
  }
  write_file(folder, "just_noticeable.svg",
             line_chart("Just noticeable depth: digits of the distance", "distance, metres", "-log10 of the share",
                        noticeable, true));
}

/// Of what was measured.
void write_plots(const std::string& folder, const Json& json) {
  std::vector<std::pair<std::string, double>> ratios, gains, runs;
  if (!json["compression"].is_null()) {
    const Json& histogram = json["compression"]["histogram"];
    for (std::size_t i = 1; i < histogram.size(); ++i)
      ratios.emplace_back(std::to_string(i), histogram[i].get<double>());
    write_file(folder, "compression.svg",
               bar_chart("Depth tiles by compression ratio (n to n + 1 : 1)", "tiles", ratios));
  }
  if (!json["early_z"].is_null()) {
    for (const char* way : {"late_tests", "early_tests", "depth_pre_pass"})
      runs.emplace_back(way, json["early_z"]["random"][way]["program_runs"].get<double>());
    write_file(folder, "early_z.svg", bar_chart("Fragment program runs, random order", "runs", runs));
  }
  if (!json["traffic"].is_null()) {
    for (const auto& [name, row] : json["traffic"].items()) gains.emplace_back(name, row["gain"].get<double>());
    write_file(folder, "traffic.svg", bar_chart("Depth traffic: gain by feature", "times less", gains));
  }
  if (!json["harmonic"].is_null()) plot_harmonic(folder, json["harmonic"]);
  if (!json["just_noticeable"].is_null()) plot_just_noticeable(folder, json["just_noticeable"]);
}

void print_overdraw(const char* title, const Json& row) {
  fmt::print("\n{}: {} triangles, {} pixels covered, images {}\n", title, row["triangles"].get<std::uint64_t>(),
             row["covered_pixels"].get<std::uint64_t>(), row["same_image"].get<bool>() ? "equal" : "DIFFER");
  for (const char* way : {"plain", "hierarchical"})
    fmt::print("  {:<13} {:>9.3f} writes per covered pixel, {:>10} triangles drawn, {:>10.1f} ms\n", way,
               row[way]["writes_per_covered_pixel"].get<double>(), row[way]["triangles_drawn"].get<std::uint64_t>(),
               row[way]["ms"].get<double>());
}

void print_complexity(const Json& complexity) {
  fmt::print("\ndepth complexity (per covered pixel)\n");
  for (const auto& [key, value] : complexity.items())
    if (value.is_number_float()) fmt::print("  {:<36} {:.3f}\n", key, value.get<double>());
  for (const auto& [order, row] : complexity["orders"].items())
    fmt::print("  {:<15} z-tests {:.3f}, z-writes {:.3f}, colour writes {:.3f}\n", order,
               row["depth_tests_per_covered_pixel"].get<double>(), row["depth_writes_per_covered_pixel"].get<double>(),
               row["colour_writes_per_covered_pixel"].get<double>());
}

void print_early_z(const Json& early_z) {
  fmt::print("\nearly z: program runs (ms)\n");
  for (const char* order : {"front_to_back", "back_to_front", "random"}) {
    const Json& row = early_z[order];
    fmt::print("  {:<15}", order);
    for (const char* way : {"late_tests", "early_tests", "depth_pre_pass"})
      fmt::print(" {} {} ({:.0f})", way, row[way]["program_runs"].get<std::uint64_t>(), row[way]["ms"].get<double>());
    fmt::print("\n");
  }
  fmt::print("  z only {:.2f} ms, z and ids {:.2f} ms: {:.2f} x\n", early_z["z_only_ms"].get<double>(),
             early_z["z_and_ids_ms"].get<double>(), early_z["z_only_gain"].get<double>());
  fmt::print("  z only with the hierarchy (depth pre-pass) {:.2f} ms: {:.2f} x\n",
             early_z["z_only_hierarchical_ms"].get<double>(), early_z["hierarchical_pre_pass_gain"].get<double>());
}

void print_traffic(const Json& traffic) {
  fmt::print("\ndepth traffic of the two-level z-buffer\n");
  for (const auto& [name, row] : traffic.items())
    fmt::print("  {:<12} {:>12} bytes, gain {:.2f}; tile visits {}, fetched {}\n", name,
               row["bytes"].get<std::uint64_t>(), row["gain"].get<double>(), row["tile_visits"].get<std::uint64_t>(),
               row["fetches"].get<std::uint64_t>());
}

void print_compression(const Json& c) {
  fmt::print(
      "\ndepth tiles: {} cleared, {} not; ratio {:.2f} (first-order DPCM {:.2f}, second-order {:.2f}), {:.0f} % "
      "of tiles at least 4:1\n",
      c["tiles_cleared"].get<int>(), c["tiles"].get<int>(), c["ratio"].get<double>(),
      c["first_order_dpcm"].get<double>(), c["second_order_dpcm"].get<double>(),
      100 * c["share_at_least_4"].get<double>());
}

void print_harmonic(const Json& rows) {
  fmt::print("\ncolour writes in random order: n, simulated, H(n), ln n + 0.5\n");
  for (const Json& row : rows)
    fmt::print("  {:>3} {:.3f} {:.3f} {:.3f}\n", row["n"].get<int>(), row["random"].get<double>(),
               row["harmonic"].get<double>(), row["ln_n_plus_half"].get<double>());
}

void print_bandwidth(const Json& rows) {
  fmt::print("\nbandwidth = width * height * depth complexity * words * 4 * frames per second\n");
  for (const Json& row : rows)
    fmt::print("  {:.0f} * {:.0f} * {:.2f} * {:.0f} * 4 * {:.0f} = {:.2f} GB/s ({})\n", row["width"].get<double>(),
               row["height"].get<double>(), row["depth_complexity"].get<double>(),
               row["words_per_fragment"].get<double>(), row["frames_per_second"].get<double>(),
               row["gigabytes_per_second"].get<double>(), row["case"].get<std::string>());
}

void print_fighting(const Json& rows) {
  fmt::print("\nplanes 1 cm apart fall together from (predicted, first pixel drawn wrong, half of the pixels)\n");
  for (const Json& row : rows)
    fmt::print("  {:<8} {:>10.2f} m {:>10.2f} m {:>10.2f} m\n", row["format"].get<std::string>(),
               row["predicted_metres"].get<double>(), row["measured_metres"].get<double>(),
               row["half_lost_metres"].get<double>());
}

/// Of what was measured.
void print_text(const Json& json) {
  const auto part = [&](const char* name, void (*print)(const Json&)) {
    if (!json[name].is_null()) print(json[name]);
  };
  part("overdraw", [](const Json& row) { print_overdraw("this view", row); });
  part("instances", [](const Json& row) { print_overdraw("instances", row); });
  part("compression", print_compression);
  part("complexity", print_complexity);
  part("early_z", print_early_z);
  part("traffic", print_traffic);
  part("harmonic", print_harmonic);
  part("bandwidth", print_bandwidth);
  part("fighting", print_fighting);
}

struct Measure {
  const char* name;
  std::function<Json()> make;
};

/// One after the other; what an interrupt leaves out is null.
void measure_all(Json& json, const std::vector<Measure>& measures, bool quiet) {
  for (const Measure& measure : measures) json[measure.name] = nullptr;
  Progress progress("measures", measures.size(), quiet);
  std::size_t done = 0;
  for (const Measure& measure : measures) {
    if (interrupted()) break;
    json[measure.name] = measure.make();
    progress.show(++done);
  }
}

}  // namespace

int run_raster_report(const RasterReportOptions& options) {
  catch_interrupts();
  JsonOutput output(options.common);
  if (!options.output.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.output, error);
    if (error) throw InputError(options.output, "", "cannot make the folder: " + error.message());
  }
  const LoadedScene loaded = open_scene(options.render.scene, options.common);
  const View view = single_view(options.render.view, loaded, options.common.seed);
  const bool pipeline = loaded.scene.triangle_count() <= most_pipeline_triangles;
  Frame plain, hierarchical;
  Json json{{"schema", "sightline.raster-report/1"}, {"scene", options.render.scene}, {"view", describe(view)}};
  const auto heat = [&](const std::string& name) {
    if (options.output.empty()) return;
    write_heat(options.output, name + "_plain.png", plain);
    write_heat(options.output, name + "_hierarchical.png", hierarchical);
  };
  measure_all(json,
              {{"overdraw",
                [&] {
                  const Json result = measure_overdraw(loaded.scene, view, plain, hierarchical);
                  heat("overdraw");
                  if (!options.output.empty())
                    write_file(options.output, "tiles.png", encode_png(paint_tiles(view, plain)));
                  return result;
                }},
               {"compression", [&] { return measure_compression(view, plain); }},
               {"complexity", [&] { return pipeline ? measure_complexity(loaded.scene, view) : Json(); }},
               {"early_z", [&] { return pipeline ? measure_early_z(loaded.scene, view) : Json(); }},
               {"traffic", [&] { return pipeline ? measure_traffic(loaded.scene, view) : Json(); }},
               {"harmonic", [&] { return measure_harmonic(options.common.seed); }},
               {"bandwidth",
                [&] {
                  return measure_bandwidth(
                      view, pipeline ? json["complexity"]["a_intersections_per_ray"].get<double>() : 0.0);
                }},
               {"fighting", [&] { return measure_fighting(view); }},
               {"just_noticeable", [&] { return measure_just_noticeable(view); }},
               {"instances",
                [&] {
                  if (options.instances == 0) return Json();
                  const SceneAndView task = instanced_spheres(options.instances);
                  Json result = measure_overdraw(task.scene, task.view, plain, hierarchical);
                  heat("instances");
                  return result;
                }}},
              options.common.quiet);
  if (!options.output.empty()) {
    write_plots(options.output, json);
    if (!interrupted())
      for (const auto& [name, picture] : raster_pictures())
        write_file(options.output, std::string(name) + ".png", encode_png(picture));
  }
  if (options.common.prints()) {
    print_text(json);
    if (!pipeline)
      fmt::print("\nskipped: depth complexity, early z and traffic (more than {} triangles)\n",
                 most_pipeline_triangles);
  }
  output.write(json);
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace sightline::cli
