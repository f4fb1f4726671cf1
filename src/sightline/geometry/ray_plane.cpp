#include "sightline/geometry/ray_plane.hpp"

namespace sightline {
namespace {

bool within(const Ray& ray, double t) {
  return t >= static_cast<double>(ray.t_near) && t <= static_cast<double>(ray.t_far);
}

std::optional<double> meet(const Ray& ray, const glm::dvec3& point, const glm::dvec3& normal) {
  if (!is_ray(ray)) return std::nullopt;
  const double along = glm::dot(glm::dvec3(ray.direction), normal);
  if (along == 0.0 || !std::isfinite(along)) return std::nullopt;
  const double t = glm::dot(point - glm::dvec3(ray.origin), normal) / along;
  if (!within(ray, t)) return std::nullopt;
  return t;
}

/// Twice the polygon's area as a vector (Newell), from the first corner for accuracy.
glm::dvec3 newell_normal(std::span<const glm::vec3> corners) {
  glm::dvec3 sum(0.0);
  const glm::dvec3 base(corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += glm::cross(glm::dvec3(corners[i]) - base, glm::dvec3(corners[i + 1]) - base);
  return sum;
}

}  // namespace

std::optional<double> hit_plane(const Ray& ray, const glm::vec3& point, const glm::vec3& normal) {
  return meet(ray, glm::dvec3(point), glm::dvec3(normal));
}

std::optional<double> hit_polygon(const Ray& ray, std::span<const glm::vec3> corners) {
  if (corners.size() < 3) return std::nullopt;
  const glm::dvec3 normal = newell_normal(corners);
  const std::optional<double> t = meet(ray, glm::dvec3(corners[0]), normal);
  if (!t) return std::nullopt;
  // Winding number of the projection along the largest component of the normal; a point on an edge is inside.
  const glm::dvec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int x = (drop + 1) % 3, y = (drop + 2) % 3;
  const glm::dvec3 p = point_at(ray, *t);
  int winding = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - p, b = glm::dvec3(corners[(i + 1) % corners.size()]) - p;
    const double side = a[x] * b[y] - a[y] * b[x];
    const bool up = a[y] <= 0.0 && b[y] > 0.0, down = a[y] > 0.0 && b[y] <= 0.0;
    if (side == 0.0 && a[x] * b[x] + a[y] * b[y] <= 0.0) return t;
    if (up && side > 0.0) ++winding;
    if (down && side < 0.0) --winding;
  }
  if (winding == 0) return std::nullopt;
  return t;
}

}  // namespace sightline
