// Morton order, then a tree by its bits; above groups of boxes a tree by surface area.
#include <cassert>
#include <utility>
#include <vector>

#include "sightline/index/bvh_builders.hpp"
#include "sightline/index/morton_order.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t group_size = 128;

class LinearBuilder {
 public:
  LinearBuilder(std::span<const Aabb> boxes, const BvhConfig& config) : boxes_(boxes), config_(config) {}

  Bvh build() {
    if (boxes_.empty()) return {};
    MortonGroups groups = morton_groups(boxes_, group_size);
    keys_ = std::move(groups.keys);
    const Bvh top = build_bvh(groups.bounds, {.max_leaf_size = 1, .grouped = false});
    bvh_.nodes.reserve(boxes_.size());
    bvh_.items.reserve(boxes_.size());
    graft(top, groups.runs);
    for (std::uint32_t i = static_cast<std::uint32_t>(bvh_.nodes.size()); i-- > 0;) {
      BvhNode& node = bvh_.nodes[i];
      if (node.leaf()) continue;
      node.bounds = bvh_.nodes[node.first].bounds;
      node.bounds.extend(bvh_.nodes[node.first + 1].bounds);
    }
    return std::move(bvh_);
  }

 private:
  struct Task {
    std::uint32_t node, begin, end;
  };

  /// The top tree with its leaves replaced by subtrees of their groups.
  void graft(const Bvh& top, const std::vector<MortonRun>& groups) {
    struct Pending {
      std::uint32_t from, to;
    };
    bvh_.nodes.emplace_back();
    std::vector<Pending> stack{{0, 0}};
    while (!stack.empty()) {
      const Pending p = stack.back();
      stack.pop_back();
      const BvhNode& node = top.nodes[p.from];
      if (node.leaf()) {
        const MortonRun& group = groups[top.items[node.first]];
        subtree({p.to, group.begin, group.end});
        continue;
      }
      const std::uint32_t first = add_children(p.to);
      stack.push_back({node.first + 1, first + 1});
      stack.push_back({node.first, first});
    }
  }

  std::uint32_t add_children(std::uint32_t parent) {
    const auto first = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes[parent].first = first;
    bvh_.nodes[parent].count = 0;
    bvh_.nodes.resize(bvh_.nodes.size() + 2);
    return first;
  }

  void subtree(const Task& root) {
    // Boxes are anywhere in memory.
    for (std::uint32_t i = root.begin; i < root.end; ++i) __builtin_prefetch(&boxes_[box_of(keys_[i])]);
    stack_.assign(1, root);
    while (!stack_.empty()) {
      const Task task = stack_.back();
      stack_.pop_back();
      if (task.end - task.begin <= static_cast<std::uint32_t>(config_.max_leaf_size)) {
        BvhNode& node = bvh_.nodes[task.node];
        node.first = static_cast<std::uint32_t>(bvh_.items.size());
        node.count = task.end - task.begin;
        for (std::uint32_t i = task.begin; i < task.end; ++i) {
          bvh_.items.push_back(box_of(keys_[i]));
          node.bounds.extend(boxes_[box_of(keys_[i])]);
        }
        continue;
      }
      const std::uint32_t middle = cut(keys_, {task.begin, task.end}), first = add_children(task.node);
      stack_.push_back({first + 1, middle, task.end});
      stack_.push_back({first, task.begin, middle});
    }
  }

  std::span<const Aabb> boxes_;
  BvhConfig config_;
  PagedVector<MortonKey> keys_;
  std::vector<Task> stack_;
  Bvh bvh_;
};

}  // namespace

Bvh build_bvh_linear(std::span<const Aabb> boxes, const BvhConfig& config) {
  assert(config.max_leaf_size >= 1 && config.max_leaf_size <= 255);
  return LinearBuilder(boxes, config).build();
}

}  // namespace sightline
