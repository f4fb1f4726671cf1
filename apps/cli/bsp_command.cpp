// The options of sightline bsp and sightline boolean.
#include <tuple>

#include "command.hpp"
#include "query_options.hpp"
#include "sightline/index/bsp.hpp"

namespace sightline::cli {
namespace {

void add_bsp(CLI::App& app, BspOptions& options) {
  app.add_option("SCENE", options.scene, "a scene file, generate:KIND..., or worked-example")->required();
  add_text(app, "--splitter", "NAMES", "how planes are chosen: " + std::string(bsp_splitter_names),
           "mixed,fewest_splits,balance,random,pca",
           [&options](const std::string& text) { options.splitters = parse_names("--splitter", text); });
  add_whole(app, "--most-fragments", "a tree of more is given up", options.most_fragments, 1, 1'000'000'000);
  add_text(app, "--most-seconds", "SECONDS", "a tree that takes longer is given up", "60",
           [&options](const std::string& text) { options.most_seconds = parse_positive("--most-seconds", text); });
  add_output(app, "-o,--output", "a picture of a horizontal cut through the first tree, .png", options.output, ".png");
  add_text(app, "--height", "METRES", "of the cut [the middle of the scene]", "",
           [&options](const std::string& text) { options.height = parse_finite("--height", text); });
  add_common(app, options.common);
  app.footer("Examples:\n  sightline bsp generate:city:objects=200\n  sightline bsp worked-example -o example.png");
}

void add_boolean(CLI::App& app, BooleanOptions& options) {
  app.add_option("FIRST", options.first, "a scene whose objects bound closed solids that do not overlap")->required();
  app.add_option("OPERATION", options.operation, "union, intersection or difference")->required();
  app.add_option("SECOND", options.second, "another one")->required();
  add_output(app, "-o,--output", "the file to write, .glb", options.output, ".glb")->required();
  add_common(app, options.common);
  app.footer("Examples:\n  sightline boolean house.glb difference rooms.glb -o shell.glb");
}

}  // namespace

Verb bsp_command(CLI::App& app) {
  return add_verb(app, "bsp", "BSP trees of a scene: fragments, depth, time; a picture of their cells", add_bsp,
                  run_bsp);
}

Verb boolean_command(CLI::App& app) {
  return add_verb(app, "boolean", "union, intersection or difference of closed solids", add_boolean, run_boolean);
}

}  // namespace sightline::cli
