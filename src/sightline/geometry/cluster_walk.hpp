// The walk down a tree of clusters, whatever tests the eight children of a node. Internal to cluster_tree.cpp.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "sightline/geometry/cluster_tree.hpp"

namespace sightline {

/// Sets bits [begin, end); begin < end.
inline void set_range(std::span<std::uint64_t> words, std::uint32_t begin, std::uint32_t end) {
  const std::size_t first = begin >> 6, last = (end - 1) >> 6;
  const std::uint64_t low = ~std::uint64_t{0} << (begin & 63), high = ~std::uint64_t{0} >> (63 - ((end - 1) & 63));
  if (first == last) {
    words[first] |= low & high;
    return;
  }
  words[first] |= low;
  for (std::size_t w = first + 1; w < last; ++w) words[w] = ~std::uint64_t{0};
  words[last] |= high;
}

/// test(node) gives the bits of the children that turn back (low byte) and front (next byte).
template <class Test>
void walk_clusters(const ClusterTree& tree, std::span<std::uint64_t> kept, ClusterCounts& counts, Test&& test) {
  if (tree.nodes.empty()) return;
  constexpr std::size_t deepest = 1024;
  std::uint32_t stack[deepest];
  std::size_t top = 0;
  stack[top++] = 0;
  std::uint64_t tested = 0;
  while (top > 0) {
    const ClusterNode& node = tree.nodes[stack[--top]];
    const std::uint32_t bits = test(node);
    tested += node.count;
    std::uint32_t undecided = ~bits & ((1u << node.count) - 1u);
    for (; undecided != 0; undecided &= undecided - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(undecided));
      const bool front = ((bits >> (8 + k)) & 1) != 0;
      if (front || node.child[k] == ClusterNode::leaf || top == deepest)
        set_range(kept, node.begin[k], node.end[k]);
      else
        stack[top++] = node.child[k];
    }
  }
  counts.tested += tested;
}

}  // namespace sightline
