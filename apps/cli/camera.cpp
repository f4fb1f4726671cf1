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

View single_view(const ViewOptions& options, const Scene& scene, std::uint64_t seed) {
  if (!options.eye) {
    const CameraPath path = open_path(options.path, options.camera, scene, seed);
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

}  // namespace sightline::cli
