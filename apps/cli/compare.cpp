// sightline compare: every culler on the same frames, each checked, with what it finds, loses and costs.
#include <fmt/format.h>

#include <set>

#include "camera.hpp"
#include "comparison.hpp"
#include "interrupt.hpp"
#include "json_output.hpp"
#include "methods.hpp"
#include "report.hpp"
#include "scene_argument.hpp"
#include "sightline/registry.hpp"
#include "verbs.hpp"
#include "walk_loop.hpp"

namespace sightline::cli {
namespace {

/// "all" stands for every culler of every table, "software" and "gl" for those without and with OpenGL; also among
/// others.
std::vector<std::string> methods_of(const CompareOptions& options) {
  std::vector<std::string> methods;
  std::set<std::string> given;
  const auto add = [&](const std::string& method) {
    if (given.insert(method).second) methods.push_back(method);
  };
  for (const std::string& method : options.methods) {
    if (method == "all" || method == "software" || method == "gl") {
      for (const Algorithm& row : all_algorithms())
        if (row.family == Family::culler && (method == "all" || row.name.starts_with("gl_") == (method == "gl")))
          add(std::string(row.name));
      continue;
    }
    as_usage([&] { (void)find_method(parse_method(method).name, Family::culler); });
    add(method);
  }
  return methods;
}

WalkOptions walk_of(const CompareOptions& options) {
  WalkOptions walk;
  walk.common = options.common;
  walk.scene = options.scene;
  walk.methods = methods_of(options);
  walk.path = options.path;
  walk.camera = options.camera;
  walk.samples = options.samples;
  walk.report = options.report;
  walk.ids = true;
  return walk;
}

}  // namespace

int run_compare(const CompareOptions& options) {
  const WalkOptions walk = walk_of(options);
  catch_interrupts();
  JsonOutput output(options.common);
  if (!options.report.empty()) prepare_report(options.report);

  LoadedScene loaded = open_scene(options.scene, options.common);
  const CameraPath path = open_path(options.path, options.camera, loaded, options.common.seed);
  WalkScene scene(loaded.scene, 0.0, options.common.seed, true);

  WalkReport report;
  report.scene_name = options.scene;
  report.command = options.common.command;
  report.scene = &loaded.scene;
  report.width = options.camera.width;
  report.height = options.camera.height;
  report.samples = options.samples;
  report.verified = true;
  walk_frames(walk, scene, path.views, report);

  const Comparison comparison = compare_walk(report);
  const Json compared = comparison_json(comparison);
  if (options.common.prints())
    fmt::print("{}: {} objects, {} triangles, {} frames\n{}", options.scene, loaded.scene.objects().size(),
               loaded.scene.triangle_count(), report.views.size(), comparison_table(comparison));
  Json json{{"schema", "sightline.compare/1"},
            {"scene", options.scene},
            {"objects", loaded.scene.objects().size()},
            {"triangles", loaded.scene.triangle_count()},
            {"frames", report.views.size()},
            {"interrupted", report.interrupted}};
  json.update(compared);
  output.write(json);
  if (!options.report.empty()) {
    report.comparison = compared.dump(-1, ' ', false, Json::error_handler_t::replace);
    report.pictures = draw_pictures(report, scene);
    write_report(report, options.report);
  }
  return exit_code(report);
}

}  // namespace sightline::cli
