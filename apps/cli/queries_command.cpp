// The options of sightline queries.
#include <tuple>

#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_queries(CLI::App& app, QueriesOptions& options) {
  add_text(app, "--size", "WxH", "pixels of the picture", "1280x720", [&options](const std::string& text) {
    std::tie(options.width, options.height) = parse_size("--size", text);
  });
  add_whole(app, "--queries", "queries of a round", options.boxes, 1, 1'000'000);
  add_output(app, "--picture", "write the curves as a picture, .svg", options.picture, ".svg");
  CLI::Option* scene =
      app.add_option("--scene", options.scene, "count state changes of three methods on a walk through it instead");
  add_path(app, options.path);
  for (const char* name : {"--path", "--frames"}) app.get_option(name)->needs(scene);
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline queries\n  sightline queries --picture queries.svg --json queries.json\n"
      "  sightline queries --scene generate:city:objects=5000 --frames 60 --picture state_changes.svg");
}

}  // namespace

Verb queries_command(CLI::App& app) {
  return add_verb(app, "queries", "occlusion queries a second, by the size of their bunches", add_queries, run_queries);
}

}  // namespace sightline::cli
