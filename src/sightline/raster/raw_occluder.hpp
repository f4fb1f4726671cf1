// Triangles made into an OccluderMesh in time linear in their number, with memory that is kept: for meshes that change
// every frame. Vertices are matched by index, not by position; a mesh whose faces do not share indices has a contour at
// every edge, which is safe and hides less.
#pragma once

#include "sightline/raster/occluder_mesh.hpp"

namespace sightline {

class RawOccluder {
 public:
  /// Indices must lie within positions. Valid until the next call.
  const OccluderMesh& make(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

 private:
  struct Edge {
    std::uint32_t from, to, first, second, count, forward;
  };
  void find_edges(std::span<const glm::uvec3> triangles);
  void find_components(std::uint32_t triangle_count);
  std::uint32_t root(std::uint32_t i);

  OccluderMesh mesh_;
  std::vector<glm::uvec3> kept_;        // triangles with three different corners
  std::vector<Edge> edges_;             // each once
  std::vector<std::uint32_t> slots_;    // hash table of edges, by their ends
  std::vector<std::uint32_t> parents_;  // disjoint sets of triangles
  std::vector<std::uint32_t> component_, order_, edge_order_, next_;
  std::vector<std::int32_t> place_, renamed_;
};

}  // namespace sightline
