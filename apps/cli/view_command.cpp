// The options of sightline view.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_view_verb(CLI::App& app, ViewerOptions& options) {
  add_scene(app, options.scene);
  add_text(app, "--method", "NAME[:KEY=VALUE]...[,...]", "methods that M goes through; see sightline list",
           "occlusion_masked and others",
           [&options](const std::string& text) { options.methods = parse_names("--method", text); });
  add_view(app, options.view);
  add_output(app, "--screenshot", "draw one picture without a display and end, .png", options.screenshot, ".png");
  app.add_option("--press", options.press, "with --screenshot: keys to press before, e.g. CVF")
      ->type_name("KEYS")
      ->needs("--screenshot");
  add_text(app, "--click", "X,Y", "with --screenshot: the pixel to click, 0,0 is the top left one", "",
           [&options](const std::string& text) { options.click = parse_pixel("--click", text); })
      ->needs("--screenshot");
  add_common(app, options.common);
  app.get_option("--json")->needs("--screenshot");
  app.footer(
      "Keys: W A S D E X fly, drag orbits (right button: turns), wheel; F frame, O overview, C freeze culling, V "
      "verdicts, B "
      "bounds, Z depth,\nQ queries, M method, N P space path, click explains, ? help, Esc quits.\n\n"
      "Examples:\n  sightline view city.glb\n"
      "  sightline view generate:city --method gl_chcpp --screenshot city.png --press CV");
}

}  // namespace

Verb view_command(CLI::App& app) {
  return add_verb(app, "view", "fly through a scene in a window and see what is culled", add_view_verb, run_view);
}

}  // namespace sightline::cli
