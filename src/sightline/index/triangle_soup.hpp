// The triangles that rays are traced against: world-space corners, and which object and triangle each comes from. Plain
// data; what is built over it names triangles by their place in it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sightline/geometry/aabb.hpp"

namespace sightline {

struct TriangleSoup {
  /// Corners of triangle i are corners[3 i .. 3 i + 2]; finite, and for structures over them within 1e15 of the origin.
  std::vector<glm::vec3> corners;
  /// Run r of triangles [first[r], first[r + 1]) belongs to object object[r]: runs ascending in both, so a lower place
  /// is a lower object, then a lower triangle. `first` has one entry more than `object` (none if both are empty).
  std::vector<std::uint32_t> first, object;

  [[nodiscard]] std::size_t size() const { return corners.size() / 3; }
  [[nodiscard]] const glm::vec3* triangle(std::uint32_t i) const { return corners.data() + 3 * std::size_t{i}; }

  struct Ids {
    std::uint32_t object, triangle;
  };
  /// O(log objects). A soup without runs is one object 0.
  [[nodiscard]] Ids ids(std::uint32_t i) const {
    if (object.empty()) return {0, i};
    const auto run = static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), i) - first.begin()) - 1;
    return {object[run], i - first[run]};
  }
};

inline Aabb triangle_bounds(const glm::vec3* corners) {
  return {glm::min(glm::min(corners[0], corners[1]), corners[2]),
          glm::max(glm::max(corners[0], corners[1]), corners[2])};
}

/// Bounds of every triangle, by place.
std::vector<Aabb> bounds_of_triangles(const TriangleSoup& soup);

/// Bounds of all corners; empty for an empty soup.
Aabb bounds_of(const TriangleSoup& soup);

}  // namespace sightline
