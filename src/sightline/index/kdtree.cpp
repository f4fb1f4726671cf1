#include "sightline/index/kdtree.hpp"

#include <array>
#include <bit>
#include <cmath>

#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/index/cell_items.hpp"

namespace sightline {
namespace {

constexpr int most_bins = 32;
/// A split that leaves more than this share of twice its items, mostly triangles that lie on both sides, may be made
/// so often on the way down: often the next one parts them.
constexpr double bad_share = 0.7;
constexpr int most_bad = 2;

struct Plane1 {
  int axis = -1;
  float at = 0.0f;
};

class Builder {
 public:
  Builder(const TriangleSoup& soup, const KdConfig& config) : soup_(soup), config_(config) {}

  KdTree build() {
    if (soup_.size() == 0) return {};
    tree_.space = trace_space(bounds_of(soup_));
    margin_ = 3.0 * static_cast<double>(tree_.space.slack);
    tree_.bounds = tree_.space.bounds;
    tree_.bounds.lo -= 8.0f * tree_.space.slack;
    tree_.bounds.hi += 8.0f * tree_.space.slack;
    const int limit = config_.max_depth > 0 ? config_.max_depth
                                            : 8 + static_cast<int>(1.3 * std::log2(static_cast<double>(soup_.size())));
    tree_.nodes.emplace_back();
    Task root{tree_.bounds, 0, 0, 0, {}};
    root.items.resize(soup_.size());
    for (std::uint32_t i = 0; i < root.items.size(); ++i) root.items[i] = i;
    std::vector<Task> stack;
    stack.push_back(std::move(root));
    while (!stack.empty()) {
      Task task = std::move(stack.back());
      stack.pop_back();
      const Plane1 plane = task.depth < limit ? choose(task) : Plane1{};
      Task low{task.cell, task.depth + 1, 0, task.bad, {}}, high = low;
      if (plane.axis < 0 || !part(task, plane, low, high) || !worth(task, low, high)) {
        make_leaf(task);
        continue;
      }
      const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
      KdNode& node = tree_.nodes[task.node];
      node.split_bits = std::bit_cast<std::uint32_t>(plane.at);
      node.axis = static_cast<std::uint32_t>(plane.axis) & 3u;
      node.first = first & 0x3FFFFFFFu;
      tree_.nodes.resize(tree_.nodes.size() + 2);
      low.node = first;
      high.node = first + 1;
      stack.push_back(std::move(high));
      stack.push_back(std::move(low));
    }
    return std::move(tree_);
  }

 private:
  struct Task {
    Aabb cell;
    int depth;
    std::uint32_t node;
    int bad;  // splits above that gained little
    std::vector<std::uint32_t> items;
  };

  void make_leaf(const Task& task) {
    KdNode& node = tree_.nodes[task.node];
    node.axis = 3;
    node.split_bits = static_cast<std::uint32_t>(tree_.items.size());
    node.first = static_cast<std::uint32_t>(task.items.size()) & 0x3FFFFFFFu;
    tree_.items.insert(tree_.items.end(), task.items.begin(), task.items.end());
  }

  [[nodiscard]] bool may_split(const Aabb& cell, int axis) const {
    return ((config_.axes >> axis) & 1u) != 0 && cell.extent()[axis] > 16.0f * tree_.space.slack;
  }

  [[nodiscard]] Plane1 choose(const Task& task) const {
    return config_.split == KdSplit::median ? choose_median(task) : choose_sah(task);
  }

  /// Median of the centroids along the longest side of the cell.
  [[nodiscard]] Plane1 choose_median(const Task& task) const {
    if (task.items.size() <= config_.leaf_size) return {};
    Plane1 plane;
    for (int axis = 0; axis < 3; ++axis)
      if (may_split(task.cell, axis) && (plane.axis < 0 || task.cell.extent()[axis] > task.cell.extent()[plane.axis]))
        plane.axis = axis;
    if (plane.axis < 0) return {};
    std::vector<float> centres;
    for (const std::uint32_t item : task.items)
      centres.push_back(triangle_bounds(soup_.triangle(item)).centre()[plane.axis]);
    std::nth_element(centres.begin(), centres.begin() + static_cast<std::ptrdiff_t>(centres.size() / 2), centres.end());
    const float lo = task.cell.lo[plane.axis], extent = task.cell.extent()[plane.axis];
    plane.at = std::clamp(centres[centres.size() / 2], lo + 0.02f * extent, lo + 0.98f * extent);
    return plane;
  }

