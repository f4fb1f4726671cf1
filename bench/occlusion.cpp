// bench_occlusion [scene.glb occluders.txt viewpoints.txt]: the occlusion buffer by itself. Occluder fill, box queries,
// and what the answers are worth: boxes called hidden that a ray can see (must be 0), and the share of the truly hidden
// ones that is found. Contenders: the machine's SIMD loops beside the scalar ones, at three resolutions, triangles
// without preparation, and pixel centres or a grid of 4 x 4 samples alone; one thread and two. Triangles are counted as
// they are submitted, hidden or not. Without arguments the castle of shared/scenes beside
// the checkout; exits 1 if an answer is wrong, before anything is timed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/occlusion_buffer.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"

namespace {

using namespace sightline;

constexpr int boxes_per_view = 20000, views_used = 8, rounds = 9;

/// CPU time of this thread, seconds: a shared machine's other work does not count.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::set<std::string> read_names(const std::string& file) {
  std::set<std::string> names;
  std::ifstream in(file);
  if (!in) throw InputError(file, "", "cannot be read");
  for (std::string line; std::getline(in, line);)
    if (!line.empty() && line[0] != '#') names.insert(line);
  return names;
}

std::vector<View> read_views(const std::string& file, const Scene& scene) {
  std::vector<View> views;
  std::ifstream in(file);
  if (!in) throw InputError(file, "", "cannot be read");
  for (std::string line; std::getline(in, line) && views.size() < views_used;) {
    std::istringstream words(line);
    glm::dvec3 eye;
    if (line.empty() || line[0] == '#' || !(words >> eye.x >> eye.y >> eye.z)) continue;
    const double turn = 0.7 * static_cast<double>(views.size());
    views.push_back(look_along(eye, {std::cos(turn), 0, std::sin(turn)}));
    views.back().far = 4.0 * static_cast<double>(glm::length(scene.bounds().extent()));
  }
  return views;
}

/// The occluders alone, as a scene of their own: what the truth is asked about.
Scene occluders_of(const Scene& scene, const std::set<std::string>& names) {
  SceneBuilder builder;
  for (const Mesh& mesh : scene.meshes()) builder.add_mesh(mesh);
  for (ObjectId id = 0; id < scene.objects().size(); ++id)
    if (names.contains(std::string(scene.name(id))))
      builder.add_object(scene.objects()[id].mesh, scene.objects()[id].transform, scene.name(id));
  return builder.build();
}

std::vector<Aabb> random_boxes(const Aabb& bounds, std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (int i = 0; i < boxes_per_view; ++i) {
    const glm::vec3 centre(random.range(bounds.lo.x, bounds.hi.x), random.range(bounds.lo.y, bounds.hi.y),
                           random.range(bounds.lo.z, bounds.hi.z));
    const glm::vec3 half(random.range(0.1, 1.5), random.range(0.1, 1.5), random.range(0.1, 1.5));
    boxes.push_back({centre - half, centre + half});
  }
  return boxes;
}

/// Entry distance of a ray into a box (along the view direction), or infinity; slab test (Kay and Kajiya 1986).
double enter(const PixelRay& ray, const Aabb& box) {
  double from = ray.t_near, to = ray.t_far;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.lo[axis] - ray.origin[axis]) / ray.direction[axis];
    const double b = (box.hi[axis] - ray.origin[axis]) / ray.direction[axis];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to ? from : std::numeric_limits<double>::infinity();
}

enum class Seen { outside, hidden, seen };

/// The truth about a box: looked at through every sample of the fine image that its projection can touch.
Seen truth_of(const Aabb& box, const View& fine, const Frame& depth) {
  const glm::dmat4 clip = view_projection(fine);
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300, nearest = 1e300;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 p = clip * glm::dvec4(box.corner(i), 1.0);
    nearest = std::min(nearest, p.w);
    x0 = std::min(x0, (0.5 + 0.5 * p.x / p.w) * fine.width);
    x1 = std::max(x1, (0.5 + 0.5 * p.x / p.w) * fine.width);
    y0 = std::min(y0, (0.5 - 0.5 * p.y / p.w) * fine.height);
    y1 = std::max(y1, (0.5 - 0.5 * p.y / p.w) * fine.height);
  }
  if (nearest <= fine.near) return Seen::outside;  // not asked about
  bool touched = false;
  for (int y = static_cast<int>(std::max(0.0, y0)); y < std::min<double>(fine.height, y1); ++y)
    for (int x = static_cast<int>(std::max(0.0, x0)); x < std::min<double>(fine.width, x1); ++x) {
      const double t = enter(pixel_ray(fine, x + 0.5, y + 0.5), box);
      if (std::isinf(t)) continue;
      touched = true;
      if (t < static_cast<double>(depth.depth[depth.index(x, y)])) return Seen::seen;
    }
  return touched ? Seen::hidden : Seen::outside;
}

