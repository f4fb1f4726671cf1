// The options of sightline maze.
#include <tuple>

#include "command.hpp"
#include "query_options.hpp"

namespace sightline::cli {
namespace {

void add_maze(CLI::App& app, MazeOptions& options) {
  add_text(app, "--cells", "WxD", "cells of the maze", "31x21", [&options](const std::string& text) {
    std::tie(options.cells_x, options.cells_z) = parse_size("--cells", text);
    if (options.cells_x < 5 || options.cells_z < 5 || options.cells_x > 999 || options.cells_z > 999)
      throw UsageError("--cells: '" + text + "' is not between 5x5 and 999x999");
  });
  add_text(app, "--size", "WxH", "pixels of the picture", "960x600", [&options](const std::string& text) {
    std::tie(options.width, options.height) = parse_size("--size", text);
  });
  add_text(app, "--fov", "DEGREES", "vertical angle of the view, below 180", "55", [&options](const std::string& text) {
    options.fov = parse_positive("--fov", text);
    if (options.fov >= 180.0) throw UsageError("--fov: '" + text + "' is not below 180");
  });
  add_text(app, "--turn", "DEGREES", "where to look: 0 along +x, 90 along +z [along a passage]", "",
           [&options](const std::string& text) {
             options.look = static_cast<double>(parse_whole("--turn", text, 0, 360));
             options.look_given = true;
           });
  app.add_flag("--fisheye", options.fisheye, "leave out the correction of distances, to see what it is for");
  CLI::Option* file = add_output(app, "-o,--output", "the file to write, .png", options.output, ".png");
  app.add_flag("--play", options.play,
               "walk, in a window or without a display in the terminal: w a s d or arrows, q ends")
      ->excludes(file);
  add_common(app, options.common);
  app.get_option("--play")->excludes("--json");
  app.footer(
      "Examples:\n  sightline maze -o maze.png\n  sightline maze --seed 7 --fisheye -o bent.png\n"
      "  sightline maze --play");
}

}  // namespace

Verb maze_command(CLI::App& app) {
  return add_verb(app, "maze", "a maze by column casting, as a picture or to walk in", add_maze, run_maze);
}

}  // namespace sightline::cli
