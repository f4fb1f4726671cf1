// Which triangles of a mesh share an edge, by position of the vertices (so split normals or seams do not matter).
// Serves: the closedness test (checklist 17.01, 17.06), silhouettes (E17), contour edges of occluders.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/no_triangle.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

/// An undirected edge between two welded vertices, from < to, and the triangles at it.
struct MeshEdge {
  std::uint32_t from = 0, to = 0;
  /// The first two triangles at the edge; no_triangle where there is none.
  std::uint32_t triangles[2] = {no_triangle, no_triangle};
  /// How many triangles meet at the edge, and how many of them run it from `from` to `to`.
  std::uint32_t count = 0, forward = 0;
};

struct Topology {
  /// For every vertex the lowest vertex with the same position (+0 and -0 are the same).
  std::vector<std::uint32_t> welded;
  /// Each once, ordered by (from, to). Triangles with two equal welded vertices contribute nothing.
  std::vector<MeshEdge> edges;
  /// For every triangle its three edges (v0 v1, v1 v2, v2 v0) as indices into `edges`; no_triangle for a triangle with
  /// two equal welded vertices.
  std::vector<glm::uvec3> triangle_edges;
};

/// O(n) in the number of triangles, save where very many meet at a vertex; indices must lie within positions.
Topology build_topology(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

/// True iff at least one edge exists and every edge joins exactly two triangles that run it in opposite directions:
/// a closed, consistently oriented surface. Such a mesh never shows a back face to an eye outside of it.
bool is_closed(const Topology& topology);
/// The same for a mesh, without building its topology.
bool is_closed(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

}  // namespace sightline
