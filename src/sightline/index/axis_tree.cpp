#include "sightline/index/axis_tree.hpp"

#include <cmath>

#include "sightline/geometry/triangle_overlap.hpp"

namespace sightline {
namespace {

class Builder {
 public:
  Builder(const TriangleSoup& soup, const AxisTreeConfig& config) : soup_(soup), config_(config) {}

  AxisTree build() {
    if (soup_.size() == 0) return {};
    tree_.space = trace_space(bounds_of(soup_));
    margin_ = 3.0 * static_cast<double>(tree_.space.slack);
    set_root_cell();
    const int limit = config_.max_depth > 0 ? config_.max_depth : default_depth();
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

struct Step {
  Aabb cell;
  float enter, leave;
  std::uint32_t node;
};

/// Splits a passage through a cell at the middle of each axis of the mask into passages through children, nearest
/// first; where the ray is within the slack of a middle plane it passes both sides.
int child_steps(const AxisNode& node, const Step& step, const TraceRay& ray, Step* out) {
  out[0] = {step.cell, step.enter, step.leave, node.first};
  int count = 1;
  std::uint32_t upper = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (((node.axes >> axis) & 1u) == 0) continue;
    const float middle = 0.5f * (step.cell.lo[axis] + step.cell.hi[axis]);
    const float t = (middle - ray.origin[axis]) * ray.inverse[axis], slack = ray.slack[axis];
    const bool forward = ray.inverse[axis] >= 0.0f;
    for (int i = count; i-- > 0;) {
      const bool near = out[i].enter <= t + slack, far = out[i].leave >= t - slack;
      Step low = out[i], high = out[i];
      low.cell.hi[axis] = middle;
      high.cell.lo[axis] = middle;
      high.node += upper;
      Step& first = forward ? low : high;
      Step& second = forward ? high : low;
      first.leave = std::min(first.leave, t + slack);
      second.enter = std::max(second.enter, t - slack);
      if (near && far) {
        for (int j = count++; j > i + 1; --j) out[j] = out[j - 1];
        out[i] = first;
        out[i + 1] = second;
      } else {
        out[i] = near ? first : second;
      }
    }
    upper *= 2;
  }
  return count;
}

template <bool any>
RayHit walk(const AxisTree& tree, const TriangleSoup& soup, const TraceRay& ray, TraceCounters& counters) {
  RayHit best{ray.t_far, no_triangle};
  Step root{tree.bounds, 0.0f, 0.0f, 0};
  pass_box(ray, tree.bounds.lo, tree.bounds.hi, root.enter, root.leave);
  if (!(root.enter <= root.leave)) return best;
  Mailbox mailbox;
  thread_local std::vector<Step> stack;
  stack.assign(1, root);
  while (!stack.empty()) {
    const Step step = stack.back();
    stack.pop_back();
    // Later cells may still hold a nearer hit than one found beyond its cell: the in-cell rule of E24.
    if (step.enter > best.t) continue;
    const AxisNode& node = tree.nodes[step.node];
    ++counters.nodes;
    if (node.axes != 0) {
      Step children[8];
      for (int i = child_steps(node, step, ray, children); i-- > 0;) stack.push_back(children[i]);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t triangle = tree.items[i];
      if (!mailbox.enter(triangle)) continue;
      ++counters.tests;
      if (counters.tested != nullptr) counters.tested->push_back(triangle);
      if (try_triangle(ray, soup, triangle, best) && any) return best;
    }
  }
  return best;
}

template <bool any>
RayHit trace(const AxisTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (tree.nodes.empty() || !prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, walk<any>(tree, soup, prepared, counters));
}

template <class Keep, class Take>
std::vector<std::uint32_t> query(const AxisTree& tree, const TriangleSoup& soup, Keep&& keep, Take&& take) {
  std::vector<std::uint32_t> found;
  struct Task {
    Aabb cell;
    std::uint32_t node;
  };
  std::vector<Task> stack;
  if (!tree.nodes.empty()) stack.push_back({tree.bounds, 0});
  while (!stack.empty()) {
    const Task task = stack.back();
    stack.pop_back();
    if (!keep(task.cell)) continue;
    const AxisNode& node = tree.nodes[task.node];
    for (std::uint32_t k = 0; node.axes != 0 && k < (1u << std::popcount(std::uint32_t{node.axes})); ++k)
      stack.push_back({child_cell(task.cell, node.axes, k), node.first + k});
    if (node.axes == 0)
      found.insert(found.end(), tree.items.begin() + node.first, tree.items.begin() + node.first + node.count);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::erase_if(found, [&](std::uint32_t i) { return !take(soup.triangle(i)); });
  return found;
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
  return query(
      tree, soup, [&](const Aabb& b) { return b.overlaps(box); },
      [&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
}

std::vector<std::uint32_t> frustum_query(const AxisTree& tree, const TriangleSoup& soup, const Frustum& frustum) {
  return query(
      tree, soup, [&](const Aabb& b) { return classify(frustum, b) != Containment::outside; },
      [&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
}

}  // namespace sightline
