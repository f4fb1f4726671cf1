// sightline bounds: which bounding volume? Tightness, memory, cost of the frustum test, false-visible share and bound
// of the screen area, of every kind, on the objects of a scene (checklist 20.02-20.15, 21.08).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "camera.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "scene_argument.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/object_hulls.hpp"
#include "sightline/scene/screen_area.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

struct Kind {
  const char* name;    // as frustum_bounds has it
  const char* method;  // of the frustum test
  std::size_t bytes;   // of one volume; 0: its corners, 12 bytes each
};
constexpr Kind kinds[] = {{"sphere", "frustum_bounds:bound=sphere", 16},
                          {"ritter", "frustum_bounds:bound=ritter", 16},
                          {"aabb", "frustum_bounds:bound=aabb", 24},
                          {"aabb, clip space", "frustum_bounds:bound=aabb:test=clip", 24},
                          {"aabb, meta-bounds", "frustum_bounds:bound=aabb:meta=on", 24},
                          {"sphere, meta-bounds", "frustum_bounds:bound=sphere:meta=on", 16},
                          {"aabb, last plane first", "frustum_bounds:bound=aabb:coherence=on", 24},
                          {"obb, principal axes", "frustum_bounds:bound=obb_pca", 60},
                          {"obb, fitted", "frustum_bounds:bound=obb", 60},
                          {"6-dop", "frustum_bounds:bound=kdop6", 0},
                          {"14-dop", "frustum_bounds:bound=kdop14", 0},
                          {"18-dop", "frustum_bounds:bound=kdop18", 0},
                          {"26-dop", "frustum_bounds:bound=kdop26", 0},
                          {"convex hull", "frustum_bounds:bound=hull", 0}};

struct Sums {
  double volume = 0.0, surface = 0.0, bytes = 0.0, area = 0.0;
};

struct Row {
  Sums sums;
  std::size_t reported = 0, missed = 0;
  double test_ns = 0.0;
};

constexpr double pi = 3.14159265358979323846;

Sums sums_of(const ConvexHull& solid, const View& view) {
  return {volume(solid), surface(solid), 12.0 * static_cast<double>(solid.vertices.size()),
          screen_area_bound(view, solid)};
}

/// Volume, surface, bytes and screen area of one object's volume of a kind.
Sums measure(std::string_view kind, const ConvexHull& hull, const View& view) {
  const auto of_sphere = [&](const Sphere& s) {
    const double r = std::max(0.0, static_cast<double>(s.radius));
    return Sums{4.0 / 3.0 * pi * r * r * r, 4.0 * pi * r * r, 16.0, screen_area_bound(view, s)};
  };
  const auto of_box = [&](const Obb& b, double bytes) {
    return Sums{volume(b), surface(b), bytes, screen_area_bound(view, b)};
  };
  if (kind.starts_with("sphere")) return of_sphere(smallest_sphere(hull.vertices));
  if (kind == "ritter") return of_sphere(ritter_sphere(hull.vertices));
  if (kind.starts_with("aabb")) return of_box(box_along(hull.vertices, glm::dmat3(1.0)), 24.0);
  if (kind == "obb, principal axes") return of_box(pca_box(hull.vertices), 60.0);
  if (kind == "obb, fitted") return of_box(fitted_box(hull), 60.0);
  if (kind == "convex hull") return sums_of(hull, view);
  const int k = std::atoi(kind.data());
  Sums sums = sums_of(polytope(make_kdop(hull.vertices, k)), view);
  sums.bytes += 4.0 * k;
  return sums;
}

/// True if a part of the triangle lies between the planes of the view (exact clipping in doubles).
bool triangle_in(const std::array<glm::dvec4, 6>& planes, std::vector<glm::dvec3> polygon) {
  std::vector<glm::dvec3> cut;
  for (const glm::dvec4& plane : planes) {
    cut.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double da = glm::dot(plane, glm::dvec4(a, 1.0)), db = glm::dot(plane, glm::dvec4(b, 1.0));
      if (da >= 0) cut.push_back(a);
      if ((da >= 0) != (db >= 0)) cut.push_back(a + (b - a) * (da / (da - db)));
    }
    if (cut.size() < 3) return false;
    polygon.swap(cut);
  }
  return true;
}

/// Objects of which a triangle lies in the frustum: what a perfect test would report.
VisibleSet truth_of(const Scene& scene, const View& view, const VisibleSet& boxes_in) {
  const glm::dmat4 rows = glm::transpose(view_projection(view));
  std::array<glm::dvec4, 6> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      planes[static_cast<std::size_t>(2 * axis + side)] = rows[3] + (side == 0 ? 1.0 : -1.0) * rows[axis];
  std::vector<char> in(scene.objects().size());
  const auto order = boxes_in.order();
  parallel_blocks(order.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Object& object = scene.objects()[order[i]];
      const Mesh& mesh = scene.meshes()[object.mesh];
      for (const glm::uvec3& t : mesh.triangles) {
        std::vector<glm::dvec3> corners;
        for (int k = 0; k < 3; ++k) corners.emplace_back(transform_point(object.transform, mesh.positions[t[k]]));
        if (!triangle_in(planes, std::move(corners))) continue;
        in[order[i]] = 1;
        break;
      }
    }
  });
  VisibleSet truth(scene.objects().size());
  for (const ObjectId id : order)
    if (in[id] != 0) truth.insert(id);
  return truth;
}

