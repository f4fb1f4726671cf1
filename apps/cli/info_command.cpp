// The options of sightline info.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_info(CLI::App& app, InfoOptions& options) {
  add_scene(app, options.scene);
  add_common(app, options.common);
  app.footer("Examples:\n  sightline info city.glb\n  sightline info generate:city:objects=20000 --json -");
}

}  // namespace

Verb info_command(CLI::App& app) { return add_verb(app, "info", "what a scene holds", add_info, run_info); }

}  // namespace sightline::cli
