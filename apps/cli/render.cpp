// sightline render: one view as a picture.
#include <fmt/format.h>

#include <chrono>

#include "camera.hpp"
#include "json_output.hpp"
#include "picture.hpp"
#include "scene_argument.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/raster/scene_draw.hpp"
#include "sightline/registry.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

constexpr std::string_view oracle_name = "oracle";

void check_method(const RenderOptions& options) {
  if (options.method == oracle_name) {
    if (options.show == Show::overdraw) throw UsageError("--show overdraw: the oracle writes no pixel twice");
    return;
  }
  as_usage([&] { (void)find_algorithm(parse_method(options.method).name, Family::renderer); });
}

/// The layers over each pixel, counted by the stencil buffer: every fragment increments, nothing is tested.
void count_layers(const Scene& scene, const View& view, Frame& frame) {
  raster::SceneDraw what;
  what.state.depth.enabled = false;
  what.state.color_mask = {false, false, false, false};
  what.state.stencil.enabled = true;
  what.state.stencil.front.zpass = what.state.stencil.back.zpass = raster::StencilOp::incr;
  raster::Target target(view.width, view.height);
  raster::DrawCounts counts;
  raster::draw_scene(scene, view, VisibleSet::all(scene.objects().size()).order(), what, target, counts);
  frame.stencil = target.stencil;
}

}  // namespace

View view_of(const RenderOptions& options, const Scene& scene) {
  if (!options.eye) {
    const CameraPath path = open_path(options.path, options.camera, scene, options.common.seed);
    if (static_cast<std::size_t>(options.frame) >= path.views.size())
      throw UsageError(fmt::format("--frame: {} is beyond the last frame, {}", options.frame, path.views.size() - 1));
    return path.views[static_cast<std::size_t>(options.frame)];
  }
  const View oriented = look_along(*options.eye, options.look);
  View view = prototype_view(options.camera, scene);
  view.eye = oriented.eye;
  view.orientation = oriented.orientation;
  contain_scene(view, options.camera, scene);
  as_usage([&] { check_view(view); });
  return view;
}

namespace {

/// Draws all objects; returns what the work was.
Counters draw(const RenderOptions& options, const Scene& scene, const View& view, Frame& frame) {
  Counters counters;
  if (options.method == oracle_name) {
    Oracle(scene).draw(view, frame);
    return counters;
  }
  const IndexedScene indexed = index_scene(scene);
  const bool count = options.show == Show::overdraw && options.method.find(":overdraw=") == std::string::npos;
  const std::string method = options.method + (count ? ":overdraw=on" : "");
  const auto renderer = as_usage([&] { return make_renderer(method, indexed); });
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
  const View view = view_of(options, loaded.scene);
  Frame frame;
  const Counters counters = draw(options, loaded.scene, view, frame);
  if (options.show == Show::stencil) count_layers(loaded.scene, view, frame);
  picture.write(encode_png(paint(loaded.scene, view, frame, options.show)));
  picture.commit();
  const Json json = render_json(options, loaded.scene, view, frame, counters);
  if (!options.common.json_to_stdout() && !options.common.quiet && options.output != "-")
    fmt::print("{}: {} objects seen, {} of {} pixels covered; {}\n", options.output,
               json["objects_seen"].get<std::size_t>(), json["pixels_covered"].get<std::size_t>(), frame.object.size(),
               describe(view));
  output.write(json);
  return exit_ok;
}

}  // namespace sightline::cli
