// What each verb is asked to do, as plain values: main.cpp fills them from the command line, the verbs read them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "occlusion_picture.hpp"
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

/// How the program tells how far it is, on standard error.
enum class ProgressKind {
  automatic,  // a bar where that is a terminal
  json,       // a JSON object a line, for programs
  none
};

/// Options that every verb has.
struct CommonOptions {
  int threads = 0;         // 0: as many as the machine has
  std::uint64_t seed = 1;  // of generated scenes and paths
  std::string json;        // file for the result as JSON, "-" for standard output, empty for none
  bool quiet = false;      // no progress, no warnings, no tables
  bool strict = false;     // warnings about the scene file are errors
  ProgressKind progress = ProgressKind::automatic;
  // Set by main:
  std::string command;        // the command line as a person would type it again
  bool stdout_taken = false;  // an output goes to standard output

  /// Whether a person wants to read tables there.
  [[nodiscard]] bool prints() const { return !quiet && !stdout_taken; }
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
  std::string path;  // a file, "stress", "camera", "camera:NAME", or empty for a generated walk
  int frames = 120;
};

/// One view: an eye, or a frame of a path.
struct ViewOptions {
  std::optional<glm::dvec3> eye;
  glm::dvec3 look{0.0, 0.0, -1.0};
  PathOptions path;
  int frame = 0;
  CameraOptions camera;
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
  int samples = 1;      // n x n oracle samples for each pixel
  std::string report;   // folder for the report page, empty for none
  std::string trace;    // file for the timeline of a method that runs on a device, empty for none
  double moving = 0.0;  // share of the objects that move from frame to frame, 0 to 1
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
  std::string scene;    // count state changes on a walk through it instead, empty for no
  PathOptions path{"", 60};
};

struct RenderOptions {
  CommonOptions common;
  std::string scene;
  std::string method = "zbuffer";  // a renderer of the registry, or "oracle"
  std::string against;             // another one: pixels that differ are counted and shown red; empty for none
  Show show = Show::shaded;
  ViewOptions view;
  std::string output;
};

struct ViewerOptions {
  CommonOptions common;
  std::string scene;
  std::vector<std::string> methods;  // empty: the usual ones
  ViewOptions view;
  std::string screenshot;  // file of a picture, empty: a window
  std::string press;       // keys pressed before the picture
  std::optional<std::pair<int, int>> click;
};

struct ExplainOptions {
  CommonOptions common;
  std::string scene;
  std::string method = "occlusion_masked";
  std::string object;  // an id or a name
  ViewOptions view;
  int samples = 1;     // n x n oracle samples for each pixel
  int random = 0;      // so many random pairs of object and view instead of one
  std::string output;  // picture, empty for none
};

struct CompareOptions {
  CommonOptions common;
  std::string scene;
  std::vector<std::string> methods{"all"};
  PathOptions path;
  CameraOptions camera;
  int samples = 1;     // n x n oracle samples for each pixel
  std::string report;  // folder for the report page, empty for none
};

struct OccludersOptions {
  CommonOptions common;
  std::string scene;
  std::string output;        // .glb, empty for none
  std::uint64_t budget = 0;  // triangles, each instance counted; 0: a tenth of the scene's
  bool whole = false;        // one occluder in world space
  bool solids = true;        // also boxes inside of closed meshes
  bool report = false;       // measure along the path
  std::string picture;       // .png, empty for none
  OcclusionShow show = OcclusionShow::occluders;
  std::optional<glm::dvec3> eye;  // of the picture; the first view of the path if absent
  glm::dvec3 look{0.0, 0.0, -1.0};
  PathOptions path;
  CameraOptions camera;
};

struct RasterReportOptions {
  CommonOptions common;
  RenderOptions render;  // scene and view
  int instances = 36;    // per axis, of the built-in scene of instances; 0 leaves it out
  std::string output;    // folder for plots and pictures, empty for none
};

struct FacesOptions {
  CommonOptions common;
  std::string scene;
  std::vector<std::string> methods;  // face cullers; empty for all of the registry
  PathOptions path{"", 12};
  CameraOptions camera;
  // Pictures, empty for none: a normal mask, a culling volume, the plots of 18.11 and 19.17.
  std::string mask, volume, mask_speed, cluster_speed;
};

struct BoundsOptions {
  CommonOptions common;
  std::string scene;
  PathOptions path{"", 24};
  CameraOptions camera;
};

struct DetailOptions {
  CommonOptions common;
  std::string scene;
  std::string method = "detail:pixels=25";
  PathOptions path{"", 24};
  CameraOptions camera;
  std::string output;  // pair of pictures of the frame with the most lost pixels, empty for none
};

struct SigmaOptions {
  CommonOptions common;
  std::string scene;
  std::string method = "occlusion_masked";  // gets tight=S
  std::vector<double> sigmas{1.0, 1.1, 1.2, 1.4, 1.6, 2.0, 3.0, 5.0};
  PathOptions path{"", 24};
  CameraOptions camera;
  std::string output;  // picture of the boxes at the sigma of 24.06, empty for none
  std::string plot;    // the plot of 24.07, empty for none
};

struct StructuresOptions {
  CommonOptions common;
  std::string scene;                 // or "example": the two-dimensional one of the slides
  std::vector<std::string> methods;  // names of tracers; empty for all
  std::uint32_t rays = 100000;       // of each kind
  std::string plot;                  // SVG file of the figures, empty for none
  std::string cells;                 // SVG file of quadtree and kd-tree seen from above, empty for none
  std::string octree;                // SVG file of an octree, empty for none
};

}  // namespace sightline::cli
