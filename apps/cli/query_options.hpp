// Options of the verbs that answer questions about faces, lines and trees, and of the maze; and what runs those verbs.
#pragma once

#include "options.hpp"

namespace sightline::cli {

struct VisibleFacesOptions {
  CommonOptions common;
  std::string scene, cameras, output;
  bool samples = false;  // counts instead of yes and no
  int extra_points = 4;
};

struct SightLinesOptions {
  CommonOptions common;
  std::string scene, from, to;  // "x,y,z" or a file of points
  bool pairs = false;           // the i-th with the i-th instead of each with each
  bool glass = false;           // what is not opaque blocks, too
  double margin = 1e-3;         // metres left out at both ends
};

struct BspOptions {
  CommonOptions common;
  std::string scene;  // a scene, or "worked-example"
  std::vector<std::string> splitters{"mixed", "fewest_splits", "balance", "random", "pca"};
  std::uint64_t most_fragments = 20'000'000;
  double most_seconds = 60.0;    // for each tree
  std::string output;            // a picture of a horizontal cut; empty for none
  std::optional<double> height;  // of the cut
  int width = 960;               // of the picture
};

struct BooleanOptions {
  CommonOptions common;
  std::string first, operation, second, output;
};

struct MazeOptions {
  CommonOptions common;
  int cells_x = 31, cells_z = 21;
  int width = 960, height = 600;
  double fov = 55.0;             // vertical, degrees
  double look = 0.0;             // degrees, 0 along +x, turning right
  int start_x = 1, start_z = 1;  // the cell that the eye stands in
  bool look_given = false;
  bool fisheye = false;
  bool play = false;
  std::string output;
};

int run_visible_faces(const VisibleFacesOptions& options);
int run_sight_lines(const SightLinesOptions& options);
int run_bsp(const BspOptions& options);
int run_boolean(const BooleanOptions& options);
int run_maze(const MazeOptions& options);

}  // namespace sightline::cli
