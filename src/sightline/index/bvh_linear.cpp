// Morton order, then a tree by its bits; above groups of boxes a tree by surface area.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <utility>
#include <vector>

#include "sightline/index/bvh_builders.hpp"

namespace sightline {
namespace {

constexpr int bits_per_axis = 10, code_bits = 3 * bits_per_axis;

/// Moves bit i of the lowest ten to bit 3 i.
std::uint32_t spread(std::uint32_t v) {
  v = (v * 0x00010001u) & 0xFF0000FFu;
  v = (v * 0x00000101u) & 0x0F00F00Fu;
  v = (v * 0x00000011u) & 0xC30C30C3u;
  return (v * 0x00000005u) & 0x49249249u;
}

/// Morton code above, number of the box below.
using Key = std::uint64_t;
std::uint32_t code_of(Key key) { return static_cast<std::uint32_t>(key >> 32); }
std::uint32_t box_of(Key key) { return static_cast<std::uint32_t>(key); }

std::vector<Key> morton_keys(std::span<const Aabb> boxes) {
  glm::vec3 lo(std::numeric_limits<float>::infinity()), hi = -lo;
  for (const Aabb& box : boxes) {
    const glm::vec3 c = box.lo + box.hi;  // of an empty box NaN, which no comparison takes
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = c[axis] < lo[axis] ? c[axis] : lo[axis];
      hi[axis] = c[axis] > hi[axis] ? c[axis] : hi[axis];
    }
  }
  constexpr float cells = 1u << bits_per_axis;
  glm::vec3 scale(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    const float s = cells / (hi[axis] - lo[axis]);
    scale[axis] = s > 0.0f && s < std::numeric_limits<float>::infinity() ? s : 0.0f;
  }
  std::vector<Key> keys(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const glm::vec3 place = (boxes[i].lo + boxes[i].hi - lo) * scale;
    std::uint32_t cell[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float p = place[axis] > 0.0f ? place[axis] : 0.0f;
      cell[axis] = static_cast<std::uint32_t>(p < cells - 1.0f ? p : cells - 1.0f);
    }
    keys[i] = (Key{spread(cell[0]) << 2 | spread(cell[1]) << 1 | spread(cell[2])} << 32) | i;
  }
  return keys;
}

/// By code, three passes of ten bits (least significant digit first: stable, so equal codes stay in order).
void radix_sort(std::vector<Key>& keys) {
  constexpr std::size_t digits = 3, radix = 1u << (code_bits / digits);
  std::vector<std::array<std::uint32_t, radix>> counts(digits);
  for (auto& c : counts) c.fill(0);
  const auto digit = [](Key key, std::size_t pass) {
    return static_cast<std::size_t>(key >> (32 + pass * (code_bits / digits))) & (radix - 1);
  };
  for (const Key key : keys)
    for (std::size_t pass = 0; pass < digits; ++pass) ++counts[pass][digit(key, pass)];
  std::vector<Key> other(keys.size());
  for (std::size_t pass = 0; pass < digits; ++pass) {
    std::uint32_t sum = 0;
    for (std::uint32_t& c : counts[pass]) sum += std::exchange(c, sum);
    for (const Key key : keys) other[counts[pass][digit(key, pass)]++] = key;
    keys.swap(other);
  }
}

/// A run of sorted keys that becomes a subtree.
struct Group {
  std::uint32_t begin, end;
};

class LinearBuilder {
 public:
  LinearBuilder(std::span<const Aabb> boxes, const BvhBuildConfig& config) : boxes_(boxes), config_(config) {}

  Bvh build() {
    if (boxes_.empty()) return {};
    keys_ = morton_keys(boxes_);
    radix_sort(keys_);
    const std::vector<Group> groups = find_groups();
    std::vector<Aabb> bounds;
    for (const Group& group : groups) {
      Aabb box;
      for (std::uint32_t i = group.begin; i < group.end; ++i) box.extend(boxes_[box_of(keys_[i])]);
      bounds.push_back(box);
    }
    const Bvh top = build_bvh_sah(bounds, {.max_leaf_size = 1, .node_cost = 0.0f});
    bvh_.nodes.reserve(boxes_.size());
    bvh_.items.reserve(boxes_.size());
    graft(top, groups);
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

  /// Runs of equal leading bits, as long as they are, at most `most` boxes.
  [[nodiscard]] std::vector<Group> find_groups() const {
    constexpr std::uint32_t most = 64;
    std::vector<Group> groups;
    std::vector<Group> stack{{0, static_cast<std::uint32_t>(keys_.size())}};
    while (!stack.empty()) {
      const Group g = stack.back();
      stack.pop_back();
      if (g.end - g.begin <= most) {
        groups.push_back(g);
        continue;
      }
      const std::uint32_t middle = cut(g.begin, g.end);
      stack.push_back({middle, g.end});
      stack.push_back({g.begin, middle});
    }
    return groups;
  }

  /// Where the highest differing bit of the codes changes; the middle if all are equal.
  [[nodiscard]] std::uint32_t cut(std::uint32_t begin, std::uint32_t end) const {
    const std::uint32_t first = code_of(keys_[begin]), last = code_of(keys_[end - 1]);
    if (first == last) return begin + (end - begin) / 2;
    const std::uint32_t bit = std::bit_floor(first ^ last);
    const std::uint32_t bound = (last & ~(bit - 1));
    std::uint32_t low = begin, high = end - 1;
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      if (code_of(keys_[middle]) < bound)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }

  /// The top tree with its leaves replaced by subtrees of their groups.
  void graft(const Bvh& top, const std::vector<Group>& groups) {
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
        const Group& group = groups[top.items[node.first]];
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
      const std::uint32_t middle = cut(task.begin, task.end), first = add_children(task.node);
      stack_.push_back({first + 1, middle, task.end});
      stack_.push_back({first, task.begin, middle});
    }
  }

  std::span<const Aabb> boxes_;
  BvhBuildConfig config_;
  std::vector<Key> keys_;
  std::vector<Task> stack_;
  Bvh bvh_;
};

}  // namespace

Bvh build_bvh_linear(std::span<const Aabb> boxes, const BvhBuildConfig& config) {
  assert(config.max_leaf_size >= 1 && config.max_leaf_size <= 255);
  return LinearBuilder(boxes, config).build();
}

}  // namespace sightline
