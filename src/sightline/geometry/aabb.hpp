// Axis-aligned bounding box (checklist 20.03). Plain data; float, any space.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>

namespace sightline {

/// Closed box [lo, hi]. A default box is empty: lo > hi on every axis, and extending it by a point gives that point.
struct Aabb {
  glm::vec3 lo{std::numeric_limits<float>::infinity()};
  glm::vec3 hi{-std::numeric_limits<float>::infinity()};

  [[nodiscard]] bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  [[nodiscard]] glm::vec3 centre() const { return 0.5f * (lo + hi); }
  [[nodiscard]] glm::vec3 extent() const { return hi - lo; }

  void extend(const glm::vec3& point) {
    lo = glm::min(lo, point);
    hi = glm::max(hi, point);
  }
  void extend(const Aabb& other) {
    lo = glm::min(lo, other.lo);
    hi = glm::max(hi, other.hi);
  }

  [[nodiscard]] bool contains(const glm::vec3& p) const {
    return p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x <= hi.x && p.y <= hi.y && p.z <= hi.z;
  }
  [[nodiscard]] bool contains(const Aabb& o) const { return contains(o.lo) && contains(o.hi); }
  [[nodiscard]] bool overlaps(const Aabb& o) const {
    return lo.x <= o.hi.x && lo.y <= o.hi.y && lo.z <= o.hi.z && o.lo.x <= hi.x && o.lo.y <= hi.y && o.lo.z <= hi.z;
  }

  /// Half the surface area, the measure of the surface area heuristic; 0 for an empty box.
  [[nodiscard]] float half_area() const {
    if (empty()) return 0.0f;
    const glm::vec3 e = extent();
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }

  /// Corner i in 0..7: bit 0 selects x, bit 1 y, bit 2 z; a set bit takes hi.
  [[nodiscard]] glm::vec3 corner(int i) const {
    return {(i & 1) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y, (i & 4) != 0 ? hi.z : lo.z};
  }

  friend bool operator==(const Aabb&, const Aabb&) = default;
};

/// Largest absolute coordinate of a box; 0 for an empty one. Scales rounding slack.
inline float reach(const Aabb& box) {
  if (box.empty()) return 0.0f;
  const glm::vec3 m = glm::max(glm::abs(box.lo), glm::abs(box.hi));
  return std::max({m.x, m.y, m.z});
}

}  // namespace sightline
