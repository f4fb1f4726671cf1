// Trees that halve their cell along n axes at a time, 2^n children (checklist 14.04-14.08, 14.12 with E25): n = 1 an
// alternating kd-tree, n = 2 a quadtree, n = 3 an octree; or any mixture. Splitting ends by E26: few enough triangles,
// the depth limit, or no gain. Promise of the walk: the hits of brute force.
#pragma once

#include <bit>
#include <span>

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/large_pages.hpp"
#include "sightline/index/trace.hpp"

namespace sightline {

/// Inner node: axes != 0, and child k of the 2^n is nodes[first + k]: bit j of k is the upper half of the j-th axis of
/// the mask. Leaf: items[first .. first + count).
struct AxisNode {
  std::uint32_t first = 0;
  std::uint32_t axes : 3 = 0;  // bit 0 x, 1 y, 2 z
  std::uint32_t count : 29 = 0;
};

/// The cell of child k.
inline Aabb child_cell(const Aabb& cell, std::uint32_t axes, std::uint32_t k) {
  Aabb child = cell;
  for (int axis = 0, bit = 0; axis < 3; ++axis) {
    if (((axes >> axis) & 1u) == 0) continue;
    const float middle = 0.5f * (cell.lo[axis] + cell.hi[axis]);
    (((k >> bit++) & 1u) != 0 ? child.lo : child.hi)[axis] = middle;
  }
  return child;
}

struct AxisTree {
  TraceSpace space;
  Aabb bounds;                  // of the root cell
  PagedVector<AxisNode> nodes;  // nodes[0] is the root; empty if there are no triangles
  PagedVector<std::uint32_t> items;

  [[nodiscard]] std::size_t bytes() const { return nodes.size() * sizeof(AxisNode) + items.size() * 4; }
  /// Of a leaf; none of an inner node.
  [[nodiscard]] std::span<const std::uint32_t> items_of(std::uint32_t node) const {
    const AxisNode& n = nodes[node];
    return n.axes == 0 ? std::span(items).subspan(n.first, n.count) : std::span<const std::uint32_t>();
  }
  /// Calls visit(cell, node) for the children of a node with this cell.
  template <class Visit>
  void for_each_child(std::uint32_t node, const Aabb& cell, Visit&& visit) const {
    const AxisNode& n = nodes[node];
    for (std::uint32_t k = 0; n.axes != 0 && k < (1u << std::popcount(std::uint32_t{n.axes})); ++k)
      visit(child_cell(cell, n.axes, k), n.first + k);
  }
};

struct AxisTreeConfig {
  std::uint32_t axes = 7;       // which may be halved, bit 0 x, 1 y, 2 z
  bool alternating = false;     // one axis at a time, that in which the cell is longest, instead of all
  bool cube = true;             // the root cell is a cube (a square for two axes), as on the slides; else the bounds
  std::uint32_t leaf_size = 8;  // triangles that are not split further; the slide's "at most one" need not end (E26)
  float node_cost = 1.0f;       // of visiting a node, in tests of a triangle: what a split must save
  int max_depth = 0;            // 0: from the number of triangles
};

AxisTree build_axis_tree(const TriangleSoup& soup, const AxisTreeConfig& config = {});
AxisTree build_octree(const TriangleSoup& soup);
/// Halves along the two axes in which the bounds are longest.
AxisTree build_quadtree(const TriangleSoup& soup);

RayHit trace_nearest(const AxisTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);
bool trace_any(const AxisTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);

/// Places of the triangles that touch the box / the frustum; ascending.
std::vector<std::uint32_t> box_query(const AxisTree& tree, const TriangleSoup& soup, const Aabb& box);
std::vector<std::uint32_t> frustum_query(const AxisTree& tree, const TriangleSoup& soup, const Frustum& frustum);

/// Calls visit(cell, depth, node) for every node, parents first.
template <class F>
void for_each_cell(const AxisTree& tree, F&& visit) {
  struct Task {
    Aabb cell;
    int depth;
    std::uint32_t node;
  };
  std::vector<Task> stack;
  if (!tree.nodes.empty()) stack.push_back({tree.bounds, 0, 0});
  while (!stack.empty()) {
    const Task task = stack.back();
    stack.pop_back();
    const AxisNode& node = tree.nodes[task.node];
    visit(task.cell, task.depth, node);
    if (node.axes == 0) continue;
    const std::uint32_t children = 1u << std::popcount(static_cast<std::uint32_t>(node.axes));
    for (std::uint32_t k = children; k-- > 0;)
      stack.push_back({child_cell(task.cell, node.axes, k), task.depth + 1, node.first + k});
  }
}

}  // namespace sightline
