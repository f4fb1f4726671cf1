// sightline structures: the tracing structures side by side on the same rays (checklist 13.12, 14).
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "camera.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "scene_argument.hpp"
#include "sightline/index/tracer.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/scene_soup.hpp"
#include "structures_picture.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t most_brute_tests = 100'000'000;  // brute force sees as many rays as that allows
constexpr std::size_t most_recorded = 20'000;            // rays whose tests are repeated by themselves

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct RaySet {
  std::string name;
  std::vector<Ray> rays;
};

/// What one structure did on one set of rays.
struct Figures {
  std::size_t rays = 0, differ = 0;
  double nodes = none, tests = none, rays_per_second = none, share = none;
};

struct Row {
  std::string name;
  double build_seconds = none;
  std::size_t bytes = 0;
  std::vector<Figures> sets;
};

/// Rays through the pixel centres of views on a walk; of a soup without a scene none.
std::vector<Ray> camera_rays(const Scene& scene, const StructuresOptions& options) {
  PathConfig config;
  config.frames = 8;
  config.seed = options.common.seed;
  const CameraPath path = generate_path(scene, config);
  const auto per_view = std::max<std::size_t>(1, options.rays / path.views.size());
  const int height = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(per_view) * 9.0 / 16.0)));
  const int width = std::max(1, static_cast<int>(per_view) / height);
  std::vector<Ray> rays;
  for (View view : path.views) {
    view.width = width;
    view.height = height;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const PixelRay r = pixel_ray(view, x + 0.5, y + 0.5);
        rays.push_back({glm::vec3(r.origin), 0.0f, glm::vec3(r.direction), std::numeric_limits<float>::infinity()});
      }
  }
  return rays;
}

std::vector<Ray> random_rays(const Aabb& bounds, const StructuresOptions& options) {
  Random random(options.common.seed);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < options.rays && !bounds.empty(); ++i) {
    const glm::vec3 from(random.range(bounds.lo.x, bounds.hi.x), random.range(bounds.lo.y, bounds.hi.y),
                         random.range(bounds.lo.z, bounds.hi.z));
    rays.push_back({from, 0.0f, glm::vec3(random.direction()), std::numeric_limits<float>::infinity()});
  }
  return rays;
}

/// Share of the time that goes into tests of triangles: the tests that were made, repeated by themselves, against the
/// whole. The repeated ones find their triangles in order and mostly in the cache, so the share is rather too low.
double share_of_tests(const Tracer& tracer, std::span<const Ray> rays) {
  std::vector<std::uint32_t> tested;
  std::vector<std::size_t> ends;
  TraceCounters counters;
  counters.tested = &tested;
  for (const Ray& ray : rays) {
    (void)tracer.nearest(ray, counters);
    ends.push_back(tested.size());
  }
  double whole = std::numeric_limits<double>::infinity(), tests = whole;
  std::uint32_t sum = 0;
  for (int round = 0; round < 3; ++round) {
    TraceCounters work;
    auto start = std::chrono::steady_clock::now();
    for (const Ray& ray : rays) sum += tracer.nearest(ray, work).triangle;
    whole = std::min(whole, seconds_since(start));
    start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::size_t begin = i == 0 ? 0 : ends[i - 1];
      sum += tracer.retest(rays[i], std::span(tested).subspan(begin, ends[i] - begin)).triangle;
    }
    tests = std::min(tests, seconds_since(start));
  }
  volatile std::uint32_t keep = sum;  // the work must not be optimised away
  (void)keep;
  return std::min(1.0, tests / whole);
}

