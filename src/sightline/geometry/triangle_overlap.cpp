#include "sightline/geometry/triangle_overlap.hpp"

#include <cmath>

namespace sightline {
namespace {

/// True if the axis parts the triangle (corners relative to the box's centre) from the box.
bool parts(const glm::dvec3& axis, const glm::dvec3* p, const glm::dvec3& half) {
  const double a = glm::dot(axis, p[0]), b = glm::dot(axis, p[1]), c = glm::dot(axis, p[2]);
  const double reach_of_box = glm::dot(glm::abs(axis), half);
  return std::min({a, b, c}) > reach_of_box || std::max({a, b, c}) < -reach_of_box;
}

}  // namespace

bool triangle_touches_box(const glm::vec3* corners, const Aabb& box, double margin) {
  if (box.empty()) return false;
  const glm::dvec3 lo(box.lo), hi(box.hi), centre = 0.5 * (lo + hi), half = 0.5 * (hi - lo) + margin;
  const glm::dvec3 p[3] = {glm::dvec3(corners[0]) - centre, glm::dvec3(corners[1]) - centre,
                           glm::dvec3(corners[2]) - centre};
  for (int axis = 0; axis < 3; ++axis)
    if (std::min({p[0][axis], p[1][axis], p[2][axis]}) > half[axis] ||
        std::max({p[0][axis], p[1][axis], p[2][axis]}) < -half[axis])
      return false;
  const glm::dvec3 edges[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  if (parts(glm::cross(edges[0], edges[1]), p, half)) return false;
  for (const glm::dvec3& e : edges)
    if (parts({0.0, -e.z, e.y}, p, half) || parts({e.z, 0.0, -e.x}, p, half) || parts({-e.y, e.x, 0.0}, p, half))
      return false;
  return true;
}

bool triangle_touches_frustum(const glm::vec3* corners, const Frustum& frustum) {
  glm::dvec3 polygon[2][10];
  int count = 3, now = 0;
  for (int i = 0; i < 3; ++i) polygon[0][i] = glm::dvec3(corners[i]);
  for (int plane = 0; plane < frustum.count; ++plane) {
    const Plane& p = frustum.planes[static_cast<std::size_t>(plane)];
    const glm::dvec3 normal(p.normal);
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 a = polygon[now][i], b = polygon[now][(i + 1) % count];
      const double da = glm::dot(normal, a) + static_cast<double>(p.offset);
      const double db = glm::dot(normal, b) + static_cast<double>(p.offset);
      if (da >= 0.0) polygon[1 - now][kept++] = a;
      if ((da >= 0.0) != (db >= 0.0)) polygon[1 - now][kept++] = a + (da / (da - db)) * (b - a);
    }
    now = 1 - now;
    count = kept;
    if (count == 0) return false;
  }
  return true;
}

}  // namespace sightline
