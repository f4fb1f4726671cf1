// The options of sightline explain.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

constexpr std::uint64_t most_pairs = 10'000'000;

void add_explain(CLI::App& app, ExplainOptions& options) {
  options.view.path.frames = 50;
  add_scene(app, options.scene);
  CLI::Option* object =
      app.add_option("--object", options.object, "the object: its id, or its name if no other has it")->type_name("ID");
  app.add_option("--method", options.method, "the culler that is asked, see sightline list")
      ->type_name("NAME[:KEY=VALUE]...")
      ->capture_default_str();
  add_view(app, options.view);
  add_whole(app, "--samples", "look with N x N rays for each pixel", options.samples, 1, most_samples);
  CLI::Option* picture =
      add_output(app, "-o,--output",
                 "a picture of the view, .png: the object outlined, what is seen of it green, what covers it tinted",
                 options.output, ".png");
  add_whole(app, "--random", "explain N random objects in the views of the path and count", options.random, 1,
            most_pairs)
      ->default_str("")
      ->excludes(object)
      ->excludes(picture)
      ->excludes(app.get_option("--eye"));
  add_common(app, options.common);
  app.footer(
      "Every answer is checked by a second run of the rays before it is printed.\n\n"
      "Exit codes: 0 all is well, 1 the object is seen but was culled, 2 usage, 3 bad input, 4 internal.\n\n"
      "Examples:\n  sightline explain city.glb --eye 0,1.7,0 --look 1,0,0 --object 812\n"
      "  sightline explain city.glb --path viewpoints.txt --frame 12 --object church -o why.png\n"
      "  sightline explain city.glb --random 1000");
}

}  // namespace

Verb explain_command(CLI::App& app) {
  return add_verb(app, "explain", "why an object is seen or culled", add_explain, run_explain);
}

}  // namespace sightline::cli
