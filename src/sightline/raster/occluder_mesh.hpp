// A mesh made ready to hide things: welded vertices as arrays, triangles, and which triangles share each edge, so that
// the contour of its projection is found in any view. Made once per mesh, used by every instance.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/aabb.hpp"

namespace sightline {

/// Arrays end in padding, so that kernels may read whole vectors; the counts do not include it.
struct OccluderMesh {
  std::uint32_t vertex_count = 0, triangle_count = 0, edge_count = 0;
  std::vector<float> x, y, z;
  /// Corners of each triangle. Triangles without area are left out.
  std::vector<std::int32_t> corner0, corner1, corner2;
  /// Plane of each triangle, dot(normal, p) + offset = 0 with a unit normal on its front side; zeros where it has none.
  /// Empty in meshes that are made for one frame: there they cost more than they save.
  std::vector<float> normal_x, normal_y, normal_z, offset;
  /// End points of each edge and the two triangles at it. Two slots behind the last triangle stand for what is no
  /// triangle: triangle_count is never drawn, triangle_count + 1 always is. A border edge has the former as its second
  /// triangle; an edge with three or more triangles has both, so that it is a contour in every view.
  std::vector<std::int32_t> edge_from, edge_to, edge_first, edge_second;
  /// +1 if the two triangles run the edge in opposite directions (consistent winding), -1 if in the same direction.
  std::vector<float> edge_winding;
  /// Vertices, triangles and edges are ordered by connected component: component c has the triangles from
  /// triangle_begin[c] on and so forth; the arrays end with the totals. Components share no vertices. What does not
  /// hang together is drawn one after the other, so that the contour of one part takes nothing back from another.
  std::vector<std::uint32_t> vertex_begin, triangle_begin, edge_begin;
  /// Every edge joins two triangles of opposite direction: back faces are never seen and need not be drawn.
  bool closed = false;
  Aabb bounds;
};

/// Indices must lie within positions. O(n log n).
OccluderMesh make_occluder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

}  // namespace sightline