  /// Cheapest of the borders between bins on every axis; a leaf if none is cheaper than testing all.
  [[nodiscard]] Plane1 choose_sah(const Task& task) const {
    Plane1 best;
    const glm::vec3 extent = task.cell.extent();
    const float area = task.cell.half_area();
    float best_cost = static_cast<float>(task.items.size()) * area;
    if (task.items.size() <= 1) return best;
    // Most nodes hold few triangles, and looking at borders costs more there than at triangles.
    const int bins = task.items.size() > 64 ? most_bins : task.items.size() > 16 ? 16 : 8;
    std::array<std::array<std::uint32_t, most_bins>, 3> starts, ends;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::fill_n(starts[axis].begin(), bins, 0u);
      std::fill_n(ends[axis].begin(), bins, 0u);
    }
    glm::vec3 scale(0.0f);
    for (int axis = 0; axis < 3; ++axis)
      if (extent[axis] > 0.0f) scale[axis] = static_cast<float>(bins) / extent[axis];
    for (const std::uint32_t item : task.items) {
      const Aabb box = triangle_bounds(soup_.triangle(item));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int a = static_cast<int>(axis);
        const auto bin = [&](float x) {
          const float place = (x - task.cell.lo[a]) * scale[a];
          return static_cast<std::size_t>(static_cast<int>(std::clamp(place, 0.0f, static_cast<float>(bins - 1))));
        };
        ++starts[axis][bin(box.lo[a])];
        ++ends[axis][bin(box.hi[a])];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!may_split(task.cell, axis)) continue;
      const int y = (axis + 1) % 3, z = (axis + 2) % 3;
      const float side = extent[y] * extent[z], ring = extent[y] + extent[z];
      std::uint32_t below = 0;
      auto above = static_cast<std::uint32_t>(task.items.size());
      for (int b = 1; b < bins; ++b) {
        below += starts[static_cast<std::size_t>(axis)][static_cast<std::size_t>(b - 1)];
        above -= ends[static_cast<std::size_t>(axis)][static_cast<std::size_t>(b - 1)];
        const float low = extent[axis] * static_cast<float>(b) / static_cast<float>(bins), high = extent[axis] - low;
        float cost = (side + low * ring) * static_cast<float>(below) + (side + high * ring) * static_cast<float>(above);
        if (below == 0 || above == 0) cost *= config_.empty_bonus;
        cost += config_.node_cost * area;
        if (!(cost < best_cost)) continue;
        best_cost = cost;
        best = {axis, task.cell.lo[axis] + low};
      }
    }
    return best;
  }

  /// Items of both sides; false if nothing is gained.
  bool part(const Task& task, const Plane1& plane, Task& low, Task& high) const {
    low.cell.hi[plane.axis] = plane.at;
    high.cell.lo[plane.axis] = plane.at;
    for (const std::uint32_t item : task.items) {
      const glm::vec3* corners = soup_.triangle(item);
      const Aabb box = triangle_bounds(corners);
      const double lo = static_cast<double>(box.lo[plane.axis]) - margin_,
                   hi = static_cast<double>(box.hi[plane.axis]) + margin_;
      const auto at = static_cast<double>(plane.at);
      const bool both = lo <= at && hi >= at;
      bool below = lo <= at, above = hi >= at;
      if (both) {
        below = triangle_touches_box(corners, low.cell, margin_);
        above = triangle_touches_box(corners, high.cell, margin_);
      }
      if (below) low.items.push_back(item);
      if (above) high.items.push_back(item);
    }
    return low.items.size() < task.items.size() || high.items.size() < task.items.size();
  }

  /// SAH weighs by itself what a split gains; the median needs to be told when to stop (E26).
  bool worth(const Task& task, Task& low, Task& high) const {
    if (config_.split != KdSplit::median) return true;
    const auto left = static_cast<double>(low.items.size() + high.items.size());
    if (left > 2.0 * bad_share * static_cast<double>(task.items.size())) low.bad = high.bad = task.bad + 1;
    return low.bad <= most_bad;
  }

  const TriangleSoup& soup_;
  KdConfig config_;
  double margin_ = 0.0;
  KdTree tree_;
};

struct Step {
  float enter, leave;
  std::uint32_t node;
};

template <bool any>
RayHit walk(const KdTree& tree, const TriangleSoup& soup, const TraceRay& ray, TraceCounters& counters) {
  Step first_step{0.0f, 0.0f, 0};
  pass_box(ray, tree.bounds.lo, tree.bounds.hi, first_step.enter, first_step.leave);
  const auto split = [&ray](const KdNode& node, Step& now, Step* stack, std::size_t& top) {
    if (node.axis >= 3) return false;
    const int axis = static_cast<int>(node.axis);
    const float t = (std::bit_cast<float>(node.split_bits) - ray.origin[axis]) * ray.inverse[axis];
    const float slack = 2.0f * ray.slack[axis];
    const bool forward = ray.inverse[axis] >= 0.0f;
    const std::uint32_t first = node.first + (forward ? 0u : 1u), second = node.first + (forward ? 1u : 0u);
    const bool near = now.enter <= t + slack, far = now.leave >= t - slack;
    if (near && far) {
      stack[top++] = {std::max(now.enter, t - slack), now.leave, second};
      now = {now.enter, std::min(now.leave, t + slack), first};
    } else {
      now.node = near ? first : second;
    }
    return true;
  };
  return walk_cells<any, 128>(tree, soup, ray, first_step, counters, split);  // the depth limit lies below 128
}

template <bool any>
RayHit trace(const KdTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (tree.nodes.empty() || !prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, walk<any>(tree, soup, prepared, counters));
}

}  // namespace

KdTree build_kdtree(const TriangleSoup& soup, const KdConfig& config) {
  KdConfig bounded = config;
  bounded.max_depth = std::min(config.max_depth, 100);
  return Builder(soup, bounded).build();
}

RayHit trace_nearest(const KdTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<false>(tree, soup, ray, counters);
}

bool trace_any(const KdTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<true>(tree, soup, ray, counters).found();
}

std::vector<std::uint32_t> box_query(const KdTree& tree, const TriangleSoup& soup, const Aabb& box) {
  return query_cells(
      tree, soup, [&](const Aabb& b) { return b.overlaps(box); },
      [&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
}

std::vector<std::uint32_t> frustum_query(const KdTree& tree, const TriangleSoup& soup, const Frustum& frustum) {
  return query_cells(
      tree, soup, [&](const Aabb& b) { return classify(frustum, b) != Containment::outside; },
      [&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
}

}  // namespace sightline
