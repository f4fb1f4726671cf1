#include "sightline/index/bvh8.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "sightline/geometry/triangle_overlap.hpp"

namespace sightline {
namespace {

/// Up to eight binary nodes that become the children of a wide one, those that stay nodes first.
struct Group {
  std::array<std::uint32_t, 8> node{};
  int count = 0, inner = 0;
};

/// Which binary nodes become children of which wide node, and which subtrees become one leaf: the cheapest choice by
/// surface area, weighed bottom-up (Ylitie, Karras and Laine 2017, section 4).
class Collapse {
 public:
  explicit Collapse(const Bvh& bvh) : bvh_(bvh), weights_(bvh.nodes.size()) {
    if (!bvh.nodes.empty())
      memory_area_ = memory_cost * bvh.nodes[0].bounds.half_area() / static_cast<float>(bvh.items.size());
    for (auto n = static_cast<std::uint32_t>(bvh.nodes.size()); n-- > 0;) weigh(n);
  }

  /// The children of a wide node made of this subtree.
  [[nodiscard]] Group gather(std::uint32_t root) const {
    Group group;
    if (is_leaf(root))
      group.node[static_cast<std::size_t>(group.count++)] = root;
    else
      share(root, 8, group);
    // Leaves last, and what is large: a ray that looks for any hit begins there.
    std::sort(group.node.begin(), group.node.begin() + group.count, [&](std::uint32_t a, std::uint32_t b) {
      if (is_leaf(a) != is_leaf(b)) return is_leaf(b);
      const float area_a = bvh_.nodes[a].bounds.half_area(), area_b = bvh_.nodes[b].bounds.half_area();
      return area_a < area_b || (area_a == area_b && a < b);
    });
    while (group.inner < group.count && !is_leaf(group.node[static_cast<std::size_t>(group.inner)])) ++group.inner;
    return group;
  }
  [[nodiscard]] bool is_leaf(std::uint32_t node) const { return weights_[node].leaf; }

 private:
  /// cost[i]: of the subtree as at most i + 1 children.
  struct Weight {
    std::array<float, 7> cost{};
    std::uint32_t items = 0;
    bool leaf = true;
  };

  // In visits of a node. Memory has its price: every node counts as larger by this share of the root's area for each
  // triangle, so that where rays hardly come nodes are full.
  static constexpr float memory_cost = 4.0f;
  static constexpr float node_cost = 1.0f, leaf_cost = 0.5f, triangle_cost = 0.05f;

  [[nodiscard]] float cost(std::uint32_t node, int places) const {
    return weights_[node].cost[static_cast<std::size_t>(places) - 1];
  }
  /// The cheapest way to give the children of a node so many places between them.
  [[nodiscard]] float shared_cost(std::uint32_t first, int places, int& of_first) const {
    float best = std::numeric_limits<float>::infinity();
    of_first = 1;
    for (int k = 1; k < places; ++k) {
      const float c = cost(first, k) + cost(first + 1, places - k);
      if (c < best) {
        best = c;
        of_first = k;
      }
    }
    return best;
  }

  void weigh(std::uint32_t n) {
    const BvhNode& node = bvh_.nodes[n];
    Weight& w = weights_[n];
    const float area = node.bounds.half_area();
    w.items = node.leaf() ? node.count : weights_[node.first].items + weights_[node.first + 1].items;
    const float as_leaf = w.items <= bvh8_leaf_limit ? area * (leaf_cost + triangle_cost * static_cast<float>(w.items))
                                                     : std::numeric_limits<float>::infinity();
    if (node.leaf()) {
      w.cost.fill(as_leaf);
      return;
    }
    int unused = 0;
    const float as_node = (area + memory_area_) * node_cost + shared_cost(node.first, 8, unused);
    w.leaf = as_leaf <= as_node;
    w.cost[0] = std::min(as_leaf, as_node);
    for (int places = 2; places <= 7; ++places) {
      const auto i = static_cast<std::size_t>(places) - 1;
      w.cost[i] = std::min(w.cost[i - 1], shared_cost(node.first, places, unused));
    }
  }