struct Setting {
  const char* name;
  bool scalar;
  double resolution;
  Coverage coverage = Coverage::squares;
  bool outlines = true;
  bool raw = false;  // triangles as they are: edges are matched in every frame
};

const char* asked_by(const Setting& setting) {
  if (setting.raw) return "raw mesh";
  if (setting.coverage == Coverage::centres) return "centres";
  return setting.outlines ? "outlines" : "rectangles";
}

struct Task {
  Scene occluders;
  std::vector<OccluderMesh> meshes;
  std::vector<OccluderInstance> instances;
  std::vector<View> views;
  std::vector<std::vector<Aabb>> boxes;

  void draw(OcclusionBuffer& buffer, const View& view, const Setting& setting) const {
    buffer.begin(view, static_cast<int>(view.width * setting.resolution),
                 static_cast<int>(view.height * setting.resolution), setting.coverage);
    if (!setting.raw) return buffer.add_occluders(instances);
    for (const Object& object : occluders.objects()) {
      const Mesh& mesh = occluders.meshes()[object.mesh];
      buffer.add_occluder(mesh.positions, mesh.triangles, object.transform);
    }
  }
};

/// Missed boxes and recall of a setting; the number of boxes that a ray sees though they were called hidden.
std::size_t check(const Task& task, const Setting& setting, const std::vector<std::vector<Seen>>& truth,
                  const char* samples) {
  std::size_t wrong = 0, hidden = 0, found = 0;
  OcclusionBuffer buffer(setting.scalar);
  for (std::size_t v = 0; v < task.views.size(); ++v) {
    task.draw(buffer, task.views[v], setting);
    std::vector<std::uint8_t> seen(task.boxes[v].size());
    buffer.test(task.boxes[v], seen, setting.outlines);
    for (std::size_t b = 0; b < task.boxes[v].size(); ++b) {
      const bool culled = seen[b] == 0;
      wrong += culled && truth[v][b] == Seen::seen ? 1 : 0;
      hidden += truth[v][b] == Seen::hidden ? 1 : 0;
      found += culled && truth[v][b] == Seen::hidden ? 1 : 0;
    }
  }
  std::printf(
      "%-8s %10.2f  %-10s %-10s %s samples: wrongly hidden %zu, recall %.2f %% of %zu hidden (wanted 0, 99 %%)\n",
      setting.name, setting.resolution, setting.coverage == Coverage::centres ? "centres" : "squares",
      asked_by(setting), samples, wrong, 100.0 * static_cast<double>(found) / static_cast<double>(hidden), hidden);
  return wrong;
}

double wall_seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Times {
  std::vector<double> fill, ask;
};

/// One round of every setting: CPU time with one thread, wall time with several.
void time_round(const Task& task, const std::vector<Setting>& settings, int threads,
                std::vector<OcclusionBuffer>& buffers, std::vector<Times>& times) {
  const ThreadLimit limit(threads);
  const auto seconds = threads == 1 ? cpu_seconds : wall_seconds;
  std::vector<std::uint8_t> seen(boxes_per_view);
  for (std::size_t s = 0; s < settings.size(); ++s)
    for (std::size_t v = 0; v < task.views.size(); ++v) {
      double start = seconds();
      task.draw(buffers[s], task.views[v], settings[s]);
      times[s].fill.push_back(seconds() - start);
      start = seconds();
      buffers[s].test(task.boxes[v], seen, settings[s].outlines);
      times[s].ask.push_back(seconds() - start);
    }
}

