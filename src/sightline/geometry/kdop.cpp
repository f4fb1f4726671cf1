#include "sightline/geometry/kdop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sightline {
namespace {

constexpr std::array<glm::vec3, 7> directions_14{
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}}};
constexpr std::array<glm::vec3, 9> directions_18{
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}}};
constexpr std::array<glm::vec3, 13> directions_26{{{1, 0, 0},
                                                   {0, 1, 0},
                                                   {0, 0, 1},
                                                   {1, 1, 1},
                                                   {1, 1, -1},
                                                   {1, -1, 1},
                                                   {-1, 1, 1},
                                                   {1, 1, 0},
                                                   {1, -1, 0},
                                                   {1, 0, 1},
                                                   {1, 0, -1},
                                                   {0, 1, 1},
                                                   {0, 1, -1}}};

struct HalfSpace {
  glm::dvec3 normal;
  double offset;  // inside: normal . p <= offset
};

/// Cuts every polygon of a convex solid by a half-space and closes it with the polygon of the cut.
void cut(std::vector<std::vector<glm::dvec3>>& sides, const HalfSpace& half, double epsilon) {
  std::vector<std::vector<glm::dvec3>> kept;
  std::vector<glm::dvec3> border;
  for (const std::vector<glm::dvec3>& side : sides) {
    std::vector<glm::dvec3> part;
    for (std::size_t i = 0; i < side.size(); ++i) {
      const glm::dvec3 &a = side[i], &b = side[(i + 1) % side.size()];
      const double da = glm::dot(half.normal, a) - half.offset, db = glm::dot(half.normal, b) - half.offset;
      if (da <= epsilon) part.push_back(a);
      if (std::abs(da) <= epsilon) border.push_back(a);
      if ((da > epsilon && db < -epsilon) || (da < -epsilon && db > epsilon)) {
        part.push_back(a + (b - a) * (da / (da - db)));
        border.push_back(part.back());
      }
    }
    if (part.size() >= 3) kept.push_back(std::move(part));
  }
  if (border.size() >= 3) kept.push_back(std::move(border));  // only its corners matter
  sides = std::move(kept);
}

}  // namespace

std::span<const glm::vec3> kdop_directions(int k) {
  const std::span<const glm::vec3> all(directions_26);
  return k == 6    ? all.first(3)
         : k == 14 ? std::span<const glm::vec3>(directions_14)
         : k == 18 ? std::span<const glm::vec3>(directions_18)
                   : all;
}

Kdop make_kdop(std::span<const glm::vec3> points, int k) {
  Kdop kdop;
  if (points.empty()) return kdop;
  kdop.k = k;
  const auto directions = kdop_directions(k);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const glm::vec3& p : points) {
      const double at = glm::dot(glm::dvec3(directions[i]), glm::dvec3(p));
      lo = std::min(lo, at);
      hi = std::max(hi, at);
    }
    kdop.lo[i] = std::nextafter(static_cast<float>(lo), -std::numeric_limits<float>::infinity());
    kdop.hi[i] = std::nextafter(static_cast<float>(hi), std::numeric_limits<float>::infinity());
  }
  return kdop;
}

ConvexHull polytope(const Kdop& kdop) {
  if (kdop.k == 0) return {};
  const auto corner = [&](int i) {
    return glm::dvec3((i & 1) != 0 ? kdop.hi[0] : kdop.lo[0], (i & 2) != 0 ? kdop.hi[1] : kdop.lo[1],
                      (i & 4) != 0 ? kdop.hi[2] : kdop.lo[2]);
  };
  constexpr int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<std::vector<glm::dvec3>> sides;
  for (const auto& quad : quads) sides.push_back({corner(quad[0]), corner(quad[1]), corner(quad[2]), corner(quad[3])});
  const double epsilon =
      1e-9 * (glm::length(corner(7) - corner(0)) + 1e-7 * (glm::length(corner(0)) + glm::length(corner(7))));
  const auto directions = kdop_directions(kdop.k);
  for (std::size_t i = 3; i < directions.size(); ++i) {
    const glm::dvec3 direction(directions[i]);
    cut(sides, {direction, static_cast<double>(kdop.hi[i])}, epsilon);
    cut(sides, {-direction, -static_cast<double>(kdop.lo[i])}, epsilon);
  }
  std::vector<glm::vec3> corners;
  for (const auto& side : sides)
    for (const glm::dvec3& p : side) corners.emplace_back(p);
  ConvexHull hull = convex_hull(corners);
  // The corners were rounded to float.
  hull.slack += static_cast<float>(0x1p-22 * (glm::length(corner(0)) + glm::length(corner(7))));
  return hull;
}

bool overlaps(const Kdop& a, const Kdop& b) {
  if (a.k == 0 || b.k == 0) return false;
  for (std::size_t i = 0; i < kdop_directions(a.k).size(); ++i)
    if (a.lo[i] > b.hi[i] || b.lo[i] > a.hi[i]) return false;
  return true;
}

}  // namespace sightline
