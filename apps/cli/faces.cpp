// sightline faces: the back-face family on a scene: what each method finds, costs and keeps (checklist 17.07, 18.10,
// 19.09, 19.17).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "camera.hpp"
#include "faces_experiments.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "line_plot.hpp"
#include "scene_argument.hpp"
#include "sightline/cull/cluster_backface.hpp"
#include "sightline/geometry/face_planes.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/mesh_eye.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct Row {
  std::string method;
  double found = 0.0;     // share of the back-facing triangles
  double culled = 0.0;    // share of all triangles of solids in the frustum
  double ms = 0.0;        // of a frame: the median of the frames' least
  double bytes = 0.0;     // kept for each triangle of a solid mesh
  double clusters = 0.0;  // tested in a frame
};

struct Totals {
  std::size_t meshes[3] = {}, triangles[3] = {};  // by Solidity
  double in_view = 0.0, back = 0.0;               // triangles of solids in the frustum, summed over frames
};

/// Triangles of an object that turn their backs to the eye, in doubles.
std::size_t back_facing(const Mesh& mesh, const MeshEye& eye) {
  const glm::dvec3 origin(mesh.bounds.centre()), e(eye.eye);
  std::size_t back = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) - origin, b = glm::dvec3(mesh.positions[t.y]) - origin,
                     c = glm::dvec3(mesh.positions[t.z]) - origin;
    back += glm::dot(glm::cross(b - a, c - a), e - (eye.eye.w > 0.0f ? a : glm::dvec3(0.0))) < 0.0 ? 1 : 0;
  }
  return back;
}

class Comparison {
 public:
  Comparison(const IndexedScene& indexed, const std::vector<View>& views) : indexed_(indexed), views_(views) {
    const Scene& scene = indexed.scene;
    for (const Mesh& mesh : scene.meshes()) {
      solidity_.push_back(solidity_of(mesh));
      ++totals_.meshes[static_cast<int>(solidity_.back())];
      totals_.triangles[static_cast<int>(solidity_.back())] += mesh.triangles.size();
    }
    const auto frustum = make_culler("frustum_linear", indexed);
    for (const View& view : views) {
      Counters counters;
      VisibleSet& in_view = in_view_.emplace_back();
      frustum->cull(view, VisibleSet::all(scene.objects().size()), in_view, counters);
      for (const ObjectId id : in_view.order()) {
        const Object& object = scene.objects()[id];
        if (!object.opaque || solidity_[object.mesh] != Solidity::solid) continue;
        const MeshEye eye = mesh_eye(view, object, scene.mesh_of(id));
        totals_.in_view += static_cast<double>(scene.mesh_of(id).triangles.size());
        if (eye.valid) totals_.back += static_cast<double>(back_facing(scene.mesh_of(id), eye));
      }
    }
  }

  Row measure(const std::string& method) const {
    Row row{method};
    const auto culler = make_face_culler(method, indexed_);
    std::vector<double> times;
    Counters counters;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      FaceSet kept;
      culler->cull(views_[v], in_view_[v], kept, counters);
      double least = 1e300;  // microseconds are easily disturbed
      for (int repeat = 0; repeat < 5; ++repeat) {
        const auto start = Clock::now();
        Counters unused;
        culler->cull(views_[v], in_view_[v], kept, unused);
        least = std::min(least, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      }
      times.push_back(least);
    }
    std::sort(times.begin(), times.end());
    row.ms = times.empty() ? 0.0 : times[times.size() / 2];
    row.found = totals_.back > 0.0 ? static_cast<double>(counters.faces_culled) / totals_.back : 0.0;
    row.culled = totals_.in_view > 0.0 ? static_cast<double>(counters.faces_culled) / totals_.in_view : 0.0;
    row.clusters =
        static_cast<double>(counters.clusters_tested) / static_cast<double>(std::max<std::size_t>(views_.size(), 1));
    row.bytes =
        static_cast<double>(culler->bytes()) / static_cast<double>(std::max<std::size_t>(totals_.triangles[0], 1));
    return row;
  }