/// Interrupted, it leaves those of the views that were counted.
void count_false(const BoundsOptions& options, const IndexedScene& indexed, std::vector<View>& views,
                 std::vector<Row>& rows, std::size_t& objects, std::size_t& inside) {
  using Clock = std::chrono::steady_clock;
  const VisibleSet all = VisibleSet::all(indexed.scene.objects().size());
  std::vector<std::unique_ptr<Culler>> cullers;
  for (const Kind& kind : kinds) cullers.push_back(make_culler(kind.method, indexed));
  const auto boxes = make_culler("frustum_linear", indexed);
  std::vector<std::vector<double>> times(rows.size());
  Progress progress("frames", views.size(), options.common.quiet);
  for (std::size_t v = 0; v < views.size(); ++v) {
    VisibleSet visible;
    Counters counters;
    boxes->cull(views[v], all, visible, counters);
    const VisibleSet truth = truth_of(indexed.scene, views[v], visible);
    objects += all.count();
    inside += truth.count();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto start = Clock::now();
      cullers[i]->cull(views[v], all, visible, counters);
      times[i].push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count());
      rows[i].reported += visible.count();
      for (const ObjectId id : truth.order()) rows[i].missed += visible.contains(id) ? 0 : 1;
    }
    progress.show(v + 1);
    if (interrupted()) views.resize(v + 1);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::sort(times[i].begin(), times[i].end());
    rows[i].test_ns = times[i].empty()
                          ? 0.0
                          : times[i][times[i].size() / 2] / static_cast<double>(std::max<std::size_t>(all.count(), 1));
  }
}

/// Sums over at most a few thousand objects, evenly chosen.
void measure_volumes(const Scene& scene, const View& view, std::vector<Row>& rows, Sums& hulls) {
  const std::vector<ConvexHull> meshes = mesh_hulls(scene);
  const std::size_t count = scene.objects().size(), stride = std::max<std::size_t>(1, count / 4000),
                    chosen = (count + stride - 1) / stride;
  constexpr std::size_t columns = std::size(kinds);
  std::vector<Sums> all(chosen * (columns + 1));
  parallel_blocks(chosen, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Object& object = scene.objects()[i * stride];
      if (object.bounds.empty()) continue;
      const ConvexHull hull = placed_hull(meshes[object.mesh], object.transform);
      // Seen from outside, as far away as the object is large, so that every area is bounded.
      View there = view;
      there.eye = glm::dvec3(object.bounds.centre()) -
                  4.0 * glm::length(glm::dvec3(object.bounds.extent())) * view_direction(view);
      for (std::size_t k = 0; k < columns; ++k) all[i * (columns + 1) + k] = measure(kinds[k].name, hull, there);
      all[i * (columns + 1) + columns] = sums_of(hull, there);
    }
  });
  const auto add = [](Sums& to, const Sums& from) {
    to.volume += from.volume;
    to.surface += from.surface;
    to.bytes += from.bytes;
    to.area += from.area;
  };
  for (std::size_t i = 0; i < chosen; ++i) {
    for (std::size_t k = 0; k < columns; ++k) add(rows[k].sums, all[i * (columns + 1) + k]);
    add(hulls, all[i * (columns + 1) + columns]);
  }
  for (Row& row : rows) row.sums.bytes /= static_cast<double>(std::max<std::size_t>(chosen, 1));
}

}  // namespace

int run_bounds(const BoundsOptions& options) {
  catch_interrupts();
  JsonOutput output(options.common);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  CameraPath path = open_path(options.path, options.camera, loaded.scene, options.common.seed);
  const IndexedScene indexed = index_scene(loaded.scene);
  std::vector<Row> rows(std::size(kinds));
  Sums hulls;
  std::size_t objects = 0, inside = 0, missed = 0;
  measure_volumes(loaded.scene, path.views.front(), rows, hulls);
  count_false(options, indexed, path.views, rows, objects, inside);
  Json json{{"schema", "sightline.bounds/1"}, {"scene", options.scene},
            {"frames", path.views.size()},    {"tests", objects},
            {"in_frustum", inside},           {"rows", Json::array()}};
  const bool text = options.common.prints();
  if (text) {
    fmt::print("{} frustum tests of each kind; a triangle of the object lay in the frustum in {}\n", objects, inside);
    fmt::print("{:<24} {:>10} {:>10} {:>10} {:>8} {:>9} {:>16} {:>7}\n", "bound", "volume", "surface", "area", "bytes",
               "test ns", "false-visible %", "missed");
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const auto ratio = [](double a, double b) { return b > 0.0 ? a / b : 1.0; };
    const double false_visible =
        ratio(static_cast<double>(row.reported - (inside - row.missed)), static_cast<double>(objects - inside));
    missed += row.missed;
    json["rows"].push_back({{"bound", kinds[i].name},
                            {"method", kinds[i].method},
                            {"volume", ratio(row.sums.volume, hulls.volume)},
                            {"surface", ratio(row.sums.surface, hulls.surface)},
                            {"area", ratio(row.sums.area, hulls.area)},
                            {"bytes", row.sums.bytes},
                            {"test_ns", row.test_ns},
                            {"false_visible", false_visible},
                            {"missed", row.missed}});
    if (text)
      fmt::print("{:<24} {:>10.3f} {:>10.3f} {:>10.3f} {:>8.0f} {:>9.1f} {:>16.3f} {:>7}\n", kinds[i].name,
                 ratio(row.sums.volume, hulls.volume), ratio(row.sums.surface, hulls.surface),
                 ratio(row.sums.area, hulls.area), row.sums.bytes, row.test_ns, 100.0 * false_visible, row.missed);
  }
  if (text)
    fmt::print(
        "volume, surface and projected area relative to the convex hulls', summed over objects; false-visible: share "
        "of the\n"
        "objects outside of the frustum that are reported\n");
  output.write(json);
  return missed > 0 ? exit_missed : interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace sightline::cli
