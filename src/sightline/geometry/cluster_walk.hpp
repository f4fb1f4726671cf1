// The walk down a tree of clusters, whatever tests the eight clusters of a node. Internal to cluster_tree.cpp.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include "sightline/geometry/bit_range.hpp"
#include "sightline/geometry/cluster_tree.hpp"

namespace sightline {

/// Bits of the clusters of a node.
struct NodeSides {
  std::uint32_t back, front;
};

/// Eight times `words` words, all set or all clear.
template <std::size_t words>
__attribute__((always_inline)) inline void write_words(std::uint64_t* at, std::uint32_t keep) {
  for (std::size_t k = 0; k < ClusterNode::width; ++k)
    for (std::size_t w = 0; w < words; ++w) at[k * words + w] = std::uint64_t{0} - ((keep >> k) & 1);
}

/// Keeps some of the eight leaves of a node; where it can without branches that depend on the answer.
__attribute__((always_inline)) inline void keep_leaves(const ClusterTree& tree, std::size_t node, std::uint32_t keep,
                                                       std::span<std::uint64_t> kept) {
  const std::size_t first = node * ClusterNode::width * tree.leaf, count = tree.order.size();
  if (first + ClusterNode::width * tree.leaf <= count) {
    std::uint64_t* const at = kept.data() + first / 64;
    if (tree.leaf == 64) return write_words<1>(at, keep);
    if (tree.leaf == 128) return write_words<2>(at, keep);
    if (tree.leaf == 256) return write_words<4>(at, keep);
    if (tree.leaf == 512) return write_words<8>(at, keep);
  }
  for (; keep != 0; keep &= keep - 1) {
    const std::size_t begin = first + static_cast<std::size_t>(std::countr_zero(keep)) * tree.leaf;
    set_bits(kept, begin, std::min<std::size_t>(begin + tree.leaf, count));
  }
}

/// test(node) gives the NodeSides of a node. Inlined, so that each SIMD target gets a walk of its own with the test in
/// it.
template <class Test>
__attribute__((always_inline)) inline void walk_clusters(const ClusterTree& tree, std::span<std::uint64_t> kept,
                                                         ClusterCounts& counts, Test&& test) {
  if (tree.levels.empty()) return;
  struct Step {
    std::uint32_t level, node;
  };
  const std::size_t count = tree.order.size();
  Step stack[12 * ClusterNode::width];  // 8^11 clusters are more than there can be triangles
  std::size_t top = 0;
  stack[top++] = {static_cast<std::uint32_t>(tree.levels.size() - 1), 0};
  std::uint64_t tested = 0, culled = 0;
  while (top > 0) {
    const Step step = stack[--top];
    const ClusterNode& node = tree.levels[step.level][step.node];
    const NodeSides sides = test(node);
    const std::uint32_t used = node.used, back = sides.back & used, rest = used & ~back;
    const std::size_t size = std::size_t{tree.leaf} << (3 * step.level);
    const std::size_t first = step.node * ClusterNode::width * size;
    tested += static_cast<std::uint64_t>(std::popcount(used));
    culled += static_cast<std::uint64_t>(std::popcount(back)) * size;
    const auto number = static_cast<std::size_t>(std::bit_width(used));
    if (first + number * size > count && (back >> (number - 1)) != 0) culled -= first + number * size - count;
    if (step.level == 0) {
      keep_leaves(tree, step.node, rest, kept);
      continue;
    }
    const std::uint32_t open = rest & ~(sides.front | node.whole);
    for (std::uint32_t left = rest & ~open; left != 0; left &= left - 1) {
      const std::size_t begin = first + static_cast<std::size_t>(std::countr_zero(left)) * size;
      set_bits(kept, begin, std::min(begin + size, count));
    }
    for (std::uint32_t left = open; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      stack[top++] = {step.level - 1, step.node * static_cast<std::uint32_t>(ClusterNode::width) + k};
    }
  }
  counts.tested += tested;
  counts.culled += culled;
}

}  // namespace sightline
