#include "sightline/geometry/sphere.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <list>
#include <vector>

namespace sightline {
namespace {

struct Ball {
  glm::dvec3 centre{0.0};
  double squared = -1.0;
  [[nodiscard]] bool holds(const glm::dvec3& p) const {
    const glm::dvec3 d = p - centre;
    return glm::dot(d, d) <= squared * (1.0 + 1e-12) + 1e-300;
  }
};

/// The smallest ball with the given points on its surface; an empty one if they have none (dependent points).
Ball ball_through(std::span<const glm::dvec3> p) {
  if (p.empty()) return {};
  Ball ball{p[0], 0.0};
  const std::size_t k = p.size() - 1;
  if (k == 0) return ball;
  // centre = p0 + sum x_i (p_i - p0), equidistant: 2 (p_i - p0) . (p_j - p0) x_j = |p_i - p0|^2.
  std::array<std::array<double, 4>, 3> m{};
  for (std::size_t i = 0; i < k; ++i) {
    for (std::size_t j = 0; j < k; ++j) m[i][j] = 2.0 * glm::dot(p[i + 1] - p[0], p[j + 1] - p[0]);
    m[i][3] = glm::dot(p[i + 1] - p[0], p[i + 1] - p[0]);
  }
  for (std::size_t i = 0; i < k; ++i) {
    std::size_t best = i;
    for (std::size_t r = i + 1; r < k; ++r)
      if (std::abs(m[r][i]) > std::abs(m[best][i])) best = r;
    std::swap(m[i], m[best]);
    if (!(std::abs(m[i][i]) > 1e-14 * m[i][3]) || m[i][i] == 0.0) return {};
    for (std::size_t r = 0; r < k; ++r) {
      if (r == i) continue;
      const double f = m[r][i] / m[i][i];
      for (std::size_t c = i; c < 4; ++c) m[r][c] -= f * m[i][c];
    }
  }
  glm::dvec3 offset(0.0);
  for (std::size_t i = 0; i < k; ++i) offset += m[i][3] / m[i][i] * (p[i + 1] - p[0]);
  ball.centre = p[0] + offset;
  ball.squared = glm::dot(offset, offset);
  return ball;
}

/// Welzl's recursion with move to front: points [begin, end) of the list, `on` lie on the surface.
Ball welzl(std::list<glm::dvec3>& points, std::list<glm::dvec3>::iterator end, std::vector<glm::dvec3>& on) {
  Ball ball = ball_through(on);
  if (on.size() == 4) return ball;
  for (auto i = points.begin(); i != end;) {
    const auto here = i++;
    if (ball.holds(*here)) continue;
    on.push_back(*here);
    const Ball larger = welzl(points, here, on);
    on.pop_back();
    if (larger.squared >= ball.squared) ball = larger;
    points.splice(points.begin(), points, here);
  }
  return ball;
}

/// The float sphere about `centre` that holds all points for sure.
Sphere around(std::span<const glm::vec3> points, const glm::dvec3& centre) {
  Sphere sphere{glm::vec3(centre), 0.0f};
  double farthest = 0.0;
  for (const glm::vec3& p : points)
    farthest = std::max(farthest, glm::distance(glm::dvec3(p), glm::dvec3(sphere.centre)));
  sphere.radius = std::nextafter(static_cast<float>(farthest), std::numeric_limits<float>::infinity());
  return sphere;
}

}  // namespace

Sphere smallest_sphere(std::span<const glm::vec3> points) {
  if (points.empty()) return {};
  std::list<glm::dvec3> list;
  for (const glm::vec3& p : points) list.emplace_back(p);
  std::vector<glm::dvec3> on;
  return around(points, welzl(list, list.end(), on).centre);
}

Sphere ritter_sphere(std::span<const glm::vec3> points) {
  if (points.empty()) return {};
  const auto farthest_from = [&](const glm::dvec3& from) {
    glm::dvec3 best(points[0]);
    for (const glm::vec3& p : points)
      if (glm::distance(glm::dvec3(p), from) > glm::distance(best, from)) best = glm::dvec3(p);
    return best;
  };
  const glm::dvec3 a = farthest_from(glm::dvec3(points[0])), b = farthest_from(a);
  glm::dvec3 centre = 0.5 * (a + b);
  double radius = 0.5 * glm::distance(a, b);
  for (const glm::vec3& p : points) {
    const double distance = glm::distance(glm::dvec3(p), centre);
    if (distance <= radius) continue;
    const double grown = 0.5 * (radius + distance);
    centre += (glm::dvec3(p) - centre) * ((grown - radius) / distance);
    radius = grown;
  }
  return around(points, centre);
}

Containment classify(const Frustum& frustum, const Sphere& sphere) {
  if (sphere.radius < 0.0f) return Containment::outside;
  Containment result = Containment::inside;
  for (int i = 0; i < frustum.count; ++i) {
    const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
    const float distance = glm::dot(plane.normal, sphere.centre) + plane.offset;
    if (distance < -sphere.radius) return Containment::outside;
    if (distance < sphere.radius) result = Containment::intersecting;
  }
  return result;
}

}  // namespace sightline