  void share(std::uint32_t n, int places, Group& group) const {
    int of_first = 0;
    const std::uint32_t first = bvh_.nodes[n].first;
    (void)shared_cost(first, places, of_first);
    collect(first, of_first, group);
    collect(first + 1, places - of_first, group);
  }
  void collect(std::uint32_t n, int places, Group& group) const {
    while (places > 1 && cost(n, places - 1) <= cost(n, places)) --places;
    if (places == 1)
      group.node[static_cast<std::size_t>(group.count++)] = n;
    else
      share(n, places, group);
  }

  const Bvh& bvh_;
  PagedVector<Weight> weights_;
  float memory_area_ = 0.0f;
};

class Widener {
 public:
  Widener(const Bvh& bvh, const TriangleSoup& soup) : bvh_(bvh), soup_(soup), collapse_(bvh) {}

  Bvh8 build() {
    if (bvh_.items.size() >= (std::size_t{1} << 28)) throw std::length_error("more than 2^28 triangles");
    if (bvh_.nodes.empty()) return {};
    tree_.space = trace_space(bvh_.nodes[0].bounds);
    tree_.nodes.reserve(bvh_.nodes.size() / 6 + 1);
    constexpr std::size_t padding = 16;  // a vector may be loaded at the last word
    tree_.triangles.reserve(bvh_.items.size() * bvh8_words_per_triangle + padding);
    tree_.nodes.emplace_back();
    std::vector<Task> stack{{0, 0, 1}};
    while (!stack.empty()) {
      const Task task = stack.back();
      stack.pop_back();
      tree_.depth = std::max(tree_.depth, task.depth);
      const Group group = collapse_.gather(task.from);
      const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
      tree_.nodes.resize(tree_.nodes.size() + static_cast<std::size_t>(group.inner));
      fill(tree_.nodes[task.to], group, first);
      for (int i = group.inner; i-- > 0;)
        stack.push_back(
            {group.node[static_cast<std::size_t>(i)], first + static_cast<std::uint32_t>(i), task.depth + 1});
    }
    tree_.triangles.resize(tree_.triangles.size() + padding);
    return std::move(tree_);
  }

 private:
  struct Task {
    std::uint32_t from, to;
    int depth;
  };

  void fill(Bvh8Node& node, const Group& group, std::uint32_t first_child) {
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(node.lo[axis], 8, INFINITY);
      std::fill_n(node.hi[axis], 8, -INFINITY);
      // What is rounded here and by the walks is less than the slack, which is there thrice.
      const float slack = 3.0f * tree_.space.slack;
      for (int i = 0; i < group.count; ++i) {
        const Aabb& box = bvh_.nodes[group.node[static_cast<std::size_t>(i)]].bounds;
        node.lo[axis][i] = box.lo[axis] - tree_.space.bounds.lo[axis] - slack;
        node.hi[axis][i] = box.hi[axis] - tree_.space.bounds.lo[axis] + slack;
      }
    }
    for (int i = 0; i < group.count; ++i)
      node.ref[i] = i < group.inner ? first_child + static_cast<std::uint32_t>(i)
                                    : add_leaf(items_below(bvh_, group.node[static_cast<std::size_t>(i)]));
  }

  std::uint32_t add_leaf(const ItemRange& leaf) {
    const std::size_t k = leaf.end - leaf.begin, at = tree_.triangles.size();
    tree_.triangles.resize(at + k * bvh8_words_per_triangle);
    std::uint32_t* words = tree_.triangles.data() + at;
    for (std::size_t i = 0; i < k; ++i) {
      const std::uint32_t place = bvh_.items[leaf.begin + i];
      words[i] = place;
      const float* corners = &soup_.triangle(place)->x;
      for (std::size_t j = 0; j < 9; ++j) std::memcpy(&words[(j + 1) * k + i], &corners[j], 4);
    }
    const std::uint32_t first = tree_.triangle_count;
    tree_.triangle_count += leaf.end - leaf.begin;
    return bvh8_leaf | (leaf.end - leaf.begin - 1u) << 28 | first;
  }

