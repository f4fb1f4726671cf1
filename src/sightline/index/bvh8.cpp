#include "sightline/index/bvh8.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/index/bvh_builders.hpp"

namespace sightline {
namespace {

/// Up to eight binary nodes that become the children of a wide one.
struct Group {
  std::array<std::uint32_t, 8> node{};
  int count = 0;
};

/// Opens the inner child of largest area until there are eight. Inner ones first, in the order they were found.
Group gather(const Bvh& bvh, std::uint32_t root) {
  Group group;
  group.node[0] = root;
  group.count = 1;
  while (group.count < 8) {
    int widest = -1;
    float area = -1.0f;
    for (int i = 0; i < group.count; ++i) {
      const BvhNode& node = bvh.nodes[group.node[static_cast<std::size_t>(i)]];
      if (node.leaf() || !(node.bounds.half_area() > area)) continue;
      widest = i;
      area = node.bounds.half_area();
    }
    if (widest < 0) break;
    const std::uint32_t first = bvh.nodes[group.node[static_cast<std::size_t>(widest)]].first;
    group.node[static_cast<std::size_t>(widest)] = first;
    group.node[static_cast<std::size_t>(group.count++)] = first + 1;
  }
  std::stable_partition(group.node.begin(), group.node.begin() + group.count,
                        [&](std::uint32_t n) { return !bvh.nodes[n].leaf(); });
  return group;
}

/// Exponent of the least power of two of which 255 span the extent, biased as in a float.
std::uint8_t exponent_for(float lo, float hi) {
  const double extent = static_cast<double>(hi) - static_cast<double>(lo);
  if (!(extent > 0x1p-110)) return 10;
  int exponent = 0;
  (void)std::frexp(extent / 255.0, &exponent);  // extent / 255 <= 2^exponent
  return static_cast<std::uint8_t>(std::clamp(exponent + 127, 10, 250));
}

class Widener {
 public:
  Widener(const Bvh& bvh, const TriangleSoup& soup) : bvh_(bvh), soup_(soup) {}

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
      const Group group = gather(bvh_, task.from);
      fill(task.to, group);
      const int inner = tree_.nodes[task.to].inner();
      for (int i = inner; i-- > 0;)
        stack.push_back({group.node[static_cast<std::size_t>(i)],
                         tree_.nodes[task.to].first_child + static_cast<std::uint32_t>(i), task.depth + 1});
    }
    tree_.triangles.resize(tree_.triangles.size() + padding);
    return std::move(tree_);
  }

 private:
  struct Task {
    std::uint32_t from, to;
    int depth;
  };

  void fill(std::uint32_t to, const Group& group) {
    Aabb bounds;
    int inner = 0;
    for (int i = 0; i < group.count; ++i) {
      const BvhNode& child = bvh_.nodes[group.node[static_cast<std::size_t>(i)]];
      bounds.extend(child.bounds);
      inner += child.leaf() ? 0 : 1;
    }
    Bvh8Node node{};
    node.origin = bounds.lo;
    node.counts = static_cast<std::uint8_t>(inner + 16 * group.count);
    node.first_child = static_cast<std::uint32_t>(tree_.nodes.size());
    node.first_triangle = tree_.triangle_count;
    for (int axis = 0; axis < 3; ++axis) quantise(node, axis, bounds, group);
    for (int i = inner; i < group.count; ++i) {
      add_leaf(bvh_.nodes[group.node[static_cast<std::size_t>(i)]]);
      node.ends[i] = static_cast<std::uint8_t>(tree_.triangle_count - node.first_triangle);
    }
    tree_.nodes[to] = node;
    tree_.nodes.resize(tree_.nodes.size() + static_cast<std::size_t>(inner));
  }

  void quantise(Bvh8Node& node, int axis, const Aabb& bounds, const Group& group) const {
    node.exponent[axis] = exponent_for(bounds.lo[axis], bounds.hi[axis]);
    const double scale = std::ldexp(1.0, 127 - node.exponent[axis]), base = static_cast<double>(bounds.lo[axis]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(group.count); ++i) {
      const Aabb& box = bvh_.nodes[group.node[i]].bounds;
      const double lo = (static_cast<double>(box.lo[axis]) - base) * scale;
      const double hi = (static_cast<double>(box.hi[axis]) - base) * scale;
      node.lo[axis][i] = static_cast<std::uint8_t>(std::clamp(std::floor(lo), 0.0, 255.0));
      node.hi[axis][i] = static_cast<std::uint8_t>(std::clamp(std::ceil(hi), 0.0, 255.0));
    }
  }

  void add_leaf(const BvhNode& leaf) {
    const std::size_t k = leaf.count, at = tree_.triangles.size();
    tree_.triangles.resize(at + k * bvh8_words_per_triangle);
    std::uint32_t* words = tree_.triangles.data() + at;
    for (std::size_t i = 0; i < k; ++i) {
      const std::uint32_t place = bvh_.items[leaf.first + i];
      words[i] = place;
      const float* corners = &soup_.triangle(place)->x;
      for (std::size_t j = 0; j < 9; ++j) std::memcpy(&words[(j + 1) * k + i], &corners[j], 4);
    }
    tree_.triangle_count += leaf.count;
  }

  const Bvh& bvh_;
  const TriangleSoup& soup_;
  Bvh8 tree_;
};

/// A child's bounds in floats, one step outwards for the rounding of the sum.
Aabb child_box(const Bvh8Node& node, int i) {
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const float scale = std::bit_cast<float>(static_cast<std::uint32_t>(node.exponent[axis]) << 23);
    box.lo[axis] = std::nextafter(node.origin[axis] + static_cast<float>(node.lo[axis][i]) * scale, -INFINITY);
    box.hi[axis] = std::nextafter(node.origin[axis] + static_cast<float>(node.hi[axis][i]) * scale, INFINITY);
  }
  return box;
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
    std::uint32_t begin = 0;
    for (int i = 0; i < node.count(); ++i) {
      const bool kept = keep(child_box(node, i));
      if (i < node.inner()) {
        if (kept) stack.push_back(node.first_child + static_cast<std::uint32_t>(i));
        continue;
      }
      const std::uint32_t end = node.ends[i], k = end - begin;
      const std::uint32_t* words =
          tree.triangles.data() + std::size_t{node.first_triangle + begin} * bvh8_words_per_triangle;
      begin = end;
      if (!kept) continue;
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
    std::uint32_t begin = 0;
    for (int i = 0; i < node.count(); ++i) {
      const std::uint32_t from = begin;
      if (i >= node.inner()) begin = node.ends[i];
      const Aabb box = child_box(node, i);
      float enter = 0.0f, leave = 0.0f;
      pass_box(prepared, box.lo, box.hi, enter, leave);
      if (!(enter <= std::min(leave, best.t))) continue;
      if (i < node.inner()) {
        stack.push_back(node.first_child + static_cast<std::uint32_t>(i));
        continue;
      }
      const std::uint32_t k = begin - from;
      const std::uint32_t* words =
          tree.triangles.data() + std::size_t{node.first_triangle + from} * bvh8_words_per_triangle;
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
  // Up to eight triangles are one test in vectors: leaves are cheap, and large ones keep the tree small.
  const BvhBuildConfig config{.max_leaf_size = static_cast<int>(bvh8_leaf_limit), .node_cost = 3.5f};
  return widen(build_bvh_sah(bounds_of_triangles(soup), config), soup);
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
