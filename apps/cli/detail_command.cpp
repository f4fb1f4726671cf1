// The options of sightline detail.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_detail(CLI::App& app, DetailOptions& options) {
  add_scene(app, options.scene);
  app.add_option("--method", options.method, "the culler, detail with parameters")
      ->type_name("NAME[:KEY=VALUE]...")
      ->capture_default_str();
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_output(app, "-o,--output", "picture of the worst frame, off and on, .png", options.output, ".png");
  add_common(app, options.common);
  app.footer("Examples:\n  sightline detail generate:city:objects=20000 --method detail:pixels=100 -o pair.png");
}

}  // namespace

Verb detail_command(CLI::App& app) {
  return add_verb(app, "detail", "detail culling: what it drops and the pixels that are lost", add_detail, run_detail);
}

}  // namespace sightline::cli
