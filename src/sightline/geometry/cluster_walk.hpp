// The walk down a tree of clusters, whatever tests the eight children of a node. Internal to cluster_tree.cpp.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "sightline/geometry/bit_range.hpp"
#include "sightline/geometry/cluster_tree.hpp"

namespace sightline {

/// test(node) gives the bits of the children that turn back (low byte) and front (next byte).
/// Inlined, so that each SIMD target gets a walk of its own with the test in it.
template <class Test>
__attribute__((always_inline)) inline void walk_clusters(const ClusterTree& tree, std::span<std::uint64_t> kept,
                                                         ClusterCounts& counts, Test&& test) {
  if (tree.nodes.empty()) return;
  constexpr std::size_t deepest = 1024;
  std::uint32_t stack[deepest];
  std::size_t top = 0;
  stack[top++] = 0;
  std::uint64_t tested = 0, culled = 0;
  while (top > 0) {
    const ClusterNode& node = tree.nodes[stack[--top]];
    const std::uint32_t bits = test(node);
    tested += node.count;
    const std::uint32_t children = (1u << node.count) - 1u;
    for (std::uint32_t back = bits & children; back != 0; back &= back - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(back));
      culled += node.end[k] - node.begin[k];
    }
    std::uint32_t undecided = ~bits & children;
    for (; undecided != 0; undecided &= undecided - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(undecided));
      const bool front = ((bits >> (8 + k)) & 1) != 0;
      if (front || node.child[k] == ClusterNode::leaf || top == deepest)
        set_bits(kept, node.begin[k], node.end[k]);
      else
        stack[top++] = node.child[k];
    }
  }
  counts.tested += tested;
  counts.culled += culled;
}

}  // namespace sightline
