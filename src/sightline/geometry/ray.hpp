// A ray and a hit, and what counts as a ray at all (checklist 13.04 with E23: the direction is a direction, not a
// point).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace sightline {

/// Points origin + t * direction for t in [t_near, t_far]. The direction need not be of unit length: t counts in its
/// lengths, so that with direction = b - a the segment from a to b is [0, 1].
struct Ray {
  glm::vec3 origin{0.0f};
  float t_near = 0.0f;
  glm::vec3 direction{0.0f, 0.0f, -1.0f};
  float t_far = std::numeric_limits<float>::infinity();
};

/// Lengths of directions (largest component) for which float arithmetic on rays holds.
inline constexpr float shortest_direction = 1e-15f, longest_direction = 1e15f;

/// |v|. glm::abs of GCC 12 branches on each sign, which is another one for every ray.
inline glm::vec3 magnitudes(const glm::vec3& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

/// False for what no intersection is defined of, and which therefore meets nothing: a NaN anywhere, an origin that is
/// not finite, a direction without length (or one that squares out of a float), an interval that is empty.
inline bool is_ray(const Ray& ray) {
  const glm::vec3 d = magnitudes(ray.direction);
  const float longest = std::max({d.x, d.y, d.z});
  return std::isfinite(ray.origin.x) && std::isfinite(ray.origin.y) && std::isfinite(ray.origin.z) &&
         std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z) && longest >= shortest_direction &&
         longest <= longest_direction && ray.t_near <= ray.t_far && ray.t_near < std::numeric_limits<float>::infinity();
}

inline glm::dvec3 point_at(const Ray& ray, double t) { return glm::dvec3(ray.origin) + t * glm::dvec3(ray.direction); }

}  // namespace sightline
