// sightline occluders: automatic occluders of a scene as a file, and what they are worth.
#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "camera.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "scene_argument.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/raster/auto_occluders.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/save/glb.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

/// The occluders where the objects stand; of an object its surface, and what lies inside it as a second node.
Scene scene_of(const Scene& scene, const AutoOccluders& occluders) {
  SceneBuilder builder;
  constexpr MeshId none = 0xFFFFFFFFu;
  std::vector<std::pair<MeshId, MeshId>> ids;
  const auto add = [&](Mesh mesh, std::string name) {
    if (mesh.triangles.empty()) return none;
    mesh.name = std::move(name);
    return builder.add_mesh(std::move(mesh));
  };
  for (std::size_t m = 0; m < occluders.meshes.size(); ++m) {
    const std::string& name = scene.meshes()[m].name;
    const MeshId surface = add(occluders.meshes[m].surface, name);
    ids.emplace_back(surface, add(occluders.meshes[m].solid, name + " (inside)"));
  }
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Object& object = scene.objects()[id];
    if (!object.opaque) continue;
    const auto [surface, solid] = ids[object.mesh];
    if (surface != none) builder.add_object(surface, object.transform, scene.name(id));
    if (solid != none) builder.add_object(solid, object.transform, std::string(scene.name(id)) + " (inside)");
  }
  return builder.build();
}

Scene scene_of(Mesh occluder) {
  SceneBuilder builder;
  if (!occluder.triangles.empty()) {
    occluder.name = "occluders";
    builder.add_object(builder.add_mesh(std::move(occluder)), identity_affine(), "occluders");
  }
  return builder.build();
}

/// One way to choose occluders, along the path.
struct Measured {
  std::string label, method;
  std::size_t found = 0, missed = 0;  // occluded objects culled; visible ones lost
  std::uint64_t triangles = 0;        // occluder triangles drawn
  std::vector<double> times;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

/// What is in the frustum but hidden, and how much of it each way finds.
struct Report {
  std::size_t frames = 0, hidden = 0;
  std::vector<Measured> ways;
};

Report measure(const OccludersOptions& options, const Scene& scene) {
  const IndexedScene indexed = index_scene(scene);
  const CameraPath path = open_path(options.path, options.camera, scene, options.common.seed);
  const Oracle oracle(scene);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  Report report;
  report.ways = {
      {"all triangles", "occlusion_masked:triangles=1073741824:min_size=0", 0, 0, 0, {}},
      {"automatic",
       fmt::format("occlusion_masked:occluders=auto:auto_budget={}:min_size=0:triangles=1073741824", options.budget),
       0,
       0,
       0,
       {}},
      {"whole objects, default budget", "occlusion_masked", 0, 0, 0, {}},
      {"automatic, default budget",
       fmt::format("occlusion_masked:occluders=auto:auto_budget={}", options.budget),
       0,
       0,
       0,
       {}},
  };
  std::vector<std::unique_ptr<Culler>> cullers;
  for (const Measured& way : report.ways) cullers.push_back(make_culler(way.method, indexed));
  const auto frustum_culler = make_culler("frustum_linear", indexed);
  VisibleSet frustum, visible;
  Progress progress("frames", path.views.size(), options.common.quiet);
  for (const View& view : path.views) {
    Counters unused;
    frustum_culler->cull(view, all, frustum, unused);
    const Truth truth = oracle.look(view);
    report.hidden += frustum.count() - truth.seen.count();
    for (std::size_t i = 0; i < cullers.size(); ++i) {
      Counters counters;
      const auto start = std::chrono::steady_clock::now();
      cullers[i]->cull(view, all, visible, counters);
      report.ways[i].times.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
      report.ways[i].found += frustum.count() - visible.count();
      report.ways[i].triangles += counters.occluder_triangles;
      report.ways[i].missed += judge(truth, visible).missed.size();
    }
    progress.show(++report.frames);
    if (interrupted()) break;
  }
  return report;
}

double share(double part, double whole) { return whole > 0 ? part / whole : 1.0; }

void print_report(const Report& report) {
  const auto& all = report.ways.front();
  fmt::print("\n{} frames, {:.1f} hidden objects in the frustum on average\n", report.frames,
             share(static_cast<double>(report.hidden), static_cast<double>(report.frames)));
  fmt::print("{:<30} {:>10} {:>10} {:>8} {:>16} {:>20} {:>9}\n", "occluders", "% of all", "% of truth", "missed",
             "triangles/frame", "found per 1000 tri", "median ms");
  for (const Measured& way : report.ways)
    fmt::print("{:<30} {:>10.2f} {:>10.2f} {:>8} {:>16.0f} {:>20.2f} {:>9.3f}\n", way.label,
               100 * share(static_cast<double>(way.found), static_cast<double>(all.found)),
               100 * share(static_cast<double>(way.found), static_cast<double>(report.hidden)), way.missed,
               share(static_cast<double>(way.triangles), static_cast<double>(report.frames)),
               1000 * share(static_cast<double>(way.found), static_cast<double>(way.triangles)), median(way.times));
}

Json report_json(const Report& report) {
  Json json{{"frames", report.frames}, {"hidden", report.hidden}, {"ways", Json::array()}};
  for (const Measured& way : report.ways)
    json["ways"].push_back({{"occluders", way.label},
                            {"method", way.method},
                            {"found", way.found},
                            {"missed", way.missed},
                            {"occluder_triangles", way.triangles},
                            {"cull_ms_median", median(way.times)}});
  return json;
}

/// The view of --eye, or the first of the path.
View picture_view(const OccludersOptions& options, const Scene& scene) {
  if (!options.eye) return open_path(options.path, options.camera, scene, options.common.seed).views.front();
  return placed_view(*options.eye, options.look, options.camera, scene);
}

}  // namespace

