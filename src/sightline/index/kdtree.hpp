// kd-tree: one axis-parallel plane per node, anywhere in the cell (checklist 14.07, E25), chosen by the median or by
// the surface area heuristic (Wald and Havran 2006, binned). Promise of the walk: the hits of brute force.
#pragma once

#include <bit>
#include <span>

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/large_pages.hpp"
#include "sightline/index/trace.hpp"

namespace sightline {

/// 8 bytes. Inner node: axis < 3, the plane at `split`, children nodes[first] (below) and nodes[first + 1]. Leaf: axis
/// == 3, `split` holds the first item's index as bits, `first` how many there are.
struct KdNode {
  std::uint32_t split_bits = 0;
  std::uint32_t axis : 2 = 3;
  std::uint32_t first : 30 = 0;
};
static_assert(sizeof(KdNode) == 8);

struct KdTree {
  TraceSpace space;
  Aabb bounds;                // of the root cell
  PagedVector<KdNode> nodes;  // nodes[0] is the root; empty if there are no triangles
  PagedVector<std::uint32_t> items;

  [[nodiscard]] std::size_t bytes() const { return nodes.size() * sizeof(KdNode) + items.size() * 4; }
  /// Of a leaf; none of an inner node.
  [[nodiscard]] std::span<const std::uint32_t> items_of(std::uint32_t node) const {
    const KdNode& n = nodes[node];
    return n.axis == 3 ? std::span(items).subspan(n.split_bits, n.first) : std::span<const std::uint32_t>();
  }
  /// Calls visit(cell, node) for the children of a node with this cell.
  template <class Visit>
  void for_each_child(std::uint32_t node, const Aabb& cell, Visit&& visit) const {
    const KdNode& n = nodes[node];
    if (n.axis == 3) return;
    Aabb low = cell, high = cell;
    const auto axis = static_cast<int>(n.axis);
    low.hi[axis] = high.lo[axis] = std::bit_cast<float>(n.split_bits);
    visit(low, n.first);
    visit(high, n.first + 1u);
  }
};

enum class KdSplit { median, sah };

struct KdConfig {
  KdSplit split = KdSplit::sah;
  float node_cost = 0.6f;       // of visiting a node, in tests of a triangle; for sah
  float empty_bonus = 0.8f;     // factor on the cost of splits that cut off empty space; for sah
  std::uint32_t leaf_size = 4;  // triangles that are not split further; for median
  int max_depth = 0;            // 0: 8 + 1.3 log2 n (E26)
  std::uint32_t axes = 7;       // which may be split, bit 0 x, 1 y, 2 z
};

KdTree build_kdtree(const TriangleSoup& soup, const KdConfig& config = {});

RayHit trace_nearest(const KdTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);
bool trace_any(const KdTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);

/// Places of the triangles that touch the box / the frustum; ascending.
std::vector<std::uint32_t> box_query(const KdTree& tree, const TriangleSoup& soup, const Aabb& box);
std::vector<std::uint32_t> frustum_query(const KdTree& tree, const TriangleSoup& soup, const Frustum& frustum);

}  // namespace sightline
