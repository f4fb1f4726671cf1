#include "sightline/geometry/ray_box.hpp"

namespace sightline {

std::optional<Passage> hit_box(const Ray& ray, const Aabb& box) {
  if (!is_ray(ray) || box.empty()) return std::nullopt;
  double enter = static_cast<double>(ray.t_near), leave = static_cast<double>(ray.t_far);
  for (int axis = 0; axis < 3; ++axis) {
    const double lo = static_cast<double>(box.lo[axis]) - static_cast<double>(ray.origin[axis]);
    const double hi = static_cast<double>(box.hi[axis]) - static_cast<double>(ray.origin[axis]);
    const double d = static_cast<double>(ray.direction[axis]);
    if (d == 0.0) {  // parallel to the slab: always or never inside of it
      if (lo > 0.0 || hi < 0.0) return std::nullopt;
      continue;
    }
    enter = std::max(enter, (d > 0.0 ? lo : hi) / d);
    leave = std::min(leave, (d > 0.0 ? hi : lo) / d);
  }
  if (!(enter <= leave)) return std::nullopt;
  return Passage{enter, leave};
}

}  // namespace sightline