Figures measure(const Tracer& tracer, std::span<const Ray> rays, std::vector<RayHit>& truth) {
  Figures f;
  f.rays = rays.size();
  if (rays.empty()) return f;
  std::vector<RayHit> hits(rays.size());
  TraceCounters counters;
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 2; ++round) {
    counters = {};
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = tracer.nearest(rays[i], counters);
    best = std::min(best, seconds_since(start));
  }
  if (truth.empty()) truth = hits;
  for (std::size_t i = 0; i < std::min(hits.size(), truth.size()); ++i) f.differ += hits[i] == truth[i] ? 0 : 1;
  const auto n = static_cast<double>(rays.size());
  f.nodes = static_cast<double>(counters.nodes) / n;
  f.tests = static_cast<double>(counters.tests) / n;
  f.rays_per_second = n / best;
  f.share = share_of_tests(tracer, rays.first(std::min(rays.size(), most_recorded)));
  return f;
}

std::vector<const TracerKind*> chosen(const StructuresOptions& options) {
  std::vector<const TracerKind*> kinds;
  std::string names;
  for (const TracerKind& kind : tracer_kinds()) names += (names.empty() ? "" : ", ") + std::string(kind.name);
  for (const std::string& name : options.methods) {
    kinds.push_back(find_tracer(name));
    if (kinds.back() == nullptr)
      throw UsageError(fmt::format("--structure: no structure is called '{}'; there are {}", name, names));
  }
  if (kinds.empty())
    for (const TracerKind& kind : tracer_kinds()) kinds.push_back(&kind);
  return kinds;
}

