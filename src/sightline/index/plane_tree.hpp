// BSP tree for rays: cells parted by arbitrary planes (checklist 14.12), here across the axis in which the triangles'
// centres are spread widest, through their mean (PCA, checklist 15.17 with E32). Triangles are kept whole in every
// cell that a part of them reaches into. Promise of the walk: the hits of brute force.
#pragma once

#include <span>

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/trace.hpp"

namespace sightline {

/// Inner node: count == 0, the plane dot(normal, p) + offset = 0, children nodes[first] (behind) and nodes[first + 1]
/// (in front). Leaf: items[first .. first + count). Bounds are those of the triangles below, for queries.
struct PlaneNode {
  glm::dvec3 normal{0.0};
  double offset = 0.0;
  Aabb bounds;
  std::uint32_t first = 0, count = 0;
};

struct PlaneTree {
  TraceSpace space;
  std::vector<PlaneNode> nodes;  // nodes[0] is the root; empty if there are no triangles
  std::vector<std::uint32_t> items;

  [[nodiscard]] std::size_t bytes() const { return nodes.size() * sizeof(PlaneNode) + items.size() * 4; }
};

struct PlaneTreeConfig {
  std::uint32_t leaf_size = 8;  // triangles that are not parted further
  int max_depth = 0;            // 0: 8 + 1.3 log2 n (E26)
};

PlaneTree build_plane_tree(const TriangleSoup& soup, const PlaneTreeConfig& config = {});

RayHit trace_nearest(const PlaneTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);
bool trace_any(const PlaneTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);

/// Places of the triangles that touch the box / the frustum; ascending.
std::vector<std::uint32_t> box_query(const PlaneTree& tree, const TriangleSoup& soup, const Aabb& box);
std::vector<std::uint32_t> frustum_query(const PlaneTree& tree, const TriangleSoup& soup, const Frustum& frustum);

}  // namespace sightline
