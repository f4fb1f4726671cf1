// The options of sightline generate.
#include "command.hpp"
#include "scene_argument.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_generate(CLI::App& app, GenerateOptions& options) {
  app.add_option("KIND", options.kind, "a generator; see sightline list")->required();
  add_whole(app, "--objects", "about so many objects", options.objects, 1, most_objects);
  add_whole(app, "--triangles", "about so many triangles over all objects; 0 for what the kind finds natural",
            options.triangles, 0, most_triangles);
  add_output(app, "-o,--output", "the file to write, .glb", options.output, ".glb")->required();
  add_common(app, options.common);
  app.footer("Examples:\n  sightline generate city --objects 20000 --seed 3 -o city.glb");
}

}  // namespace

Verb generate_command(CLI::App& app) {
  return add_verb(app, "generate", "write a generated scene", add_generate, run_generate);
}

}  // namespace sightline::cli
