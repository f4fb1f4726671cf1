#include "sightline/geometry/clip_boxes.hpp"

#include <cmath>

namespace sightline {
namespace {

/// The six comparisons as functions of a point in the world, w + x, w - x, w + y .., each widened for the rounding of a
/// float evaluation. They are linear: all eight corners of a box fail one if the corner where it is largest does, the
/// p-vertex. So they are planes like those of frustum_of, though not of unit length.
Frustum unit_cube(const glm::dmat4& view_projection, double reach) {
  const glm::dmat4 rows = glm::transpose(view_projection);
  const auto weight = [&](const glm::dvec4& row) {
    return (std::abs(row.x) + std::abs(row.y) + std::abs(row.z)) * reach + std::abs(row.w);
  };
  Frustum cube;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const glm::dvec4 row = rows[3] + sign * rows[axis];
      // Rounding of the row and some ten operations on terms no larger than these.
      const double slack = 0x1p-20 * (weight(rows[3]) + weight(rows[axis]));
      cube.planes[static_cast<std::size_t>(cube.count++)] = {glm::vec3(row), static_cast<float>(row.w + slack)};
    }
  return cube;
}

}  // namespace

Containment classify_in_clip_space(const Aabb& box, const glm::dmat4& view_projection) {
  if (box.empty()) return Containment::outside;
  int outside[6] = {}, inside = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 q = view_projection * glm::dvec4(glm::dvec3(box.corner(i)), 1.0);
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) {
      outside[2 * axis] += q[axis] < -q.w ? 1 : 0;
      outside[2 * axis + 1] += q[axis] > q.w ? 1 : 0;
      all = all && q[axis] >= -q.w && q[axis] <= q.w;
    }
    inside += all ? 1 : 0;
  }
  for (const int corners : outside)
    if (corners == 8) return Containment::outside;
  return inside == 8 ? Containment::inside : Containment::intersecting;
}

std::size_t boxes_in_clip_space(const BoxArrays& boxes, const glm::dmat4& view_projection, double reach,
                                std::uint32_t* ids) {
  return boxes_in_frustum(boxes, unit_cube(view_projection, reach), ids);
}

}  // namespace sightline
