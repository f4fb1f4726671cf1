// Bounding volume hierarchy over boxes (checklist 13.14, 13.15): plain data, and a builder that returns it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/aabb.hpp"
#include "sightline/index/large_pages.hpp"

namespace sightline {

/// 32 bytes. Inner node: count == 0 and its children are nodes[first] and nodes[first + 1]. Leaf: items[first .. +
/// count).
struct BvhNode {
  Aabb bounds;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  [[nodiscard]] bool leaf() const { return count > 0; }
};

struct Bvh {
  /// nodes[0] is the root; empty if there are no boxes. Children come after their parent.
  PagedVector<BvhNode> nodes;
  /// Indices of the boxes, each exactly once; every subtree's items are contiguous.
  std::vector<std::uint32_t> items;
};

/// The items below a node: items[begin .. end). O(depth).
struct ItemRange {
  std::uint32_t begin, end;
};
ItemRange items_below(const Bvh& bvh, std::uint32_t node);
/// The same for every node, by node. O(nodes).
std::vector<ItemRange> item_ranges(const Bvh& bvh);

/// Of this and the other builders (bvh_builders.hpp).
struct BvhConfig {
  int max_leaf_size = 4;  // boxes, 1 to 255
  // Of the surface area heuristic:
  int bins = 16;        // most bins per axis, 2 to 64; small nodes use fewer
  bool grouped = true;  // many boxes: first over groups of neighbours, twice as fast; else from the whole down
};

/// Top-down, binned surface area heuristic (Wald 2007); falls back to the median where all centroids coincide. Of many
/// boxes, unless configured otherwise, first over groups of neighbours along a Morton curve (Pantaleoni and Luebke
/// 2010), then within each. Empty boxes are allowed and never widen a node. The result does not depend on the number of
/// threads.
Bvh build_bvh(std::span<const Aabb> boxes, const BvhConfig& config = {});

/// Recomputes the bounds of all nodes after boxes moved, grew, or became empty; the tree keeps its shape, so it stays
/// right and only gets slower to walk the farther things move. `boxes`: as many as it was built over. O(n).
void refit(Bvh& bvh, std::span<const Aabb> boxes);

}  // namespace sightline
