// The options of sightline occluders.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_occluders(CLI::App& app, OccludersOptions& options) {
  add_scene(app, options.scene);
  add_output(app, "-o,--output", "write the occluders as a scene, .glb", options.output, ".glb");
  add_whole(app, "--budget", "most triangles, each instance counted; 0 for a tenth of the scene's", options.budget, 0,
            1'000'000'000);
  app.add_flag("--whole", options.whole, "one occluder in world space, patches grow across objects");
  app.add_flag_callback("--no-solids", [&options] { options.solids = false; }, "surfaces only, no boxes inside");
  app.add_flag("--report", options.report, "measure along a path what the occluders find, against all triangles");
  add_output(app, "--picture", "a picture of one view, .png", options.picture, ".png");
  add_text(app, "--show", "occluders|horizon|overlap", "what the picture shows", "occluders",
           [&options](const std::string& text) {
             if (text == "occluders")
               options.show = OcclusionShow::occluders;
             else if (text == "horizon")
               options.show = OcclusionShow::horizon;
             else if (text == "overlap")
               options.show = OcclusionShow::overlap;
             else
               throw UsageError("--show: '" + text + "' is not occluders, horizon or overlap");
           });
  CLI::Option* eye = add_text(app, "--eye", "X,Y,Z", "where the eye of the picture is, metres", "",
                              [&options](const std::string& text) { options.eye = parse_vector("--eye", text); });
  add_text(app, "--look", "DX,DY,DZ", "where it looks", "0,0,-1", [&options](const std::string& text) {
    options.look = parse_vector("--look", text);
    if (options.look == glm::dvec3(0.0)) throw UsageError("--look: the direction has no length");
  })->needs(eye);
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_common(app, options.common);
  app.footer(
      "The occluders hide nothing that the scene does not hide. occlusion_masked:occluders=auto uses them.\n\n"
      "Exit codes: 0 all is well, 1 something visible was missed (--report), 2 usage, 3 bad input, 4 internal.\n\n"
      "Examples:\n  sightline occluders castle.glb -o occluders.glb --budget 50000\n"
      "  sightline occluders castle.glb --report --frames 60");
}

}  // namespace

Verb occluders_command(CLI::App& app) {
  return add_verb(app, "occluders", "make occluders that lie inside the scene's objects", add_occluders, run_occluders);
}

}  // namespace sightline::cli
