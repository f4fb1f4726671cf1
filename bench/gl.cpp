// bench_gl [--scene SCENE] [--frames N] [--size WxH] [--methods A,B] [--check N] [--check-only] [--path stress]:
// culling through OpenGL. Processor time of the whole process per frame (on llvmpipe that is drawing and all), medians
// over a walk, every method in turn on each view, their ratios ("by frame": the median of the frames' ratios); of it
// the part that is not drawing: what remains when the time to draw the same objects untold is taken away; queries,
// state changes, waits and triangles beside it. Every method is checked first: a picture that differs from that of
// drawing everything ends the program with 1.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "gl/compare.hpp"
#include "gl/registry.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"

namespace {

using namespace sightline;

struct Options {
  std::vector<std::string> scenes;
  std::vector<std::string> methods;
  std::string path;
  int frames = 60, check = 12, width = 1280, height = 720;
  bool check_only = false, flat = false;
};

double process_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

Scene open(const std::string& text) {
  if (!text.starts_with("generate:")) return load_scene(text).scene;
  const MethodSpec spec = parse_method(text.substr(9));
  ParameterReader reader(spec);
  std::string objects = "20000", triangles = "0", seed = "1";
  reader.read("objects", objects);
  reader.read("triangles", triangles);
  reader.read("seed", seed);
  reader.finish();
  return generate_scene(spec.name,
                        {static_cast<std::uint32_t>(std::stoul(objects)), std::stoull(triangles), std::stoull(seed)});
}

CameraPath walk(const Scene& scene, const Options& options) {
  PathConfig config;
  config.frames = options.frames;
  config.prototype.width = options.width;
  config.prototype.height = options.height;
  config.prototype.far = 4.0 * static_cast<double>(glm::length(scene.bounds().extent()));
  return options.path == "stress" ? stress_path(scene, config) : generate_path(scene, config);
}

/// Median way from view to view, metres.
double step_of(const CameraPath& path) {
  std::vector<double> steps{0.0};
  for (std::size_t i = 1; i < path.views.size(); ++i)
    steps.push_back(glm::length(path.views[i].eye - path.views[i - 1].eye));
  std::sort(steps.begin(), steps.end());
  return steps[steps.size() / 2];
}

struct Row {
  std::string name;
  std::unique_ptr<gl::Method> method;
  gl::Work work;
  std::vector<double> milliseconds, deciding;
};

template <class Action>
double milliseconds_of(const Action& action) {
  glFinish();
  const double start = process_seconds();
  action();
  glFinish();
  return 1e3 * (process_seconds() - start);
}

/// The number of frames in which some method's picture is wrong.
int check(gl::SceneDrawing& drawing, const std::vector<std::string>& names, const CameraPath& path, int frames) {
  int wrong = 0;
  gl::Comparison comparison(drawing);
  std::vector<std::unique_ptr<gl::Method>> methods;
  for (const std::string& name : names) methods.push_back(gl::make_method(name, drawing));
  const auto count = std::min<std::size_t>(path.views.size(), static_cast<std::size_t>(frames));
  for (std::size_t v = 0; v < count; ++v) {
    comparison.draw_all(path.views[v], v % 8 != 0);  // at times with all that the frustum leaves out
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (names[m].find("threshold") != std::string::npos) continue;
      const std::uint64_t pixels = comparison.differing_pixels(*methods[m], path.views[v]);
      if (pixels == 0) continue;
      ++wrong;
      std::printf("WRONG: %s differs in %llu pixels of frame %zu: %s\n", names[m].c_str(),
                  static_cast<unsigned long long>(pixels), v, describe(path.views[v]).c_str());
    }
  }
  return wrong;
}

void time_all(gl::SceneDrawing& drawing, std::vector<Row>& rows, const CameraPath& path) {
  gl::Target target;
  std::vector<ObjectId> drawn;
  for (const View& view : path.views)
    for (Row& row : rows) {
      drawing.set_work(&row.work);
      row.method->prepare(view, nullptr);
      row.milliseconds.push_back(milliseconds_of([&] { row.method->frame(view, target); }));
      row.method->drawn(drawn);  // methods on the device count what they drew when they are asked
      if (row.work.queries == 0) continue;
      drawing.set_work(nullptr);
      row.deciding.push_back(row.milliseconds.back() - milliseconds_of([&] {
                               drawing.begin(view, target);
                               drawing.draw(drawn);
                             }));
    }
  drawing.set_work(nullptr);
}

const Row* find_row(const std::vector<Row>& rows, const char* name) {
  for (const Row& row : rows)
    if (row.name == name) return &row;
  return nullptr;
}

/// Ratio of the medians; 0 without one of them.
double ratio(const Row* a, const Row* b) {
  return a == nullptr || b == nullptr ? 0.0 : median(a->milliseconds) / median(b->milliseconds);
}

