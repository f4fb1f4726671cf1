// The options of sightline compare.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_compare(CLI::App& app, CompareOptions& options) {
  add_scene(app, options.scene);
  add_text(app, "--methods", "all|software|gl|NAME[:KEY=VALUE]...[,...]",
           "cullers to compare: all, those without or with OpenGL, or by name; see sightline list",
           options.methods.front(),
           [&options](const std::string& text) { options.methods = parse_names("--methods", text); });
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_whole(app, "--samples", "check N x N rays for each pixel", options.samples, 1, most_samples);
  add_output(app, "--report", "write a page with the result to DIR/index.html", options.report)->type_name("DIR");
  add_common(app, options.common);
  app.footer(
      "Every method answers for the same frames; each frame is checked against the truth. The cost model says which\n"
      "stage would limit a frame that draws what the method reports: application, geometry, fill or bus, from counted\n"
      "work and unit costs of the software renderer measured on this machine.\n\n"
      "Exit codes: 0 no promise was broken, 1 one was, 2 usage, 3 bad input, 4 internal, 130 interrupted.\n\n"
      "Examples:\n  sightline compare castle.glb --frames 200 --report out\n"
      "  sightline compare generate:city --methods occlusion_masked,occlusion_horizon --json -");
}

}  // namespace

Verb compare_command(CLI::App& app) {
  return add_verb(app, "compare", "all cullers on the same frames: what they find, lose and cost", add_compare,
                  run_compare);
}

}  // namespace sightline::cli
