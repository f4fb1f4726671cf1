#include "camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene_argument.hpp"

namespace sightline::cli {
namespace {

double diagonal(const Scene& scene) {
  return scene.bounds().empty() ? 1.0 : glm::length(glm::dvec3(scene.bounds().extent()));
}

/// A far plane at this distance holds the scene whatever way a camera at `eye` looks.
double reach_from(const glm::dvec3& eye, const Scene& scene) {
  if (scene.bounds().empty()) return 1.0;
  const glm::dvec3 farthest =
      glm::max(glm::abs(glm::dvec3(scene.bounds().lo) - eye), glm::abs(glm::dvec3(scene.bounds().hi) - eye));
  return 1.001 * glm::length(farthest);
}

CameraPath views_of(const std::string& path, const Scene& scene, const PathConfig& config) {
  if (path.empty()) return generate_path(scene, config);
  return path == "stress" ? stress_path(scene, config) : read_path(path, config);
}

}  // namespace

View prototype_view(const CameraOptions& options, const Scene& scene) {
  View view;
  view.width = options.width;
  view.height = options.height;
  view.fov_y = glm::radians(options.fov);
  if (options.ortho) {
    view.projection = Projection::orthographic;
    view.span_y = *options.ortho;
  }
  view.near = options.near.value_or(std::clamp(1e-4 * diagonal(scene), 0.01, 0.1));
  view.far = options.far.value_or(std::max(2.0 * diagonal(scene), 2.0 * view.near));
  if (!(view.near < view.far))
    throw UsageError(fmt::format("--near {} must be less than --far {}", view.near, view.far));
  as_usage([&] { check_view(view); });
  return view;
}

void contain_scene(View& view, const CameraOptions& options, const Scene& scene) {
  if (!options.far) view.far = std::max(reach_from(view.eye, scene), 2.0 * view.near);
}

CameraPath open_path(const PathOptions& path, const CameraOptions& options, const Scene& scene, std::uint64_t seed) {
  PathConfig config;
  config.frames = path.frames;
  config.prototype = prototype_view(options, scene);
  config.seed = seed;
  CameraPath result = views_of(path.path, scene, config);
  if (options.far) return result;
  double far = 2.0 * config.prototype.near;
  for (const View& view : result.views) far = std::max(far, reach_from(view.eye, scene));
  for (View& view : result.views)
    if (view.far == config.prototype.far) view.far = far;
  return result;
}

namespace {

constexpr std::string_view camera_word = "camera";

/// The name of the camera that --path asks for, empty for the first; nothing if it asks for something else.
std::optional<std::string> wanted_camera(const std::string& path) {
  if (path == camera_word) return "";
  if (path.starts_with("camera:")) return path.substr(camera_word.size() + 1);
  return std::nullopt;
}

/// The standing cameras of that name, all for no name.
std::vector<View> standing_views(const LoadedScene& loaded, const std::string& name) {
  std::vector<View> views;
  std::string names;
  for (const LoadedScene::NamedView& camera : loaded.cameras) {
    if (name.empty() || camera.name == name) views.push_back(camera.view);
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  if (views.empty())
    throw UsageError(loaded.cameras.empty()
                         ? "--path: the scene has no camera"
                         : fmt::format("--path: no camera is called '{}'; there are {}", name, names));
  return views;
}

CameraPath camera_path(const LoadedScene& loaded, const std::string& name, int frames, const View& prototype) {
  CameraPath path;
  const auto sized = [&](View view) {
    view.width = prototype.width;
    view.height = prototype.height;
    return view;
  };
  for (const LoadedScene::MovingView& camera : loaded.moving_cameras) {
    if (!name.empty() && camera.name != name) continue;
    for (int frame = 0; frame < frames; ++frame) {
      const double part = frames > 1 ? static_cast<double>(frame) / (frames - 1) : 0.0;
      path.views.push_back(sized(camera.at(camera.begin + part * (camera.end - camera.begin))));
    }
    return path;
  }
  const std::vector<View> views = standing_views(loaded, name);
  for (int frame = 0; frame < frames; ++frame)
    path.views.push_back(
        sized(views[static_cast<std::size_t>(frame) * views.size() / static_cast<std::size_t>(frames)]));
  return path;
}

}  // namespace

CameraPath open_path(const PathOptions& path, const CameraOptions& options, const LoadedScene& loaded,
                     std::uint64_t seed) {
  const std::optional<std::string> camera = wanted_camera(path.path);
  if (!camera) return open_path(path, options, loaded.scene, seed);
  return camera_path(loaded, *camera, path.frames, prototype_view(options, loaded.scene));
}

View placed_view(const glm::dvec3& eye, const glm::dvec3& look, const CameraOptions& options, const Scene& scene) {
  const View oriented = look_along(eye, look);
  View view = prototype_view(options, scene);
  view.eye = oriented.eye;
  view.orientation = oriented.orientation;
  contain_scene(view, options, scene);
  as_usage([&] { check_view(view); });
  return view;
}

View single_view(const ViewOptions& options, const LoadedScene& loaded, std::uint64_t seed) {
  const Scene& scene = loaded.scene;
  if (!options.eye) {
    const CameraPath path = open_path(options.path, options.camera, loaded, seed);
    if (static_cast<std::size_t>(options.frame) >= path.views.size())
      throw UsageError(fmt::format("--frame: {} is beyond the last frame, {}", options.frame, path.views.size() - 1));
    return path.views[static_cast<std::size_t>(options.frame)];
  }
  return placed_view(*options.eye, options.look, options.camera, scene);
}

}  // namespace sightline::cli