  [[nodiscard]] const Totals& totals() const { return totals_; }

 private:
  const IndexedScene& indexed_;
  const std::vector<View>& views_;
  std::vector<Solidity> solidity_;
  std::vector<VisibleSet> in_view_;
  Totals totals_;
};

Json json_of(const Row& row) {
  return {{"method", row.method},
          {"found", row.found},
          {"culled", row.culled},
          {"ms", row.ms},
          {"bytes_per_triangle", row.bytes},
          {"clusters_tested", row.clusters}};
}

void print_rows(const char* title, const std::vector<Row>& rows, double baseline) {
  fmt::print("\n{:<46} {:>8} {:>9} {:>9} {:>9} {:>8} {:>10}\n", title, "found %", "culled %", "ms", "x faster", "bytes",
             "clusters");
  for (const Row& row : rows)
    fmt::print("{:<46} {:>8.1f} {:>9.1f} {:>9.3f} {:>9.2f} {:>8.1f} {:>10.0f}\n", row.method, 100.0 * row.found,
               100.0 * row.culled, row.ms, row.ms > 0.0 ? baseline / row.ms : 0.0, row.bytes, row.clusters);
}

void write_picture(const std::string& file, const std::string& bytes) {
  OutputFile output(file);
  output.write(bytes);
  output.commit();
}

/// 18.11: what more sectors cost and find, beside the tests of each triangle.
LinePlot mask_plot(const Comparison& comparison, const std::string& scene) {
  LinePlot plot{
      "Normal masks: " + title_of(scene),
      "back-facing triangles found, %",
      "times faster than the scalar dot product",
      false,
      0.0,
      0.0,
      {{"dot product, scalar and SIMD", {}, true}, {"masks: 1, 2 x 2, 4 x 4, 8 x 8 sectors", {}}, {"", {}, true}}};
  const double baseline = comparison.measure("backface:scalar=on").ms;
  const auto add = [&](std::size_t curve, const std::string& method) {
    const Row row = comparison.measure(method);
    plot.curves[curve].points.emplace_back(100.0 * row.found, baseline / std::max(row.ms, 1e-9));
  };
  for (const char* method : {"backface:scalar=on", "backface"}) add(0, method);
  for (const int sectors : {1, 2, 4, 8}) add(1, fmt::format("normal_mask:sectors={}", sectors));
  plot.curves[2].points = plot.curves[1].points;
  return plot;
}

/// 19.17: `sweep` from many clusters to few.
LinePlot cluster_plot(const std::vector<Row>& sweep, const std::vector<double>& clusters, double baseline,
                      const std::string& scene) {
  LinePlot plot{"Clusters: " + title_of(scene),
                "clusters in view",
                "%, or times",
                true,
                0.0,
                0.0,
                {{"back-facing triangles found, %", {}}, {"times faster than the scalar dot product", {}}}};
  for (std::size_t i = sweep.size(); i-- > 0;) {
    plot.curves[0].points.emplace_back(clusters[i], 100.0 * sweep[i].found);
    plot.curves[1].points.emplace_back(clusters[i], baseline / std::max(sweep[i].ms, 1e-9));
  }
  return plot;
}

}  // namespace

