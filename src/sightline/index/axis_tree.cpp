#include "sightline/index/axis_tree.hpp"

#include <array>
#include <cmath>

#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/index/cell_items.hpp"

namespace sightline {
namespace {

constexpr int most_depth = 64;

class Builder {
 public:
  Builder(const TriangleSoup& soup, const AxisTreeConfig& config) : soup_(soup), config_(config) {}

  AxisTree build() {
    if (soup_.size() == 0) return {};
    tree_.space = trace_space(bounds_of(soup_));
    margin_ = 3.0 * static_cast<double>(tree_.space.slack);
    set_root_cell();
    const int limit = std::min(config_.max_depth > 0 ? config_.max_depth : default_depth(), most_depth);
    tree_.nodes.emplace_back();
    std::vector<std::uint32_t> all(soup_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    std::vector<Task> stack;
    stack.push_back({tree_.bounds, 0, 0, std::move(all)});
    while (!stack.empty()) {
      Task task = std::move(stack.back());
      stack.pop_back();
      const std::uint32_t axes = task.depth < limit ? axes_for(task) : 0u;
      std::vector<Task> children;
      if (axes == 0 || !split(task, axes, children)) {
        tree_.nodes[task.node].first = static_cast<std::uint32_t>(tree_.items.size());
        tree_.nodes[task.node].count = static_cast<std::uint32_t>(task.items.size()) & 0x1FFFFFFFu;
        tree_.items.insert(tree_.items.end(), task.items.begin(), task.items.end());
        continue;
      }
      const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
      tree_.nodes[task.node].first = first;
      tree_.nodes[task.node].axes = axes & 7u;
      tree_.nodes.resize(tree_.nodes.size() + children.size());
      for (std::uint32_t k = static_cast<std::uint32_t>(children.size()); k-- > 0;) {
        children[k].node = first + k;
        stack.push_back(std::move(children[k]));
      }
    }
    return std::move(tree_);
  }

 private:
  struct Task {
    Aabb cell;
    int depth;
    std::uint32_t node;
    std::vector<std::uint32_t> items;
  };

  void set_root_cell() {
    Aabb box = tree_.space.bounds;
    const float grow = 8.0f * tree_.space.slack;
    box.lo -= grow;
    box.hi += grow;
    if (config_.cube) {
      const glm::vec3 extent = box.extent();
      float side = 0.0f;
      for (int axis = 0; axis < 3; ++axis)
        if (((config_.axes >> axis) & 1u) != 0) side = std::max(side, extent[axis]);
      for (int axis = 0; axis < 3; ++axis)
        if (((config_.axes >> axis) & 1u) != 0) {
          const float middle = 0.5f * (box.lo[axis] + box.hi[axis]);
          box.lo[axis] = std::min(box.lo[axis], middle - 0.5f * side);
          box.hi[axis] = std::max(box.hi[axis], middle + 0.5f * side);
        }
    }
    tree_.bounds = box;
  }

  [[nodiscard]] int default_depth() const {
    const double levels = std::log2(static_cast<double>(soup_.size()) + 1.0);
    const int axes = config_.alternating ? 1 : std::popcount(config_.axes & 7u);
    return std::min(static_cast<int>(levels / (axes == 1 ? 0.7 : axes == 2 ? 1.3 : 1.8)) + 2, axes == 1 ? 60 : 21);
  }

  /// Which axes to halve; 0 for a leaf.
  [[nodiscard]] std::uint32_t axes_for(const Task& task) const {
    if (task.items.size() <= config_.leaf_size) return 0;
    std::uint32_t axes = config_.axes & 7u;
    if (config_.alternating) {
      int longest = -1;
      for (int axis = 0; axis < 3; ++axis)
        if (((config_.axes >> axis) & 1u) != 0 &&
            (longest < 0 || task.cell.extent()[axis] > task.cell.extent()[longest]))
          longest = axis;
      axes = longest < 0 ? 0u : 1u << longest;
    }
    // Cells that rounding can no longer halve, or that are as small as the slack, are not split.
    for (int axis = 0; axis < 3; ++axis)
      if (((axes >> axis) & 1u) != 0 && task.cell.extent()[axis] < 16.0f * tree_.space.slack) axes &= ~(1u << axis);
    return axes;
  }

  /// Items of the children; false if splitting gains nothing.
  bool split(const Task& task, std::uint32_t axes, std::vector<Task>& children) {
    const std::uint32_t n = 1u << std::popcount(axes);
    float cost = 0.0f;
    for (std::uint32_t k = 0; k < n; ++k) {
      children.push_back({child_cell(task.cell, axes, k), task.depth + 1, 0, {}});
      for (const std::uint32_t item : task.items)
        if (triangle_touches_box(soup_.triangle(item), children[k].cell, margin_)) children[k].items.push_back(item);
      cost += children[k].cell.half_area() * static_cast<float>(children[k].items.size());
    }
    // E26: by the surface area heuristic, a split must save tests. Around a vertex that many share, and on large
    // triangles that reach into most children, it does not, however deep one goes.
    const float area = task.cell.half_area(), before = static_cast<float>(task.items.size()) * area;
    return cost + config_.node_cost * area < before;
  }

  const TriangleSoup& soup_;
  AxisTreeConfig config_;
  double margin_ = 0.0;
  AxisTree tree_;
};

/// A passage through the cell of a node.
struct Step {
  glm::vec3 lo, hi;
  float enter, leave;
  std::uint32_t node;
};

/// Bits of the axes in the mask, moved together: the number of the child in these upper halves.
constexpr auto child_numbers = [] {
  std::array<std::array<std::uint8_t, 8>, 8> table{};
  for (std::uint32_t mask = 0; mask < 8; ++mask)
    for (std::uint32_t upper = 0; upper < 8; ++upper)
      for (std::uint32_t axis = 0, bit = 0; axis < 3; ++axis)
        if (((mask >> axis) & 1u) != 0)
          table[mask][upper] = static_cast<std::uint8_t>(table[mask][upper] | ((upper >> axis) & 1u) << bit++);
  return table;
}();

/// Splits passages at the middles of cells into passages through children.
class Splitter {
 public:
  explicit Splitter(const TraceRay& ray) : ray_(ray) {
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      backward_ |= (ray.inverse[static_cast<int>(axis)] >= 0.0f ? 0u : 1u) << axis;
  }

