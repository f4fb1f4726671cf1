// Views that algorithms must survive though nobody would walk there; see camera_path.hpp.
#include <algorithm>
#include <cmath>

#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

class Stress {
 public:
  Stress(const Scene& scene, const PathConfig& config)
      : scene_(scene), config_(config), random_(config.seed, 9), bounds_(scene.bounds()) {
    for (ObjectId id = 0; id < scene.objects().size(); ++id)
      if (!scene.mesh_of(id).triangles.empty()) solid_.push_back(id);
    size_ = std::max(glm::length(glm::dvec3(bounds_.extent())), 1e-6);
  }

  // The kinds come in turn, so that every path of ten frames holds all of them.
  View next(int frame) {
    // One draw a statement: the order in which a call's arguments are made is the compiler's choice.
    const glm::dvec3 direction = random_.direction();
    const double far_away = random_.range(0.6, 3.0);
    const bool up = random_.chance(0.5);
    const glm::dvec3 centre(bounds_.centre());
    switch (frame % 10) {
      case 0:
        return aim(anywhere(), direction);
      case 1:
      case 2:
        return aim(last_.eye, -view_direction(last_) + 0.3 * direction);
      case 3:
        return touching(0.5);
      case 4:
        return touching(1e-3);
      case 5:
        return aim(in_box_of_object(), direction);
      case 6:
        return behind_surface(direction);
      case 7:
        return aim(centre + direction * (size_ * far_away), -direction);
      case 8:
        return aim(anywhere(), {0, up ? 1.0 : -1.0, 0});
      default:
        return on_corner();
    }
  }

 private:
  View aim(const glm::dvec3& eye, glm::dvec3 direction) {
    if (!(glm::dot(direction, direction) > 0)) direction = {0, 0, -1};
    // A look along the vertical axis has no natural up.
    const bool vertical =
        direction.x * direction.x + direction.z * direction.z < 1e-12 * glm::dot(direction, direction);
    const View aimed = look_along(eye, direction, vertical ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0));
    last_ = config_.prototype;
    last_.eye = aimed.eye;
    last_.orientation = aimed.orientation;
    return last_;
  }

  glm::dvec3 in_box(const Aabb& box) {
    const double x = random_.uniform(), y = random_.uniform(), z = random_.uniform();
    return glm::dvec3(box.lo) + glm::dvec3(box.extent()) * glm::dvec3(x, y, z);
  }
  glm::dvec3 anywhere() { return in_box(bounds_); }
  ObjectId any_object() { return solid_[random_.below(static_cast<std::uint32_t>(solid_.size()))]; }
  glm::dvec3 in_box_of_object() { return in_box(scene_.objects()[any_object()].bounds); }

  // A point of a triangle of any object with the triangle's unit normal.
  struct SurfacePoint {
    glm::dvec3 position, normal, corner;
  };
  SurfacePoint surface_point() {
    const ObjectId id = any_object();
    const Object& object = scene_.objects()[id];
    const Mesh& mesh = scene_.mesh_of(id);
    const glm::uvec3 t = mesh.triangles[random_.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
    glm::dvec3 p[3];
    for (int i = 0; i < 3; ++i) p[i] = transform_point(object.transform, mesh.positions[t[i]]);
    double u = random_.uniform(), v = random_.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (determinant(object.transform) < 0) normal = -normal;
    const double length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::dvec3(0, 1, 0);
    return {p[0] + (p[1] - p[0]) * u + (p[2] - p[0]) * v, normal, p[0]};
  }

  // In front of a surface, `share` of the near plane's distance from it, looking at it, along it or away from it.
  View touching(double share) {
    const SurfacePoint point = surface_point();
    const glm::dvec3 eye = point.position + point.normal * (share * config_.prototype.near);
    const glm::dvec3 sideways = glm::cross(point.normal, random_.direction());
    const double kind = random_.uniform();
    return aim(eye, kind < 0.4 ? sideways : kind < 0.7 ? -point.normal + sideways : point.normal + sideways);
  }

  // Just behind a surface: inside of the object if it is closed.
  View behind_surface(const glm::dvec3& direction) {
    const SurfacePoint point = surface_point();
    const double share = random_.uniform();
    const double depth = std::max(0.02 * size_ * share * share, 1e-4 * config_.prototype.near);
    return aim(point.position - point.normal * depth, direction);
  }

  // Exactly on a vertex, looking along an axis.
  View on_corner() {
    const glm::dvec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
    const glm::dvec3 corner = surface_point().corner;
    return aim(corner, axes[random_.below(4)]);
  }

  const Scene& scene_;
  const PathConfig& config_;
  Random random_;
  Aabb bounds_;
  std::vector<ObjectId> solid_;
  double size_ = 1.0;
  View last_;
};

}  // namespace

CameraPath stress_path(const Scene& scene, const PathConfig& config) {
  if (config.frames < 1) throw InputError("a camera path needs at least one frame");
  check_view(config.prototype);
  if (scene.triangle_count() == 0) throw InputError("there is no way through a scene without triangles");
  Stress stress(scene, config);
  CameraPath path;
  for (int i = 0; i < config.frames; ++i) path.views.push_back(stress.next(i));
  return path;
}

}  // namespace sightline
