// The options of sightline render.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_render(CLI::App& app, RenderOptions& options) {
  add_scene(app, options.scene);
  app.add_option("--method", options.method, "a renderer, see sightline list; or oracle")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--against", options.against,
                 "compare with this renderer, or oracle: pixels with another object are red")
      ->type_name("NAME");
  add_text(app, "--show", "colour|depth|object|normal|overdraw|tiles|stencil", "what the picture shows", "shaded",
           [&options](const std::string& text) {
             const std::array<std::pair<std::string_view, Show>, 8> kinds{{{"depth", Show::depth},
                                                                           {"object", Show::object},
                                                                           {"normal", Show::normal},
                                                                           {"shaded", Show::shaded},
                                                                           {"colour", Show::shaded},
                                                                           {"overdraw", Show::overdraw},
                                                                           {"tiles", Show::tiles},
                                                                           {"stencil", Show::stencil}}};
             const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == text; });
             if (kind == kinds.end())
               throw UsageError(fmt::format(
                   "--show: '{}' is not colour, depth, object, normal, shaded, overdraw, tiles or stencil", text));
             options.show = kind->second;
           });
  add_view(app, options.view);
  add_output(app, "-o,--output", "the file to write, .png", options.output, ".png")->required();
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline render city.glb --eye 0,1.7,0 --look 1,0,0 -o view.png\n"
      "  sightline render city.glb --method oracle --show depth --path viewpoints.txt --frame 12 -o depth.png");
}

}  // namespace

Verb render_command(CLI::App& app) {
  return add_verb(app, "render", "draw one view as a picture", add_render, run_render);
}

}  // namespace sightline::cli