  /// Replaces the passage by that through the nearest child and puts the others on the stack, the farthest first. Where
  /// the ray is within the slack of a middle plane it passes both sides.
  void split(const AxisNode& node, Step& now, Step* stack, std::size_t& top) const {
    Middle middles[3];
    std::uint32_t far = 0;  // halves that the ray comes to last
    int crossed = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (((node.axes >> axis) & 1u) == 0) continue;
      const float at = 0.5f * (now.lo[axis] + now.hi[axis]), t = (at - ray_.origin[axis]) * ray_.inverse[axis];
      const Middle m{t - ray_.slack[axis], t + ray_.slack[axis], 1u << axis};
      if (!(now.enter <= m.last)) {
        far |= m.axis;
      } else if (now.leave >= m.first) {
        int i = crossed++;
        for (; i > 0 && middles[i - 1].first > m.first; --i) middles[i] = middles[i - 1];
        middles[i] = m;
      }
    }
    if (crossed > 0) cross(node, now, far, middles, crossed, stack, top);
    enter_child(node, far, now);
  }

 private:
  struct Middle {
    float first, last;  // of the ray's time at the plane
    std::uint32_t axis;
  };

  /// Middles in the order of the ray. Between any two that it meets one after the other there is one child; where it
  /// may meet several at once, one for each combination of their halves.
  void cross(const AxisNode& node, Step& now, std::uint32_t far, const Middle* middles, int count, Step* stack,
             std::size_t& top) const {
    const bool apart =
        (count < 2 || middles[0].last < middles[1].first) && (count < 3 || middles[1].last < middles[2].first);
    if (apart) {
      std::uint32_t passed = far;
      for (int i = 0; i < count; ++i) passed |= middles[i].axis;
      float leave = now.leave;
      for (int i = count; i-- > 0;) {
        push(node, now, passed, std::max(now.enter, middles[i].first), leave, stack, top);
        passed &= ~middles[i].axis;
        leave = std::min(now.leave, middles[i].last);
      }
      now.leave = leave;
      return;
    }
    for (std::uint32_t halves = (1u << count) - 1u; halves > 0; --halves) {
      float enter = now.enter, leave = now.leave;
      std::uint32_t passed = far;
      for (int i = 0; i < count; ++i)
        if (((halves >> i) & 1u) != 0) {
          enter = std::max(enter, middles[i].first);
          passed |= middles[i].axis;
        } else {
          leave = std::min(leave, middles[i].last);
        }
      if (enter <= leave) push(node, now, passed, enter, leave, stack, top);
    }
    for (int i = 0; i < count; ++i) now.leave = std::min(now.leave, middles[i].last);
  }

