// Polygons into triangles by cutting off ears (Meisters 1975), for faces of files that have more than three corners.
// Promise: always corners - 2 triangles that use every corner, so a closed surface of polygons stays closed; for a
// simple planar polygon they cover it without overlap, whether it is convex or not.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace sightline {

/// Work grows with up to the third power of the corners of a polygon that is not convex: bound them by this.
inline constexpr std::size_t most_concave_corners = 1024;

/// Triangles as indices into `corners`, in the sense of rotation of the polygon. The polygon is looked at along its
/// normal by Newell's method, so it need not be exactly planar. Empty if there are fewer than three corners, or more
/// than most_concave_corners in a polygon that is not convex.
std::vector<glm::uvec3> triangulate_polygon(std::span<const glm::vec3> corners);

}  // namespace sightline