void time_all(const Task& task, const std::vector<Setting>& settings) {
  std::vector<OcclusionBuffer> buffers;
  for (const Setting& setting : settings) buffers.emplace_back(setting.scalar);
  std::vector<Times> one(settings.size()), two(settings.size());
  for (int round = 0; round < rounds; ++round) {  // interleaved: noise of the machine hits all alike
    time_round(task, settings, 1, buffers, one);
    time_round(task, settings, 2, buffers, two);
  }
  const double triangles = static_cast<double>(task.occluders.triangle_count());
  std::printf("\n%-8s %10s %-10s %9s %14s %9s %12s %12s %13s\n%-8s %10s %-10s %9s %14s %9s %12s %12s %13s\n", "loops",
              "resolution", "asked by", "fill ms", "M triangles/s", "x scalar", "x, 2 threads", "M queries/s",
              "x, 2 threads", "wanted", "", "", "", "150", "", "1.8", "60", "1.8");
  for (std::size_t s = 0; s < settings.size(); ++s) {
    const double f = median(one[s].fill), a = median(one[s].ask);
    std::size_t reference = 0;  // the scalar loops at the same resolution, or at the highest one
    for (std::size_t i = 0; i < settings.size(); ++i)
      if (settings[i].scalar && settings[i].resolution == settings[s].resolution) reference = i;
    std::printf("%-8s %10.2f %-10s %9.3f %14.1f %9.2f %12.2f %12.2f %13.2f\n",
                settings[s].scalar ? "scalar" : buffers[s].target(), settings[s].resolution, asked_by(settings[s]),
                1e3 * f, 1e-6 * triangles / f, median(one[reference].fill) / f, f / median(two[s].fill),
                1e-6 * boxes_per_view / a, a / median(two[s].ask));
  }
}

int run(const std::string& scene_file, const std::string& names, const std::string& viewpoints) {
  const LoadedScene loaded = load_scene(scene_file);
  Task task{occluders_of(loaded.scene, read_names(names)), {}, {}, read_views(viewpoints, loaded.scene), {}};
  std::vector<bool> used(task.occluders.meshes().size());
  for (const Object& object : task.occluders.objects()) used[object.mesh] = true;
  std::size_t prepared = 0;
  const double start = cpu_seconds();
  for (MeshId m = 0; m < used.size(); ++m) {
    const Mesh& mesh = task.occluders.meshes()[m];
    task.meshes.push_back(used[m] ? make_occluder(mesh.positions, mesh.triangles) : OccluderMesh());
    prepared += used[m] ? mesh.triangles.size() : 0;
  }
  std::printf(
      "prepared once per mesh: welded corners, planes, components, the two triangles at each edge; %.1f ms for %zu "
      "triangles\n",
      1e3 * (cpu_seconds() - start), prepared);
  for (const Object& object : task.occluders.objects())
    task.instances.push_back({&task.meshes[object.mesh], object.transform});
  std::printf("%zu occluders, %llu triangles, %zu views of 1280x720, %d random boxes each\n",
              task.occluders.objects().size(), static_cast<unsigned long long>(task.occluders.triangle_count()),
              task.views.size(), boxes_per_view);
  const Oracle oracle(task.occluders);
  std::vector<std::vector<Seen>> between(task.views.size()), centres(task.views.size());
  for (std::size_t v = 0; v < task.views.size(); ++v) {
    task.boxes.push_back(random_boxes(loaded.scene.bounds(), 100 + v));
    for (const int samples : {4, 1}) {  // along each axis of a pixel
      View fine = task.views[v];
      fine.width *= samples;
      fine.height *= samples;
      Frame depth;
      oracle.draw(fine, depth);
      std::vector<Seen>& seen = samples == 4 ? between[v] : centres[v];
      seen.resize(task.boxes[v].size());
      parallel_blocks(seen.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) seen[b] = truth_of(task.boxes[v][b], fine, depth);
      });
    }
  }
  const std::vector<Setting> settings{{"scalar", true, 1.0},
                                      {"scalar", true, 0.5},
                                      {"scalar", true, 0.25},
                                      {"simd", false, 1.0},
                                      {"simd", false, 0.5},
                                      {"simd", false, 0.25},
                                      {"simd", false, 1.0, Coverage::squares, false},
                                      {"simd", false, 0.5, Coverage::squares, false},
                                      {"simd", false, 0.25, Coverage::squares, false},
                                      {"simd", false, 0.25, Coverage::squares, true, true},
                                      {"simd", false, 1.0, Coverage::centres},
                                      {"simd", false, 4.0, Coverage::centres}};
  std::size_t wrong = 0;
  for (const Setting& setting : settings)
    wrong += setting.coverage == Coverage::centres && setting.resolution == 1.0 ? check(task, setting, centres, "1x1")
                                                                                : check(task, setting, between, "4x4");
  wrong += check(task, {"simd", false, 2.0}, between, "4x4");  // what more pixels would find
  if (wrong > 0) return 1;
  time_all(task, settings);
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  const std::string castle = std::string(SIGHTLINE_SOURCE_DIR) + "/../shared/scenes/intel-castle/";
  try {
    if (count == 4) return run(arguments[1], arguments[2], arguments[3]);
    return run(castle + "intel-castle.glb", castle + "occluders.txt", castle + "viewpoints.txt");
  } catch (const InputError& error) {
    std::fprintf(stderr, "bench_occlusion: skipped: %s\n", error.what());
    return 0;
  }
}
