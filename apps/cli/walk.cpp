// sightline walk: a culler along a camera path, each frame checked against the truth.
#include <fmt/format.h>

#include <optional>
#include <string>

#include "camera.hpp"
#include "interrupt.hpp"
#include "methods.hpp"
#include "output.hpp"
#include "report.hpp"
#include "scene_argument.hpp"
#include "verbs.hpp"
#include "walk_json.hpp"
#include "walk_loop.hpp"
#include "walk_table.hpp"

namespace sightline::cli {
namespace {

/// Unknown methods are told before a large scene is loaded.
void check_methods(const WalkOptions& options) {
  for (const std::string& method : options.methods)
    as_usage([&] { (void)find_method(parse_method(method).name, Family::culler); });
}

WalkReport start_report(const WalkOptions& options, const Scene& scene) {
  WalkReport report;
  report.scene_name = options.scene;
  report.command = options.common.command;
  report.scene = &scene;
  report.width = options.camera.width;
  report.height = options.camera.height;
  report.samples = options.samples;
  report.verified = options.verify;
  return report;
}

void print_text(const WalkReport& report, const WalkOptions& options) {
  // With the JSON on standard output the verdict is still worth a line where it does not disturb.
  const bool aside = options.common.stdout_taken;
  if (aside && options.common.quiet) return;
  if (!aside && !options.common.quiet) fmt::print("{}", walk_table(report));
  if (const std::optional<double> moving = move_ms_median(report))
    fmt::print(aside ? stderr : stdout,
               "{} objects move: median {:.3f} ms a frame to move them and to refit the index\n", report.moving,
               *moving);
  const bool colour = !aside && stdout_has_colour();
  for (const WalkRun& run : report.runs) {
    const WalkSummary summary = summarise(report, run);
    const char* shade = summary.missed == 0u ? "\x1b[32m" : summary.broken_promise ? "\x1b[31m" : "\x1b[33m";
    const std::string line =
        fmt::format("{}{}{}\n", colour ? shade : "", verdict_line(report, run), colour ? "\x1b[0m" : "");
    if (aside)
      tell(line);
    else
      fmt::print("{}", line);
  }
}

}  // namespace

int run_walk(const WalkOptions& options) {
  check_methods(options);
  catch_interrupts();
  if (!options.report.empty()) prepare_report(options.report);  // first: the other files may lie in its folder
  std::optional<OutputFile> json;
  if (!options.common.json.empty()) json.emplace(options.common.json);
  std::optional<OutputFile> trace;
  if (!options.trace.empty()) trace.emplace(options.trace);
  if (trace && options.moving > 0)
    throw UsageError("--trace and --moving: methods with a timeline are made anew when objects move, and forget it");

  LoadedScene loaded = open_scene(options.scene, options.common);
  const CameraPath path = open_path(options.path, options.camera, loaded, options.common.seed);
  WalkScene scene(loaded.scene, options.moving, options.common.seed, options.verify || !options.report.empty());

  WalkReport report = start_report(options, loaded.scene);
  report.warnings = loaded.warnings;
  walk_frames(options, scene, path.views, report);

  if (json) {
    write_walk_json(report, options.ids, [&](std::string_view text) { json->write(text); });
    json->commit();
  }
  if (trace) {
    trace->write(report.trace);
    trace->commit();
  }
  print_text(report, options);
  if (!options.report.empty()) {
    report.pictures = draw_pictures(report, scene);
    write_report(report, options.report);
  }
  return exit_code(report);
}

}  // namespace sightline::cli