int run_occluders(const OccludersOptions& options) {
  if (options.output.empty() && !options.report && options.picture.empty())
    throw UsageError("--output or --report or --picture is needed");
  if (options.whole && options.report) throw UsageError("--report measures occluders by object, not --whole");
  JsonOutput output(options.common);
  std::optional<OutputFile> picture;
  if (!options.picture.empty()) picture.emplace(options.picture);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  const Scene& scene = loaded.scene;
  AutoOccluderConfig config;
  config.budget = options.budget;
  config.solids = options.solids;
  const auto start = std::chrono::steady_clock::now();
  Json json{{"schema", "sightline.occluders/1"},
            {"scene", options.scene},
            {"output", options.output},
            {"scene_triangles", scene.triangle_count()}};
  Scene made;
  if (options.whole) {
    made = scene_of(make_scene_occluder(scene, config));
    json["triangles"] = made.triangle_count();
  } else {
    const AutoOccluders occluders = make_auto_occluders(scene, config);
    made = scene_of(scene, occluders);
    json["triangles"] = occluders.triangles;
    json["surface_triangles"] = occluders.surface_triangles;
    json["solid_triangles"] = occluders.solid_triangles;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  json["seconds"] = seconds;
  if (!options.output.empty()) save_glb(made, options.output);
  if (picture) {
    const View view = picture_view(options, scene);
    picture->write(encode_png(picture_occlusion(scene, made, view, options.show)));
    picture->commit();
  }
  const bool talk = options.common.prints();
  if (talk)
    fmt::print("{}: {} occluder triangles of {} ({:.2f} %), made in {:.2f} s\n",
               options.output.empty() ? options.scene : options.output, made.triangle_count(), scene.triangle_count(),
               100 * share(static_cast<double>(made.triangle_count()), static_cast<double>(scene.triangle_count())),
               seconds);
  int code = exit_ok;
  if (options.report) {
    catch_interrupts();
    const Report report = measure(options, scene);
    if (talk) print_report(report);
    json["report"] = report_json(report);
    for (const Measured& way : report.ways)
      if (way.missed > 0) code = exit_missed;
    if (code == exit_ok && interrupted()) code = exit_interrupted;
  }
  output.write(json);
  return code;
}

}  // namespace sightline::cli
