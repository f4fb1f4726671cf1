// The options of sightline faces.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_faces(CLI::App& app, FacesOptions& options) {
  add_scene(app, options.scene);
  add_text(app, "--method", "NAME[:KEY=VALUE]...[,...]", "face cullers to compare; see sightline list", "all",
           [&options](const std::string& text) { options.methods = parse_names("--method", text); });
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_output(app, "--mask", "picture of the normal mask of the first view, .png", options.mask, ".png");
  add_output(app, "--volume", "picture of a cluster and its culling volume, .png", options.volume, ".png");
  add_output(app, "--mask-speed", "plot of normal masks: speed against what they find, .svg", options.mask_speed,
             ".svg");
  add_output(app, "--cluster-speed", "plot of clusters: speed and share found by their number, .svg",
             options.cluster_speed, ".svg");
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline faces generate:city\n"
      "  sightline faces scan.glb --frames 24 --method backface,cluster_backface:leaf=32 --json faces.json");
}

}  // namespace

Verb faces_command(CLI::App& app) {
  return add_verb(app, "faces", "back-face culling: shares found, times, clusters", add_faces, run_faces);
}

}  // namespace sightline::cli
