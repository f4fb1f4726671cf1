// The options of sightline structures.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_structures(CLI::App& app, StructuresOptions& options) {
  app.add_option(
         "SCENE", options.scene,
         "a scene file, generate:KIND[:objects=N][:triangles=N][:seed=N], or example: the plane one of the slides")
      ->required();
  add_text(app, "--structure", "NAME[,NAME]...", "which", "all",
           [&options](const std::string& text) { options.methods = parse_names("--structure", text); });
  add_whole(app, "--rays", "rays of each kind", options.rays, 1, 100'000'000);
  add_output(app, "--plot", "write the figures as a picture, .svg", options.plot, ".svg");
  add_output(app, "--cells", "write quadtree and kd-tree seen from above, .svg", options.cells, ".svg");
  add_output(app, "--octree", "write an octree of three generations, .svg", options.octree, ".svg");
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline structures castle.glb --plot structures.svg\n"
      "  sightline structures castle.glb --structure bvh8,kdtree,grid --rays 1000000\n"
      "  sightline structures example --cells quadtree_kdtree.svg");
}

}  // namespace

Verb structures_command(CLI::App& app) {
  return add_verb(app, "structures", "compare the structures that rays are traced through", add_structures,
                  run_structures);
}

}  // namespace sightline::cli