  void push(const AxisNode& node, const Step& from, std::uint32_t far, float enter, float leave, Step* stack,
            std::size_t& top) const {
    Step& step = stack[top++];
    step = {from.lo, from.hi, enter, leave, from.node};
    enter_child(node, far, step);
  }

  void enter_child(const AxisNode& node, std::uint32_t far, Step& step) const {
    const std::uint32_t upper = (far ^ backward_) & node.axes;
    for (int axis = 0; axis < 3; ++axis) {
      const float middle = 0.5f * (step.lo[axis] + step.hi[axis]);
      const bool halved = ((node.axes >> axis) & 1u) != 0, high = ((upper >> axis) & 1u) != 0;
      step.lo[axis] = halved && high ? middle : step.lo[axis];
      step.hi[axis] = halved && !high ? middle : step.hi[axis];
    }
    step.node = node.first + child_numbers[node.axes][upper];
  }

  const TraceRay& ray_;
  std::uint32_t backward_ = 0;
};

template <bool any>
RayHit walk(const AxisTree& tree, const TriangleSoup& soup, const TraceRay& ray, TraceCounters& counters) {
  Step first{tree.bounds.lo, tree.bounds.hi, 0.0f, 0.0f, 0};
  pass_box(ray, tree.bounds.lo, tree.bounds.hi, first.enter, first.leave);
  const Splitter splitter(ray);
  const auto split = [&splitter](const AxisNode& node, Step& now, Step* stack, std::size_t& top) {
    if (node.axes == 0) return false;
    splitter.split(node, now, stack, top);
    return true;
  };
  return walk_cells<any, 7 * most_depth>(tree, soup, ray, first, counters, split);
}

template <bool any>
RayHit trace(const AxisTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (tree.nodes.empty() || !prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, walk<any>(tree, soup, prepared, counters));
}

}  // namespace

AxisTree build_axis_tree(const TriangleSoup& soup, const AxisTreeConfig& config) {
  return Builder(soup, config).build();
}

AxisTree build_octree(const TriangleSoup& soup) { return build_axis_tree(soup); }

AxisTree build_quadtree(const TriangleSoup& soup) {
  const glm::vec3 extent = soup.size() == 0 ? glm::vec3(0.0f) : bounds_of(soup).extent();
  const int least = extent.x < extent.y && extent.x < extent.z ? 0 : extent.y <= extent.z ? 1 : 2;
  return build_axis_tree(soup, {.axes = 7u & ~(1u << least)});
}

RayHit trace_nearest(const AxisTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<false>(tree, soup, ray, counters);
}

bool trace_any(const AxisTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<true>(tree, soup, ray, counters).found();
}

std::vector<std::uint32_t> box_query(const AxisTree& tree, const TriangleSoup& soup, const Aabb& box) {
  return query_cells(
      tree, soup, [&](const Aabb& b) { return b.overlaps(box); },
      [&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
}

std::vector<std::uint32_t> frustum_query(const AxisTree& tree, const TriangleSoup& soup, const Frustum& frustum) {
  return query_cells(
      tree, soup, [&](const Aabb& b) { return classify(frustum, b) != Containment::outside; },
      [&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
}

}  // namespace sightline
