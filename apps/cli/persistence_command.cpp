// The options of sightline persistence.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_persistence(CLI::App& app, PersistenceOptions& options) {
  add_scene(app, options.scene);
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_whole(app, "--longest", "frames up to which p(t) is measured", options.longest, 3, 10'000);
  add_output(app, "--picture", "write the curves as a picture, .svg", options.picture, ".svg");
  add_common(app, options.common);
  app.footer(
      "I(t): objects hidden for at least t frames; p(t): the share of those hidden for t frames that stay hidden.\n\n"
      "Examples:\n  sightline persistence generate:city:objects=5000 --frames 500 --size 640x360\n"
      "  sightline persistence plant.glb --picture persistence.svg --json persistence.json");
}

}  // namespace

Verb persistence_command(CLI::App& app) {
  return add_verb(app, "persistence", "how long what is hidden stays hidden", add_persistence, run_persistence);
}

}  // namespace sightline::cli