/// Median over the frames of a / b, frame by frame: walks have cheap and expensive stretches, and the medians of two
/// methods may lie in different ones. 0 without one of them.
double median_ratio(const Row* a, const Row* b) {
  if (a == nullptr || b == nullptr) return 0.0;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a->milliseconds.size(); ++i) ratios.push_back(a->milliseconds[i] / b->milliseconds[i]);
  return median(ratios);
}

void print(const std::vector<Row>& rows, std::size_t frames) {
  const Row *frustum = find_row(rows, "gl_frustum"), *optimal = find_row(rows, "gl_optimal");
  std::printf("%-40s %9s %9s %9s %9s %9s %8s %8s %8s %7s %7s %8s %10s\n", "method", "CPU ms", "deciding", "frustum/",
              "/optimal", "by frame", "queries", "multi", "boxes", "switch", "waits", "objects", "triangles");
  for (const Row& row : rows) {
    const auto per_frame = [&](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(frames); };
    std::printf("%-40s %9.2f %9.2f %9.2f %9.2f %9.2f %8.1f %8.1f %8.1f %7.1f %7.1f %8.1f %10.0f\n", row.name.c_str(),
                median(row.milliseconds), median(row.deciding), ratio(frustum, &row), ratio(&row, optimal),
                median_ratio(&row, optimal), per_frame(row.work.queries), per_frame(row.work.multiqueries),
                per_frame(row.work.query_boxes), per_frame(row.work.state_changes), per_frame(row.work.blocking_waits),
                per_frame(row.work.objects), per_frame(row.work.triangles));
  }
}

int measure(gl::Context& context, const std::string& name, const Options& options) {
  const Scene scene = open(name);
  const CameraPath path = walk(scene, options);
  gl::SceneDrawing drawing(context, scene, {.lit = !options.flat});
  std::printf("\n%s: %zu objects, %.2f M triangles, %zu frames of %dx%d, a step %.2f m\n", name.c_str(),
              scene.objects().size(), 1e-6 * static_cast<double>(scene.triangle_count()), path.views.size(),
              options.width, options.height, step_of(path));
  if (check(drawing, options.methods, path, options.check) > 0) return 1;
  std::printf("%d frames of %zu methods checked: every picture is that of drawing everything, bit by bit\n",
              std::min(options.check, options.frames), options.methods.size());
  if (options.check_only) return 0;
  std::vector<Row> rows;
  for (const std::string& method : options.methods)
    rows.push_back({method, gl::make_method(method, drawing), {}, {}, {}});
  time_all(drawing, rows, path);
  print(rows, path.views.size());
  return 0;
}

Options read(int count, char** arguments) {
  Options options;
  const auto next = [&](int& i) {
    if (i + 1 >= count) throw InputError(std::string("a value is missing after ") + arguments[i]);
    return std::string(arguments[++i]);
  };
  for (int i = 1; i < count; ++i) {
    const std::string word = arguments[i];
    if (word == "--scene")
      options.scenes.push_back(next(i));
    else if (word == "--methods")
      options.methods = split(next(i), ',');
    else if (word == "--path")
      options.path = next(i);
    else if (word == "--frames")
      options.frames = std::stoi(next(i));
    else if (word == "--check")
      options.check = std::stoi(next(i));
    else if (word == "--flat")
      options.flat = true;
    else if (word == "--check-only")
      options.check_only = true;
    else if (word == "--size") {
      const auto size = split(next(i), 'x');
      options.width = std::stoi(size.at(0));
      options.height = std::stoi(size.at(1));
    } else if (!word.starts_with("--benchmark_"))
      throw InputError("unknown option " + word);
  }
  if (options.methods.empty())
    for (const gl::GlAlgorithm& algorithm : gl::algorithms()) options.methods.emplace_back(algorithm.row.name);
  if (options.scenes.empty())
    options.scenes = {"generate:city:objects=20000:triangles=12000000", "generate:forest:objects=2000",
                      "generate:plant:objects=20000",
                      std::string(SIGHTLINE_SOURCE_DIR) + "/../shared/scenes/medical-clinic/medical-clinic.glb"};
  return options;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const Options options = read(count, arguments);
    gl::Context context;
    std::printf("%s\n", context.description().c_str());
    int result = 0;
    for (const std::string& scene : options.scenes) try {
        result = std::max(result, measure(context, scene, options));
      } catch (const InputError& error) {
        std::printf("\nskipped: %s\n", error.what());
      }
    return result;
  } catch (const gl::Unavailable& error) {
    std::printf("bench_gl: skipped: %s\n", error.what());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_gl: %s\n", error.what());
    return 2;
  }
}
