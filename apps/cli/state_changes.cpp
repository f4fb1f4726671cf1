#include "state_changes.hpp"

#include <cmath>

#include "camera.hpp"
#include "interrupt.hpp"
#include "line_plot.hpp"
#include "methods.hpp"
#include "scene_argument.hpp"
#ifdef SIGHTLINE_HAS_GL
#include "gl/registry.hpp"
#endif

namespace sightline::cli {

#ifdef SIGHTLINE_HAS_GL
Json measure_state_changes(const QueriesOptions& options) {
  const LoadedScene loaded = open_scene(options.scene, options.common);
  CameraOptions camera;
  camera.width = options.width;
  camera.height = options.height;
  const CameraPath path = open_path(options.path, camera, loaded.scene, options.common.seed);
  Json measured{{"schema", "sightline.state_changes/1"},
                {"scene", options.scene},
                {"frames", path.views.size()},
                {"methods", Json::array()}};
  try {
    gl::Context context;
    gl::SceneDrawing drawing(context, loaded.scene);
    gl::Target target;
    constexpr const char* names[] = {"gl_stop_and_wait", "gl_chc", "gl_chcpp"};
    std::size_t done = 0;
    Progress progress("frames", std::size(names) * path.views.size(), options.common.quiet);
    for (const char* name : names) {
      if (interrupted()) break;
      const auto method = gl::make_method(name, drawing);
      Json changes = Json::array(), queries = Json::array();
      for (const View& view : path.views) {
        gl::Work work;
        drawing.set_work(&work);
        method->frame(view, target);
        drawing.set_work(nullptr);
        changes.push_back(work.state_changes);
        queries.push_back(work.queries);
        progress.show(++done);
        if (interrupted()) break;
      }
      measured["methods"].push_back({{"method", name}, {"state_changes", changes}, {"queries", queries}});
    }
  } catch (const gl::Unavailable& error) {
    throw MethodUnavailable(error.what());
  }
  return measured;
}
#else
Json measure_state_changes(const QueriesOptions&) { throw MethodUnavailable("this program was built without OpenGL"); }
#endif

std::string state_changes_svg(const Json& measured) {
  LinePlot plot{
      "State changes: " + measured.at("scene").get<std::string>(), "frame", "log2(1 + state changes)", false, 0, 0, {}};
  for (const Json& method : measured.at("methods")) {
    PlotCurve curve{method.at("method").get<std::string>(), {}, false};
    double frame = 0.0;
    for (const Json& changes : method.at("state_changes"))
      curve.points.emplace_back(frame++, std::log2(1.0 + changes.get<double>()));
    plot.curves.push_back(std::move(curve));
  }
  return svg_of(plot);
}

}  // namespace sightline::cli
