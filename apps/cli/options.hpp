// What each verb is asked to do, as plain values: main.cpp fills them from the command line, the verbs read them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "picture.hpp"

namespace sightline::cli {

/// The exit codes of the program.
enum ExitCode : int {
  exit_ok = 0,
  exit_missed = 1,
  exit_usage = 2,
  exit_bad_input = 3,
  exit_internal = 4,
  exit_interrupted = 130
};

/// A command line that makes no sense; what() is one line. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Options that every verb has.
struct CommonOptions {
  int threads = 0;         // 0: as many as the machine has
  std::uint64_t seed = 1;  // of generated scenes and paths
  std::string json;        // file for the result as JSON, "-" for standard output, empty for none
  bool quiet = false;      // no progress, no warnings, no tables
  std::string command;     // the command line as a person would type it again; set by main

  [[nodiscard]] bool json_to_stdout() const { return json == "-"; }
};

/// How a view is made where its path leaves it open.
struct CameraOptions {
  int width = 1280, height = 720;  // pixels
  double fov = 60.0;               // full vertical angle, degrees
  std::optional<double> near;      // metres; from the size of the scene if absent
  std::optional<double> far;       // metres, may be infinite; far enough for the scene if absent
  std::optional<double> ortho;     // height of an orthographic image, metres; perspective if absent
};

/// Where the views come from.
struct PathOptions {
  std::string path;  // a file, "stress", or empty for a generated walk
  int frames = 120;
};

struct InfoOptions {
  CommonOptions common;
  std::string scene;
};

struct ListOptions {
  CommonOptions common;
  bool markdown = false;
};

struct GenerateOptions {
  CommonOptions common;
  std::string kind;
  std::uint32_t objects = 1000;
  std::uint64_t triangles = 0;
  std::string output;
};

struct WalkOptions {
  CommonOptions common;
  std::string scene;
  std::vector<std::string> methods{"occlusion_masked"};
  PathOptions path;
  CameraOptions camera;
  bool ids = false;
  bool verify = true;
  int samples = 1;     // n x n oracle samples for each pixel
  std::string report;  // folder for the report page, empty for none
  std::string trace;   // file for the timeline of a method that runs on a device, empty for none
};

struct PersistenceOptions {
  CommonOptions common;
  std::string scene;
  PathOptions path{{}, 300};
  CameraOptions camera;
  int longest = 50;     // frames
  std::string picture;  // plot as .svg, empty for none
};

struct QueriesOptions {
  CommonOptions common;
  int width = 1280, height = 720;
  int boxes = 4096;     // queries of a round
  std::string picture;  // plot as .svg, empty for none
};

struct RenderOptions {
  CommonOptions common;
  std::string scene;
  std::string method = "zbuffer";  // a renderer of the registry, or "oracle"
  Show show = Show::shaded;
  std::optional<glm::dvec3> eye;
  glm::dvec3 look{0.0, 0.0, -1.0};
  PathOptions path;
  int frame = 0;
  CameraOptions camera;
  std::string output;
};

}  // namespace sightline::cli
