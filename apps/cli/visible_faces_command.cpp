// The options of sightline visible-faces.
#include "command.hpp"
#include "query_options.hpp"

namespace sightline::cli {
namespace {

void add_visible_faces(CLI::App& app, VisibleFacesOptions& options) {
  add_scene(app, options.scene);
  app.add_option("--cameras", options.cameras, "cameras as JSON: intrinsics and pose, see docs/visible_faces.md")
      ->type_name("FILE")
      ->required();
  app.add_flag("--samples", options.samples, "write the pixels through which each face is seen, not yes or no");
  add_text(app, "--extra-points", "0|1|4", "points for a face that no pixel centre falls on", "4",
           [&options](const std::string& text) {
             if (text != "0" && text != "1" && text != "4")
               throw UsageError("--extra-points: '" + text + "' is not 0, 1 or 4");
             options.extra_points = text[0] - '0';
           });
  add_output(app, "-o,--output", "the file to write: .npy, .csv or .json", options.output)->required();
  add_common(app, options.common);
  app.footer(
      "Faces are numbered by object, then triangle. .npy: an array (cameras, faces) of bool, or uint32 with "
      "--samples.\n"
      "Examples:\n  sightline visible-faces scan.ply --cameras cameras.json -o faces.npy\n"
      "  sightline visible-faces building.glb --cameras cameras.json --samples -o faces.csv");
}

}  // namespace

Verb visible_faces_command(CLI::App& app) {
  return add_verb(app, "visible-faces", "which faces each of many cameras sees", add_visible_faces, run_visible_faces);
}

}  // namespace sightline::cli
