// The options of sightline walk.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_walk(CLI::App& app, WalkOptions& options) {
  add_scene(app, options.scene);
  add_text(app, "--method", "NAME[:KEY=VALUE]...[,...]", "cullers to compare; see sightline list",
           options.methods.front(),
           [&options](const std::string& text) { options.methods = parse_names("--method", text); });
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_whole(app, "--samples", "check N x N rays for each pixel", options.samples, 1, most_samples);
  add_text(app, "--moving", "SHARE", "that many of the objects move from frame to frame, 0 to 1; which ones: --seed",
           "0", [&options](const std::string& text) { options.moving = parse_share("--moving", text); });
  app.add_flag("--ids", options.ids, "JSON: add the visible ids and the matrix of each frame, and the objects");
  app.add_flag_callback("--no-verify", [&options] { options.verify = false; }, "do not compare with the truth");
  add_output(app, "--report", "write a page with the result to DIR/index.html", options.report)->type_name("DIR");
  add_output(app, "--trace", "timeline of the first gl_ method, for chrome://tracing; .svg: the last frame",
             options.trace);
  add_common(app, options.common);
  app.footer(
      "Exit codes: 0 nothing visible was missed, 1 something was, 2 usage, 3 bad input, 4 internal, 130 "
      "interrupted.\n\n"
      "Examples:\n  sightline walk city.glb\n"
      "  sightline walk generate:city:objects=20000:seed=3 --method frustum_linear,occlusion_masked --frames 60\n"
      "  sightline walk city.glb --moving 0.2 --method frustum_linear,occlusion_horizon\n"
      "  sightline walk ship.glb --path viewpoints.txt --json walk.json --ids --report report");
}

}  // namespace

Verb walk_command(CLI::App& app) {
  return add_verb(app, "walk", "cull along a camera path and check against the truth", add_walk, run_walk);
}

}  // namespace sightline::cli
