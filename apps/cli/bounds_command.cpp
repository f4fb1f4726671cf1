// The options of sightline bounds.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_bounds(CLI::App& app, BoundsOptions& options) {
  add_scene(app, options.scene);
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_common(app, options.common);
  app.footer("Examples:\n  sightline bounds city.glb\n  sightline bounds generate:plant --frames 50 --json -");
}

}  // namespace

Verb bounds_command(CLI::App& app) {
  return add_verb(app, "bounds", "bounding volumes compared: tightness, memory, cost, false-visible share", add_bounds,
                  run_bounds);
}

}  // namespace sightline::cli
