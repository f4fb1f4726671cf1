#include "sightline/geometry/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace sightline {

namespace {

using Corner = std::uint32_t;

/// Twice the signed area of a triangle in the plane.
double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Not normalised; zero for a polygon without area.
glm::dvec3 newell_normal(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0.0);
  const glm::dvec3 origin(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += glm::cross(glm::dvec3(corners[i]) - origin, glm::dvec3(corners[(i + 1) % corners.size()]) - origin);
  }
  return normal;
}

/// The corners seen along the largest axis of the normal, counter-clockwise.
std::vector<glm::dvec2> project(std::span<const glm::vec3> corners) {
  const glm::dvec3 normal = newell_normal(corners);
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const int u = normal[axis] >= 0.0 ? (axis + 1) % 3 : (axis + 2) % 3;
  const int v = 3 - axis - u;
  std::vector<glm::dvec2> points;
  points.reserve(corners.size());
  for (const glm::vec3& corner : corners) points.emplace_back(corner[u], corner[v]);
  return points;
}

/// Every corner turns left and the turns add up to one round.
bool is_convex(std::span<const glm::dvec2> points) {
  double turned = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec2 in = points[(i + 1) % points.size()] - points[i];
    const glm::dvec2 out = points[(i + 2) % points.size()] - points[(i + 1) % points.size()];
    const double cross = in.x * out.y - in.y * out.x;
    if (!(cross > 0.0)) return false;
    turned += std::atan2(cross, glm::dot(in, out));
  }
  return turned < 7.0;  // 2 pi, not 4 pi
}

class EarClipper {
 public:
  explicit EarClipper(std::span<const glm::dvec2> points) : points_(points), ring_(points.size()) {
    std::iota(ring_.begin(), ring_.end(), Corner{0});
  }

  std::vector<glm::uvec3> clip() {
    std::vector<glm::uvec3> triangles;
    triangles.reserve(points_.size() - 2);
    std::size_t at = 0;
    while (ring_.size() > 3) {
      at = next_ear(at);
      triangles.push_back(triangle_at(at));
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    triangles.push_back({ring_[0], ring_[1], ring_[2]});
    return triangles;
  }

 private:
  [[nodiscard]] glm::uvec3 triangle_at(std::size_t at) const {
    const std::size_t n = ring_.size();
    return {ring_[(at + n - 1) % n], ring_[at % n], ring_[(at + 1) % n]};
  }

  /// The next ear from position `from`; where there is none (the polygon crosses itself), the flattest corner.
  [[nodiscard]] std::size_t next_ear(std::size_t from) const {
    std::size_t flattest = from % ring_.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const std::size_t at = (from + i) % ring_.size();
      const glm::uvec3 t = triangle_at(at);
      const double size = area(points_[t.x], points_[t.y], points_[t.z]);
      if (size > 0.0 && is_free(t)) return at;
      if (std::abs(size) < least) {
        least = std::abs(size);
        flattest = at;
      }
    }
    return flattest;
  }

  /// No other corner lies in the triangle or on its border; corners at the place of one of its own do not count.
  [[nodiscard]] bool is_free(const glm::uvec3& t) const {
    const glm::dvec2 &a = points_[t.x], &b = points_[t.y], &c = points_[t.z];
    return std::ranges::none_of(ring_, [&](Corner other) {
      const glm::dvec2& p = points_[other];
      if (p == a || p == b || p == c) return false;
      return area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
    });
  }

  std::span<const glm::dvec2> points_;
  std::vector<Corner> ring_;  // corners that are left, in order
};

}  // namespace

std::vector<glm::uvec3> triangulate_polygon(std::span<const glm::vec3> corners) {
  if (corners.size() < 3) return {};
  if (corners.size() == 3) return {{0, 1, 2}};
  const std::vector<glm::dvec2> points = project(corners);
  if (!is_convex(points)) {
    if (corners.size() > most_concave_corners) return {};
    return EarClipper(points).clip();
  }
  std::vector<glm::uvec3> triangles;
  triangles.reserve(corners.size() - 2);
  for (Corner i = 1; i + 1 < corners.size(); ++i) triangles.emplace_back(0u, i, i + 1);
  return triangles;
}

}  // namespace sightline