int run_faces(const FacesOptions& options) {
  std::vector<std::string> methods = options.methods;
  if (methods.empty()) {
    methods = {"backface:scalar=on"};
    for (const Algorithm& row : algorithms())
      if (row.family == Family::face_culler) methods.emplace_back(row.name);
    methods.emplace_back("normal_mask:sectors=4");
  }
  for (const std::string& method : methods)
    as_usage([&] { (void)find_algorithm(parse_method(method).name, Family::face_culler); });
  catch_interrupts();
  JsonOutput output(options.common);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  const CameraPath path = open_path(options.path, options.camera, loaded.scene, options.common.seed);
  const IndexedScene indexed = index_scene(loaded.scene);
  const Comparison comparison(indexed, path.views);
  const Totals& totals = comparison.totals();
  std::vector<Row> rows, sweep;
  // Interrupted, it tells what has been measured.
  constexpr int leaves[] = {8, 16, 32, 64, 128, 256, 512, 1024};
  Progress progress("methods", methods.size() + std::size(leaves), options.common.quiet);
  for (const std::string& method : methods) {
    if (interrupted()) break;
    rows.push_back(as_usage([&] { return comparison.measure(method); }));
    progress.show(rows.size());
  }
  const double in_view = totals.in_view / static_cast<double>(std::max<std::size_t>(path.views.size(), 1));
  std::vector<double> clusters;
  for (const int leaf : leaves) {
    if (interrupted()) break;
    sweep.push_back(comparison.measure(fmt::format("cluster_backface:leaf={}:cost=0.001", leaf)));
    clusters.push_back(std::max(1.0, in_view / leaf));
    progress.show(rows.size() + sweep.size());
  }
  const std::vector<FrameResult> frames =
      interrupted() ? std::vector<FrameResult>() : rotated_frames(loaded.scene, path.views);
  const double cost = measured_cluster_cost();
  const double share = totals.in_view > 0.0 ? totals.back / totals.in_view : 0.0;
  Json json{{"schema", "sightline.faces/1"}, {"scene", options.scene},    {"frames", path.views.size()},
            {"back_facing", share},          {"cluster_test_cost", cost}, {"meshes", Json::object()},
            {"rows", Json::array()},         {"sweep", Json::array()},    {"rotated_frames", Json::array()}};
  for (int kind = 0; kind < 3; ++kind)
    json["meshes"][std::string(to_string(static_cast<Solidity>(kind)))] = {{"meshes", totals.meshes[kind]},
                                                                           {"triangles", totals.triangles[kind]}};
  for (const Row& row : rows) json["rows"].push_back(json_of(row));
  for (const Row& row : sweep) json["sweep"].push_back(json_of(row));
  for (const FrameResult& frame : frames)
    json["rotated_frames"].push_back(
        {{"frame", frame.frame}, {"probability", frame.probability}, {"found", frame.culled}});
  if (options.common.prints()) {
    fmt::print("meshes: {} solid ({} triangles), {} open ({}), {} inverted ({}); only solid ones lose triangles\n",
               totals.meshes[0], totals.triangles[0], totals.meshes[1], totals.triangles[1], totals.meshes[2],
               totals.triangles[2]);
    fmt::print("{:.0f} triangles of solids in the frustum a frame, {:.1f} % turn their backs (17.07: about half)\n",
               in_view, 100.0 * share);
    const double baseline = rows.empty() ? 0.0 : rows.front().ms;
    print_rows("method", rows, baseline);
    print_rows("clusters of at most so many (19.17)", sweep, baseline);
    fmt::print("t_C / r measured: {}\n\n{:<46} {:>8} {:>20}\n", cost, "frame of the normals (19.09)", "found %",
               "of random eyes %");
    for (const FrameResult& frame : frames)
      fmt::print("{:<46} {:>8.1f} {:>20.1f}\n", frame.frame, 100.0 * frame.culled, 100.0 * frame.probability);
  }
  if (interrupted()) {
    output.write(json);
    return exit_interrupted;
  }
  if (!options.mask.empty()) write_picture(options.mask, encode_png(draw_mask(loaded.scene, path.views.front())));
  if (!options.volume.empty()) write_picture(options.volume, encode_png(draw_culling_volume(loaded.scene)));
  if (!options.mask_speed.empty()) write_picture(options.mask_speed, svg_of(mask_plot(comparison, options.scene)));
  if (!options.cluster_speed.empty()) {
    const double baseline = comparison.measure("backface:scalar=on").ms;
    write_picture(options.cluster_speed, svg_of(cluster_plot(sweep, clusters, baseline, options.scene)));
  }
  output.write(json);
  return exit_ok;
}

}  // namespace sightline::cli
