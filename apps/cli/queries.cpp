// sightline queries: occlusion queries a second, for bunches of 1 to 4096 (checklist 22.18); or, with a scene, state
// changes by method (22.17). Interrupted, it tells what has been measured.
#include <fmt/format.h>

#include "interrupt.hpp"
#include "json_output.hpp"
#include "line_plot.hpp"
#include "methods.hpp"
#include "state_changes.hpp"
#include "verbs.hpp"
#ifdef SIGHTLINE_HAS_GL
#include <algorithm>
#include <chrono>
#include <ctime>

#include "gl/queries.hpp"
#include "sightline/scene/generate/random.hpp"
#endif

namespace sightline::cli {
namespace {

int run_state_changes(const QueriesOptions& options) {
  JsonOutput output(options.common);
  std::optional<OutputFile> picture;
  if (!options.picture.empty()) picture.emplace(options.picture);
  const Json measured = measure_state_changes(options);
  if (options.common.prints()) {
    fmt::print("{:<20} {:>22} {:>16}\n", "method", "state changes a frame", "queries a frame");
    for (const Json& method : measured.at("methods")) {
      double sums[2] = {0.0, 0.0};
      for (const Json& n : method.at("state_changes")) sums[0] += n.get<double>();
      for (const Json& n : method.at("queries")) sums[1] += n.get<double>();
      const auto frames = static_cast<double>(method.at("queries").size());  // as many as there was time for
      fmt::print("{:<20} {:>22.1f} {:>16.1f}\n", method.at("method").get<std::string>(), sums[0] / frames,
                 sums[1] / frames);
    }
  }
  if (picture) {
    picture->write(state_changes_svg(measured));
    picture->commit();
  }
  output.write(measured);
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace

#ifdef SIGHTLINE_HAS_GL
namespace {

struct Row {
  int bunch;
  double per_second, per_cpu_second;
};

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A wall that fills the lower half of the picture, and small boxes behind and above it.
Scene wall() {
  SceneBuilder builder;
  Mesh mesh{
      "wall", {{-100, -100, -10}, {100, -100, -10}, {100, 0, -10}, {-100, 0, -10}}, {{0, 1, 2}, {0, 2, 3}}, false, {}};
  const MeshId id = builder.add_mesh(std::move(mesh));
  builder.add_object(id, identity_affine(), "wall");
  return builder.build();
}

std::vector<Aabb> small_boxes(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 centre(random.range(-8, 8), random.range(-5, 5), random.range(-30, -12));
    boxes.push_back({centre - 0.25f, centre + 0.25f});
  }
  return boxes;
}

/// One round: bunches one after the other, each answered before the next is issued. Interrupted, it ends early.
std::size_t ask_all(gl::OcclusionQueries& queries, std::span<const Aabb> boxes, std::size_t bunch) {
  std::size_t seen = 0;
  std::vector<unsigned> names;
  const std::vector<gl::OcclusionQueries::Ask> asks(bunch, {1, 1});
  for (std::size_t i = 0; i < boxes.size() && !interrupted(); i += bunch) {
    const std::size_t n = std::min(bunch, boxes.size() - i);
    names.clear();
    queries.issue(boxes.subspan(i, n), std::span(asks).first(n), names);
    for (const unsigned name : names) seen += queries.seen(name) ? 1 : 0;
  }
  return seen;
}

std::vector<Row> measure(gl::Context& context, const QueriesOptions& options) {
  const Scene scene = wall();
  gl::SceneDrawing drawing(context, scene);
  gl::Target target;
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.width = options.width;
  view.height = options.height;
  drawing.begin(view, target);
  const ObjectId only = 0;
  drawing.draw({&only, 1});
  const std::vector<Aabb> boxes = small_boxes(options.boxes, options.common.seed);
  gl::OcclusionQueries queries(drawing, 1);
  const std::size_t expected = ask_all(queries, boxes, boxes.size());
  std::vector<Row> rows;
  constexpr int bunches[] = {1, 4, 16, 64, 256, 1024, 4096};
  Progress progress("bunches", std::size(bunches), options.common.quiet);
  for (const int bunch : bunches) {
    double best = 1e300, best_cpu = 1e300;
    for (int round = 0; round < 3; ++round) {
      const auto start = std::chrono::steady_clock::now();
      const double cpu = cpu_seconds();
      const std::size_t seen = ask_all(queries, boxes, static_cast<std::size_t>(bunch));
      if (interrupted()) return rows;
      if (seen != expected) throw std::logic_error("queries give other answers in other bunches");
      best_cpu = std::min(best_cpu, cpu_seconds() - cpu);
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    rows.push_back({bunch, options.boxes / best, options.boxes / best_cpu});
    progress.show(rows.size());
  }
  return rows;
}

}  // namespace

int run_queries(const QueriesOptions& options) {
  catch_interrupts();
  if (!options.scene.empty()) return run_state_changes(options);
  JsonOutput output(options.common);
  std::optional<OutputFile> picture;
  if (!options.picture.empty()) picture.emplace(options.picture);
  try {
    gl::Context context;
    const std::vector<Row> rows = measure(context, options);
    Json json{{"schema", "sightline.queries/1"}, {"device", context.description()}, {"rows", Json::array()}};
    LinePlot plot{
        "Occlusion queries: " + context.description(), "queries in a bunch", "queries per second", true, 0, 0, {}};
    plot.curves = {{"wall clock", {}, false}, {"processor time", {}, false}};
    if (options.common.prints())
      fmt::print("{}\n{:>8} {:>14} {:>18}\n", context.description(), "bunch", "queries/s", "queries/CPU-s");
    for (const Row& row : rows) {
      json["rows"].push_back(
          {{"bunch", row.bunch}, {"per_second", row.per_second}, {"per_cpu_second", row.per_cpu_second}});
      plot.curves[0].points.emplace_back(row.bunch, row.per_second);
      plot.curves[1].points.emplace_back(row.bunch, row.per_cpu_second);
      if (options.common.prints())
        fmt::print("{:>8} {:>14.0f} {:>18.0f}\n", row.bunch, row.per_second, row.per_cpu_second);
    }
    if (picture) {
      picture->write(svg_of(plot));
      picture->commit();
    }
    output.write(json);
  } catch (const gl::Unavailable& error) {
    throw MethodUnavailable(error.what());
  }
  return interrupted() ? exit_interrupted : exit_ok;
}
#else
int run_queries(const QueriesOptions&) { throw MethodUnavailable("this program was built without OpenGL"); }
#endif

}  // namespace sightline::cli
