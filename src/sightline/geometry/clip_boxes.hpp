// Boxes after the perspective transformation against the unit cube (checklist 20.19): one by one by their corners (the
// definition), and many at once, without division. Promise: conservative.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "sightline/geometry/frustum_boxes.hpp"

namespace sightline {

/// All eight corners p give q = matrix * (p, 1) with q.x < -q.w, or all q.x > q.w, or likewise for y or z: outside. All
/// inside: inside.
Containment classify_in_clip_space(const Aabb& box, const glm::dmat4& view_projection);

/// As boxes_in_frustum: indices of the boxes that may touch the unit cube, ascending; `ids` must hold count + 64.
/// `reach`: largest coordinate of the boxes, metres.
std::size_t boxes_in_clip_space(const BoxArrays& boxes, const glm::dmat4& view_projection, double reach,
                                std::uint32_t* ids);

}  // namespace sightline
