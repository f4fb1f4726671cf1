// The options of sightline sigma.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_sigma(CLI::App& app, SigmaOptions& options) {
  add_scene(app, options.scene);
  app.add_option("--method", options.method, "the culler, one with a parameter tight")
      ->type_name("METHOD")
      ->capture_default_str();
  add_text(app, "--sigma", "S[,S]...", "values to sweep, 1 to 100", "1,1.1,1.2,1.4,1.6,2,3,5",
           [&options](const std::string& text) {
             options.sigmas.clear();
             for (const std::string& word : parse_names("--sigma", text)) {
               options.sigmas.push_back(parse_positive("--sigma", word));
               if (options.sigmas.back() < 1.0 || options.sigmas.back() > 100.0)
                 throw UsageError("--sigma: " + word + " is not between 1 and 100");
             }
           });
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_output(app, "-o,--output", "picture of the tight boxes of the first view, .png", options.output, ".png");
  add_output(app, "--plot", "plot of false-visible share, surface, queries and time, .svg", options.plot, ".svg");
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline sigma castle.glb\n  sightline sigma generate:plant --sigma 1,1.4,2 --json sigma.json");
}

}  // namespace

Verb sigma_command(CLI::App& app) {
  return add_verb(app, "sigma", "tight bounding volumes: false-visible share, surface and time against sigma",
                  add_sigma, run_sigma);
}

}  // namespace sightline::cli
