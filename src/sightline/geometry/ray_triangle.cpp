#include "sightline/geometry/ray_triangle.hpp"

#include "sightline/geometry/ray_plane.hpp"

namespace sightline {
namespace {

/// The point where the ray meets the triangle's plane.
struct Meeting {
  double t;
  glm::dvec3 normal, point;
};

std::optional<Meeting> meet_plane(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  if (!is_ray(ray)) return std::nullopt;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double along = glm::dot(glm::dvec3(ray.direction), normal);
  if (along == 0.0 || !std::isfinite(along)) return std::nullopt;
  const double t = glm::dot(a - glm::dvec3(ray.origin), normal) / along;
  if (!(t >= static_cast<double>(ray.t_near) && t <= static_cast<double>(ray.t_far))) return std::nullopt;
  return Meeting{t, normal, point_at(ray, t)};
}

}  // namespace

std::optional<TriangleHit> hit_triangle_areas(const Ray& ray, const glm::vec3& fa, const glm::vec3& fb,
                                              const glm::vec3& fc, double tolerance) {
  const glm::dvec3 a(fa), b(fb), c(fc);
  const std::optional<Meeting> m = meet_plane(ray, a, b, c);
  if (!m) return std::nullopt;
  const auto area = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
    return glm::length(glm::cross(q - p, r - p));
  };
  const double whole = glm::length(m->normal);
  const double pbc = area(m->point, b, c), apc = area(a, m->point, c), abp = area(a, b, m->point);
  const double sum = pbc + apc + abp;
  if (!(sum <= whole * (1.0 + tolerance))) return std::nullopt;
  return TriangleHit{m->t, pbc / sum, apc / sum, abp / sum};
}

std::optional<TriangleHit> hit_triangle_barycentric(const Ray& ray, const glm::vec3& fa, const glm::vec3& fb,
                                                    const glm::vec3& fc) {
  const glm::dvec3 a(fa), b(fb), c(fc);
  const std::optional<Meeting> m = meet_plane(ray, a, b, c);
  if (!m) return std::nullopt;
  const double whole = glm::dot(m->normal, m->normal);
  // D(P, Q, R) = ((Q - P) x (R - P)) . N / |N|; the length of N drops out of the quotients (E23).
  const double alpha = glm::dot(glm::cross(b - m->point, c - m->point), m->normal) / whole;
  const double beta = glm::dot(glm::cross(c - m->point, a - m->point), m->normal) / whole;
  const double gamma = 1.0 - alpha - beta;
  if (!(alpha >= 0.0 && beta >= 0.0 && gamma >= 0.0)) return std::nullopt;
  return TriangleHit{m->t, alpha, beta, gamma};
}

std::optional<TriangleHit> hit_triangle_watertight(const Ray& ray, const glm::vec3& a, const glm::vec3& b,
                                                   const glm::vec3& c) {
  ShearedHit hit{};
  if (!is_ray(ray) || !hit_sheared(shear_of(ray.origin, ray.direction), &a.x, &b.x, &c.x, hit)) return std::nullopt;
  if (!(hit.t >= static_cast<double>(ray.t_near) && hit.t <= static_cast<double>(ray.t_far))) return std::nullopt;
  const double sum = hit.u + hit.v + hit.w;
  return TriangleHit{hit.t, hit.u / sum, hit.v / sum, hit.w / sum};
}

}  // namespace sightline
