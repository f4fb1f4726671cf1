// sightline view: the viewer in a window, or one picture of it without a display.
#include <fmt/format.h>

#include "camera.hpp"
#include "explain.hpp"
#include "json_output.hpp"
#include "methods.hpp"
#include "output.hpp"
#include "picture.hpp"
#include "scene_argument.hpp"
#include "sightline/oracle/explain.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "verbs.hpp"
#ifdef SIGHTLINE_VIEWER
#include "viewer/viewer.hpp"
#endif

namespace sightline::cli {

#ifdef SIGHTLINE_VIEWER
namespace {

const std::vector<std::string> usual_methods{"occlusion_masked", "gl_chcpp", "gl_chc", "frustum_hierarchical", "none"};

/// Answers clicks; the rays are prepared at the first one.
class Answers {
 public:
  explicit Answers(const Scene& scene) : scene_(scene) {}
  std::string operator()(const View& view, ObjectId id, const std::string& method, bool reported) {
    if (!oracle_) oracle_ = std::make_unique<Oracle>(scene_);
    Judgement judgement{method, Promise::approximate, reported,
                        explain(scene_, *oracle_, oracle_->look(view), view, id)};
    if (!judgement.why.contradiction.empty()) return "not confirmed: " + judgement.why.contradiction;
    return explanation_text(scene_, view, judgement);
  }

 private:
  const Scene& scene_;
  std::unique_ptr<Oracle> oracle_;
};

viewer::SessionConfig session_of(const ViewerOptions& options, const LoadedScene& loaded) {
  viewer::SessionConfig config;
  config.scene_argument = options.scene;
  config.methods = options.methods.empty() ? usual_methods : options.methods;
  config.start = single_view(options.view, loaded, options.common.seed);
  if (!options.view.eye) {
    config.path = open_path(options.view.path, options.view.camera, loaded, options.common.seed).views;
    config.path_frame = static_cast<std::size_t>(options.view.frame);
  }
  return config;
}

}  // namespace

int run_view(const ViewerOptions& options) {
  const int width = options.view.camera.width, height = options.view.camera.height;
  for (const std::string& method : options.methods)
    as_usage([&] { (void)find_method(parse_method(method).name, Family::culler); });
  if (options.click && (options.click->first >= width || options.click->second >= height))
    throw UsageError(fmt::format("--click: {},{} lies outside of {}x{} pixels", options.click->first,
                                 options.click->second, width, height));
  JsonOutput output(options.common);
  std::optional<OutputFile> file;
  if (!options.screenshot.empty()) file.emplace(options.screenshot);
  const LoadedScene loaded = open_scene(options.scene, options.common);
  const IndexedScene indexed = index_scene(loaded.scene);
  viewer::SessionConfig config = session_of(options, loaded);
  const auto answers = std::make_shared<Answers>(loaded.scene);
  config.explain = [answers](const View& view, ObjectId id, const std::string& method, bool reported) {
    return (*answers)(view, id, method, reported);
  };
  const View start = config.start;
  try {
    if (!file) {
      as_usage([&] { viewer::run_window(std::move(config), indexed, width, height); });
      return exit_ok;
    }
    viewer::PictureConfig picture{.width = width, .height = height, .press = options.press};
    if (options.click) std::tie(picture.click_x, picture.click_y) = *options.click;
    const auto rgb = as_usage([&] { return viewer::picture_of(std::move(config), indexed, picture); });
    file->write(encode_png({width, height, rgb}));
    file->commit();
  } catch (const gl::Unavailable& error) {
    throw MethodUnavailable(error.what());
  }
  if (options.common.prints()) fmt::print("{}\n", options.screenshot);
  const glm::dvec3 look = view_direction(start);
  output.write({{"schema", "sightline.view/1"},
                {"scene", options.scene},
                {"output", options.screenshot},
                {"size", {width, height}},
                {"eye", {start.eye.x, start.eye.y, start.eye.z}},
                {"look", {look.x, look.y, look.z}}});
  return exit_ok;
}

#else

int run_view(const ViewerOptions& /*options*/) {
  throw UsageError("this program was built without the viewer (SIGHTLINE_VIEWER)");
}

#endif

}  // namespace sightline::cli