  const Bvh& bvh_;
  const TriangleSoup& soup_;
  Collapse collapse_;
  Bvh8 tree_;
};

/// A child's bounds in the space of the soup.
Aabb child_box(const Bvh8& tree, const Bvh8Node& node, int i) {
  const Aabb& space = tree.space.bounds;
  return {space.lo + glm::vec3(node.lo[0][i], node.lo[1][i], node.lo[2][i]),
          space.lo + glm::vec3(node.hi[0][i], node.hi[1][i], node.hi[2][i])};
}

/// Triangles that `take(corners)` takes, below children whose box `keep(box)` keeps.
template <class Keep, class Take>
std::vector<std::uint32_t> query(const Bvh8& tree, Keep&& keep, Take&& take) {
  std::vector<std::uint32_t> found;
  std::vector<std::uint32_t> stack;
  if (!tree.nodes.empty()) stack.push_back(0);
  while (!stack.empty()) {
    const Bvh8Node& node = tree.nodes[stack.back()];
    stack.pop_back();
    for (int i = 0; i < 8; ++i) {
      if (!node.has(i) || !keep(child_box(tree, node, i))) continue;
      if ((node.ref[i] & bvh8_leaf) == 0) {
        stack.push_back(node.ref[i]);
        continue;
      }
      const auto [first, k] = leaf_of(node.ref[i]);
      const std::uint32_t* words = tree.triangles.data() + std::size_t{first} * bvh8_words_per_triangle;
      for (std::uint32_t t = 0; t < k; ++t) {
        glm::vec3 corners[3];
        for (std::uint32_t j = 0; j < 9; ++j)
          corners[j / 3][static_cast<int>(j % 3)] = std::bit_cast<float>(words[(j + 1) * k + t]);
        if (take(corners)) found.push_back(words[t]);
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

RayHit trace_nearest_scalar(const Bvh8& tree, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return {};
  RayHit best{prepared.t_far, no_triangle};
  std::vector<std::uint32_t> stack(tree.nodes.empty() ? 0 : 1, 0u);
  while (!stack.empty()) {
    const Bvh8Node& node = tree.nodes[stack.back()];
    stack.pop_back();
    ++counters.nodes;
    for (int i = 0; i < 8; ++i) {
      if (!node.has(i)) continue;
      const Aabb box = child_box(tree, node, i);
      float enter = 0.0f, leave = 0.0f;
      pass_box(prepared, box.lo, box.hi, enter, leave);
      if (!(enter <= std::min(leave, best.t))) continue;
      if ((node.ref[i] & bvh8_leaf) == 0) {
        stack.push_back(node.ref[i]);
        continue;
      }
      const auto [first, k] = leaf_of(node.ref[i]);
      const std::uint32_t* words = tree.triangles.data() + std::size_t{first} * bvh8_words_per_triangle;
      for (std::uint32_t t = 0; t < k; ++t) {
        float corner[9];
        for (std::uint32_t j = 0; j < 9; ++j) corner[j] = std::bit_cast<float>(words[(j + 1) * k + t]);
        (void)try_triangle(prepared, corner, corner + 3, corner + 6, words[t], best);
      }
      counters.tests += k;
    }
  }
  return finish(prepared, best);
}

Bvh8 widen(const Bvh& bvh, const TriangleSoup& soup) { return Widener(bvh, soup).build(); }

Bvh8 build_bvh8(const TriangleSoup& soup) {
  // Small leaves, which the collapse joins where that is cheaper.
  return widen(build_bvh(bounds_of_triangles(soup), {.max_leaf_size = 4, .grouped = false}), soup);
}

std::vector<std::uint32_t> box_query(const Bvh8& tree, const Aabb& box) {
  return query(
      tree, [&](const Aabb& b) { return b.overlaps(box); },
      [&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
}

std::vector<std::uint32_t> frustum_query(const Bvh8& tree, const Frustum& frustum) {
  return query(
      tree, [&](const Aabb& b) { return classify(frustum, b) != Containment::outside; },
      [&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
}

}  // namespace sightline
