// The options of sightline raster-report.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_raster_report(CLI::App& app, RasterReportOptions& options) {
  RenderOptions& view = options.render;
  add_scene(app, view.scene);
  CLI::Option* eye = add_text(app, "--eye", "X,Y,Z", "where the eye is, metres", "",
                              [&view](const std::string& text) { view.eye = parse_vector("--eye", text); });
  add_text(app, "--look", "DX,DY,DZ", "where it looks", "0,0,-1", [&view](const std::string& text) {
    view.look = parse_vector("--look", text);
    if (view.look == glm::dvec3(0.0)) throw UsageError("--look: the direction has no length");
  })->needs(eye);
  add_path(app, view.path);
  add_whole(app, "--frame", "which view of the path, from 0", view.frame, 0, most_frames);
  add_camera(app, view.camera);
  add_whole(app, "--instances", "spheres per axis of the built-in scene of instances; 0 leaves it out",
            options.instances, 0, 100);
  app.add_option("-o,--output", options.output, "folder for plots (SVG) and pictures (PNG)")->type_name("DIR");
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
