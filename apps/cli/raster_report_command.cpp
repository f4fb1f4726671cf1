// The options of sightline raster-report.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_raster_report(CLI::App& app, RasterReportOptions& options) {
  add_scene(app, options.render.scene);
  add_view(app, options.render.view);
  add_whole(app, "--instances", "spheres per axis of the built-in scene of instances; 0 leaves it out",
            options.instances, 0, 100);
  add_output(app, "-o,--output", "folder for plots (SVG) and pictures (PNG)", options.output)->type_name("DIR");
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline raster-report generate:city:objects=2000 -o out/raster\n"
      "  sightline raster-report building.glb --eye 0,1.7,0 --look 1,0,0 --instances 0 --json -");
}

}  // namespace

Verb raster_report_command(CLI::App& app) {
  return add_verb(app, "raster-report", "depth complexity, overdraw, early z, depth tiles: what rasterising costs",
                  add_raster_report, run_raster_report);
}

}  // namespace sightline::cli
