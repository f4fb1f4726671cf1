// sightline render: one view as a picture.
#include <fmt/format.h>

#include <chrono>

#include "camera.hpp"
#include "json_output.hpp"
#include "picture.hpp"
#include "scene_argument.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

constexpr std::string_view oracle_name = "oracle";

void check_method(const RenderOptions& options) {
  if (options.method == oracle_name) return;
  as_usage([&] { (void)find_algorithm(parse_method(options.method).name, Family::renderer); });
}

/// Draws all objects; returns what the work was.
Counters draw(const RenderOptions& options, const Scene& scene, const View& view, Frame& frame) {
  Counters counters;
  if (options.method == oracle_name) {
    Oracle(scene).draw(view, frame);
    return counters;
  }
  const IndexedScene indexed = index_scene(scene);
  const auto renderer = as_usage([&] { return make_renderer(options.method, indexed); });
  renderer->draw(view, VisibleSet::all(scene.objects().size()), frame, counters);
  return counters;
}

Json render_json(const RenderOptions& options, const Scene& scene, const View& view, const Frame& frame,
                 const Counters& counters) {
  VisibleSet seen(scene.objects().size());
  std::size_t covered = 0;
  for (const ObjectId id : frame.object) {
    if (id == no_object) continue;
    seen.insert(id);
    ++covered;
  }
  const glm::dvec3 look = view_direction(view);
  Json json{{"schema", "sightline.render/1"},
            {"output", options.output},
            {"method", options.method},
            {"size", {view.width, view.height}},
            {"eye", {view.eye.x, view.eye.y, view.eye.z}},
            {"look", {look.x, look.y, look.z}},
            {"objects_seen", seen.count()},
            {"pixels_covered", covered}};
  Json& work = json["counters"] = Json::object();
  counters.each([&](const char* name, std::uint64_t value) { work[name] = value; });
  return json;
}

}  // namespace

int run_render(const RenderOptions& options) {
  check_method(options);
  OutputFile picture(options.output);
  JsonOutput output(options.common);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  const View view = single_view(options.view, loaded, options.common.seed);
  Frame frame;
  Progress progress("render", 1, options.common.quiet);
  const Counters counters = draw(options, loaded.scene, view, frame);
  picture.write(encode_png(paint(loaded.scene, view, frame, options.show)));
  picture.commit();
  progress.show(1);
  const Json json = render_json(options, loaded.scene, view, frame, counters);
  if (!options.common.json_to_stdout() && !options.common.quiet && options.output != "-")
    fmt::print("{}: {} objects seen, {} of {} pixels covered; {}\n", options.output,
               json["objects_seen"].get<std::size_t>(), json["pixels_covered"].get<std::size_t>(), frame.object.size(),
               describe(view));
  output.write(json);
  return exit_ok;
}

}  // namespace sightline::cli
