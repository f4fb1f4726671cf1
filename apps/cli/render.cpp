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

void check_method(const std::string& method, Show show) {
  if (method == oracle_name) {
    if (show == Show::overdraw) throw UsageError("--show overdraw: the oracle writes no pixel twice");
    return;
  }
  as_usage([&] { (void)find_algorithm(parse_method(method).name, Family::renderer); });
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

/// Draws all objects; returns what the work was.
Counters draw(const std::string& method, Show show, const Scene& scene, const View& view, Frame& frame) {
  Counters counters;
  if (method == oracle_name) {
    Oracle(scene).draw(view, frame);
    return counters;
  }
  const IndexedScene indexed = index_scene(scene);
  const bool count = show == Show::overdraw && method.find(":overdraw=") == std::string::npos;
  const std::string text = method + (count ? ":overdraw=on" : "");
  const auto renderer = as_usage([&] { return make_renderer(text, indexed); });
  renderer->draw(view, VisibleSet::all(scene.objects().size()), frame, counters);
  if (show == Show::stencil) count_layers(scene, view, frame);
  return counters;
}

/// Pixels at which the two show another object; they become red in the picture.
std::size_t mark_differences(const Frame& frame, const Frame& other, Picture& picture) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.object.size(); ++i) {
    if (frame.object[i] == other.object[i]) continue;
    ++count;
    picture.rgb[3 * i] = 230;
    picture.rgb[3 * i + 1] = picture.rgb[3 * i + 2] = 30;
  }
  return count;
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
  check_method(options.method, options.show);
  if (!options.against.empty()) check_method(options.against, Show::object);
  OutputFile picture(options.output);
  JsonOutput output(options.common);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  const View view = single_view(options.view, loaded, options.common.seed);
  Frame frame;
  Progress progress("render", 1, options.common.quiet);
  const Counters counters = draw(options.method, options.show, loaded.scene, view, frame);
  Picture painted = paint(loaded.scene, view, frame, options.show);
  Json json = render_json(options, loaded.scene, view, frame, counters);
  if (!options.against.empty()) {
    Frame other;
    (void)draw(options.against, Show::object, loaded.scene, view, other);
    json["against"] = options.against;
    json["pixels_different"] = mark_differences(frame, other, painted);
  }
  picture.write(encode_png(painted));
  picture.commit();
  progress.show(1);
  if (options.common.prints())
    fmt::print("{}: {} objects seen, {} of {} pixels covered; {}\n", options.output,
               json["objects_seen"].get<std::size_t>(), json["pixels_covered"].get<std::size_t>(), frame.object.size(),
               describe(view));
  if (!options.against.empty() && options.common.prints())
    fmt::print("{} of {} pixels show another object than {} does\n", json["pixels_different"].get<std::size_t>(),
               frame.object.size(), options.against);
  output.write(json);
  return exit_ok;
}

}  // namespace sightline::cli
