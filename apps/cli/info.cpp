// sightline info: what a scene holds.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "json_output.hpp"
#include "output.hpp"
#include "scene_argument.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

Json camera_json(const LoadedScene::NamedView& camera) {
  const View& view = camera.view;
  const glm::dvec3 look = view_direction(view);
  return {{"name", camera.name},
          {"eye", {view.eye.x, view.eye.y, view.eye.z}},
          {"look", {look.x, look.y, look.z}},
          {"options", describe(view)}};
}

Json info_json(const InfoOptions& options, const LoadedScene& loaded, double load_ms) {
  const Scene& scene = loaded.scene;
  const auto closed =
      std::count_if(scene.meshes().begin(), scene.meshes().end(), [](const Mesh& m) { return m.closed; });
  Json json{{"schema", "sightline.info/1"},
            {"scene", options.scene},
            {"objects", scene.objects().size()},
            {"triangles", scene.triangle_count()},
            {"unique_meshes", scene.meshes().size()},
            {"closed_meshes", closed},
            {"bounds", nullptr},
            {"cells", scene.cells().size()},
            {"portals", scene.portals().size()},
            {"cameras", Json::array()},
            {"warnings", loaded.warnings},
            {"load_ms", load_ms}};
  if (!scene.bounds().empty())
    json["bounds"] = {{"lo", vector_json(scene.bounds().lo)}, {"hi", vector_json(scene.bounds().hi)}};
  for (const auto& camera : loaded.cameras) json["cameras"].push_back(camera_json(camera));
  return json;
}

void print_text(const InfoOptions& options, const LoadedScene& loaded, const Json& json) {
  const Aabb& box = loaded.scene.bounds();
  const auto row = [](std::string_view label, const std::string& value) { fmt::print("{:<14} {}\n", label, value); };
  row("scene", options.scene);
  for (const auto& [label, key] :
       {std::pair{"objects", "objects"}, std::pair{"triangles", "triangles"},
        std::pair{"unique meshes", "unique_meshes"}, std::pair{"closed meshes", "closed_meshes"}})
    row(label, fmt::to_string(json[key].get<std::uint64_t>()));
  row("bounds", box.empty() ? "none"
                            : fmt::format("({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, {:.3f}) m", box.lo.x, box.lo.y,
                                          box.lo.z, box.hi.x, box.hi.y, box.hi.z));
  row("cells", fmt::to_string(loaded.scene.cells().size()));
  row("portals", fmt::to_string(loaded.scene.portals().size()));
  row("cameras", fmt::to_string(loaded.cameras.size()));
  for (const auto& camera : loaded.cameras)
    fmt::print("  {}: {}\n", camera.name.empty() ? "(no name)" : camera.name, describe(camera.view));
  row("warnings", fmt::to_string(loaded.warnings.size()));
  for (const std::string& warning : loaded.warnings) fmt::print("  {}\n", warning);
  row("load time", fmt::format("{:.1f} ms", json["load_ms"].get<double>()));
}

}  // namespace

int run_info(const InfoOptions& options) {
  JsonOutput output(options.common);
  CommonOptions silent = options.common;
  silent.quiet = true;  // the warnings are part of the answer
  const auto start = std::chrono::steady_clock::now();
  const LoadedScene loaded = open_scene(options.scene, silent);
  const double load_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const Json json = info_json(options, loaded, load_ms);
  if (!options.common.stdout_taken) print_text(options, loaded, json);
  output.write(json);
  return exit_ok;
}

}  // namespace sightline::cli