/// Interrupted, it leaves those that were measured.
std::vector<Row> compare(const std::vector<const TracerKind*>& kinds, const TriangleSoup& soup,
                         const std::vector<RaySet>& sets, bool quiet) {
  std::vector<Row> rows;
  std::vector<std::vector<RayHit>> truth(sets.size());
  Progress progress("structures", kinds.size(), quiet);
  for (const TracerKind* kind : kinds) {
    progress.show(rows.size());
    if (interrupted()) break;
    Row row;
    row.name = kind->name;
    const auto start = std::chrono::steady_clock::now();
    const std::unique_ptr<Tracer> tracer = kind->make(soup);
    row.build_seconds = seconds_since(start);
    row.bytes = tracer->bytes();
    for (std::size_t s = 0; s < sets.size(); ++s) {
      std::span<const Ray> rays(sets[s].rays);
      if (kind->name == "brute" && soup.size() > 0)
        rays = rays.first(
            std::min<std::size_t>(rays.size(), std::max<std::uint64_t>(1, most_brute_tests / soup.size() / 8)));
      row.sets.push_back(measure(*tracer, rays, truth[s]));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void print_table(const std::vector<Row>& rows, const std::vector<RaySet>& sets, std::size_t triangles) {
  fmt::print("{:<15} {:>9} {:>9} {:>7}", "structure", "build ms", "bytes/tri", "MiB");
  for (const RaySet& set : sets)
    fmt::print(" | {:>9} {:>8} {:>8} {:>6} {:>6}", set.name, "nodes", "tests", "in tests", "differ");
  fmt::print("\n{:<15} {:>9} {:>9} {:>7}", "", "", "", "");
  for (std::size_t s = 0; s < sets.size(); ++s)
    fmt::print(" | {:>9} {:>8} {:>8} {:>8} {:>6}", "M rays/s", "per ray", "per ray", "share", "rays");
  fmt::print("\n");
  for (const Row& row : rows) {
    fmt::print("{:<15} {:>9.1f} {:>9.1f} {:>7.1f}", row.name, 1e3 * row.build_seconds,
               static_cast<double>(row.bytes) / static_cast<double>(std::max<std::size_t>(1, triangles)),
               static_cast<double>(row.bytes) / 1048576.0);
    for (const Figures& f : row.sets)
      fmt::print(" | {:>9.4f} {:>8.1f} {:>8.1f} {:>7.0f}% {:>6}", 1e-6 * f.rays_per_second, f.nodes, f.tests,
                 100.0 * f.share, f.differ);
    fmt::print("\n");
  }
}

Json structures_json(const StructuresOptions& options, const std::vector<Row>& rows, const std::vector<RaySet>& sets,
                     std::size_t triangles) {
  Json json{{"schema", "sightline.structures/1"},
            {"scene", options.scene},
            {"triangles", triangles},
            {"structures", Json::array()}};
  for (const Row& row : rows) {
    Json entry{{"name", row.name}, {"build_s", row.build_seconds}, {"bytes", row.bytes}};
    for (std::size_t s = 0; s < sets.size(); ++s) {
      const Figures& f = row.sets[s];
      entry[sets[s].name] = {{"rays", f.rays},
                             {"differ", f.differ},
                             {"nodes_per_ray", f.nodes},
                             {"tests_per_ray", f.tests},
                             {"rays_per_s", f.rays_per_second},
                             {"share_in_tests", f.share}};
    }
    json["structures"].push_back(std::move(entry));
  }
  return json;
}

std::string plot(const std::vector<Row>& rows, const std::vector<RaySet>& sets, std::size_t triangles) {
  std::vector<std::string> names;
  std::vector<Bars> charts{{"build", "ms", {}}, {"memory", "bytes per triangle", {}}};
  for (const RaySet& set : sets) {
    charts.push_back({set.name + " rays", "M rays/s", {}});
    charts.push_back({set.name + ": nodes visited", "per ray", {}});
    charts.push_back({set.name + ": intersection tests", "per ray", {}});
    charts.push_back({set.name + ": time in tests", "%", {}});
  }
  for (const Row& row : rows) {
    names.push_back(row.name);
    charts[0].values.push_back(1e3 * row.build_seconds);
    charts[1].values.push_back(static_cast<double>(row.bytes) /
                               static_cast<double>(std::max<std::size_t>(1, triangles)));
    for (std::size_t s = 0; s < sets.size(); ++s) {
      const Figures& f = row.sets[s];
      charts[2 + 4 * s].values.push_back(1e-6 * f.rays_per_second);
      charts[3 + 4 * s].values.push_back(f.nodes);
      charts[4 + 4 * s].values.push_back(f.tests);
      charts[5 + 4 * s].values.push_back(100.0 * f.share);
    }
  }
  return draw_bars(names, charts);
}

}  // namespace

int run_structures(const StructuresOptions& options) {
  const std::vector<const TracerKind*> kinds = chosen(options);
  catch_interrupts();
  std::optional<OutputFile> plot_file, cells_file, octree_file;
  if (!options.plot.empty()) plot_file.emplace(options.plot);
  if (!options.cells.empty()) cells_file.emplace(options.cells);
  if (!options.octree.empty()) octree_file.emplace(options.octree);
  JsonOutput output(options.common);
  const bool example = options.scene == "example";
  TriangleSoup soup;
  std::vector<RaySet> sets;
  if (example) {
    soup = plane_example();
  } else {
    const LoadedScene loaded = open_scene(options.scene, options.common);
    soup = soup_of(loaded.scene);
    if (soup.size() > 0) sets.push_back({"camera", camera_rays(loaded.scene, options)});
  }
  sets.push_back({"random", random_rays(bounds_of(soup), options)});
  if (cells_file) {
    cells_file->write(draw_cells(soup, example ? 4 : 7, example ? "rbc" : ""));
    cells_file->commit();
  }
  if (octree_file) {
    octree_file->write(draw_octree(soup));
    octree_file->commit();
  }
  const std::vector<Row> rows = compare(kinds, soup, sets, options.common.quiet);
  if (plot_file) {
    plot_file->write(plot(rows, sets, soup.size()));
    plot_file->commit();
  }
  if (options.common.prints()) {
    fmt::print("{} triangles\n", soup.size());
    print_table(rows, sets, soup.size());
  }
  output.write(structures_json(options, rows, sets, soup.size()));
  for (const Row& row : rows)
    for (const Figures& f : row.sets)
      if (f.differ > 0) {
        warn(fmt::format("{} gives other hits than {} for {} rays", row.name, rows[0].name, f.differ));
        return exit_missed;
      }
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace sightline::cli
