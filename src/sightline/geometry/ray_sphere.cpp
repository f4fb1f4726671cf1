#include "sightline/geometry/ray_sphere.hpp"

namespace sightline {

Crossings hit_sphere(const Ray& ray, const glm::vec3& centre, float radius) {
  Crossings result;
  if (!is_ray(ray) || !(radius >= 0.0f) || !std::isfinite(radius)) return result;
  const glm::dvec3 v(ray.direction), from = glm::dvec3(ray.origin) - glm::dvec3(centre);
  const double a = glm::dot(v, v), half_b = glm::dot(v, from);
  const double squared = static_cast<double>(radius) * static_cast<double>(radius);
  // The discriminant from the point of the line nearest to the centre: the slide's b^2 - 4ac cancels far away.
  const glm::dvec3 nearest = from - (half_b / a) * v;
  const double discriminant = a * (squared - glm::dot(nearest, nearest));
  if (!(discriminant >= 0.0)) return result;
  const double c = glm::dot(from, from) - squared;
  const double root = std::sqrt(discriminant);
  const double q = half_b < 0.0 ? -half_b + root : -half_b - root;
  double first = q / a, second = q == 0.0 ? 0.0 : c / q;
  if (second < first) std::swap(first, second);
  for (const double t : {first, second}) {
    if (!(t >= static_cast<double>(ray.t_near) && t <= static_cast<double>(ray.t_far))) continue;
    if (result.count == 1 && result.t[0] == t) continue;
    result.t[result.count++] = t;
  }
  return result;
}

}  // namespace sightline
