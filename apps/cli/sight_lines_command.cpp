// The options of sightline sight-lines.
#include "command.hpp"
#include "query_options.hpp"

namespace sightline::cli {
namespace {

void add_sight_lines(CLI::App& app, SightLinesOptions& options) {
  add_scene(app, options.scene);
  app.add_option("--from", options.from, "a point x,y,z, or a file with a point per line")->type_name("A")->required();
  app.add_option("--to", options.to, "a point x,y,z, or a file with a point per line")->type_name("B")->required();
  app.add_flag("--pairs", options.pairs,
               "the first with the first, the second with the second, ... not each with each");
  app.add_flag("--glass", options.glass, "what is not opaque blocks, too");
  add_text(app, "--margin", "METRES", "left out at both ends, so that a point may lie on a surface", "0.001",
           [&options](const std::string& text) {
             options.margin = parse_finite("--margin", text);
             if (options.margin < 0.0) throw UsageError("--margin: '" + text + "' is below 0");
           });
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline sight-lines building.glb --from 1,1.7,2 --to 8,1.7,3\n"
      "  sightline sight-lines city.glb --from towers.txt --to streets.txt --json lines.json");
}

}  // namespace

Verb sight_lines_command(CLI::App& app) {
  return add_verb(app, "sight-lines", "whether points see each other, and what lies between", add_sight_lines,
                  run_sight_lines);
}

}  // namespace sightline::cli
