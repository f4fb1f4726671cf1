// Boxes after the perspective transformation against the unit cube (checklist 20.19): one by one by their corners (the
// definition), and many at once in SIMD by centre and half extent, without division. Promise: conservative.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "sightline/geometry/frustum_boxes.hpp"

namespace sightline {

/// All eight corners p give q = matrix * (p, 1) with q.x < -q.w, or all q.x > q.w, or likewise for y or z: outside. All
/// inside: inside.
Containment classify_in_clip_space(const Aabb& box, const glm::dmat4& view_projection);

/// The rows of a clip matrix in float, and by how much w must be widened for each of the six comparisons to cover the
/// rounding of coordinates up to `reach`.
struct ClipRows {
  glm::vec4 row[4];     // x, y, z, w
  glm::vec3 radius[6];  // |w + x|, |w - x|, |w + y| .. componentwise, for half extents
  float slack[6];
};
ClipRows clip_rows(const glm::dmat4& view_projection, double reach);

/// As boxes_in_frustum: indices of the boxes that may touch the unit cube, ascending; `ids` must hold count + 64.
std::size_t boxes_in_clip_space(const BoxArrays& boxes, const ClipRows& rows, std::uint32_t* ids);
std::size_t boxes_in_clip_space_scalar(const BoxArrays& boxes, const ClipRows& rows, std::uint32_t* ids);

}  // namespace sightline
