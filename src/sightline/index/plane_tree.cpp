#include "sightline/index/plane_tree.hpp"

#include <cmath>
#include <span>

#include "sightline/geometry/pca.hpp"
#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/index/cell_items.hpp"

namespace sightline {
namespace {

constexpr int most_depth = 100;
constexpr int most_bad = 2;

class Builder {
 public:
  Builder(const TriangleSoup& soup, const PlaneTreeConfig& config) : soup_(soup), config_(config) {}

  PlaneTree build() {
    if (soup_.size() == 0) return {};
    tree_.space = trace_space(bounds_of(soup_));
    margin_ = 3.0 * static_cast<double>(tree_.space.slack);
    const int limit =
        std::min(config_.max_depth > 0 ? config_.max_depth
                                       : 8 + static_cast<int>(1.3 * std::log2(static_cast<double>(soup_.size()))),
                 most_depth);
    Task root{0, 0, 0, 4 * soup_.size(), {}, {}};
    for (std::uint32_t i = 0; i < soup_.size(); ++i) {
      root.pieces.push_back({i, 3});
      root.corners.insert(root.corners.end(), soup_.triangle(i), soup_.triangle(i) + 3);
    }
    tree_.nodes.emplace_back();
    std::vector<Task> stack;
    stack.push_back(std::move(root));
    while (!stack.empty()) {
      Task task = std::move(stack.back());
      stack.pop_back();
      for (const Piece& piece : task.pieces)
        tree_.nodes[task.node].bounds.extend(triangle_bounds(soup_.triangle(piece.item)));
      Task behind{0, task.depth + 1, task.bad, 0, {}, {}}, front = behind;
      if (task.depth >= limit || task.pieces.size() <= config_.leaf_size || !part(task, behind, front)) {
        tree_.nodes[task.node].first = static_cast<std::uint32_t>(tree_.items.size());
        tree_.nodes[task.node].count = static_cast<std::uint32_t>(task.pieces.size());
        for (const Piece& piece : task.pieces) tree_.items.push_back(piece.item);
        continue;
      }
      behind.node = static_cast<std::uint32_t>(tree_.nodes.size());
      front.node = behind.node + 1;
      tree_.nodes[task.node].first = behind.node;
      tree_.nodes.resize(tree_.nodes.size() + 2);
      stack.push_back(std::move(front));
      stack.push_back(std::move(behind));
    }
    return std::move(tree_);
  }

 private:
  /// The part of a triangle that lies in a cell, a convex polygon of the next `corners` corners.
  struct Piece {
    std::uint32_t item, corners;
  };
  struct Task {
    std::uint32_t node;
    int depth;
    int bad;           // cuts above that gained little
    std::size_t room;  // how many pieces more than triangles may come to be below
    std::vector<Piece> pieces;
    std::vector<glm::dvec3> corners;
  };

  /// Parts the pieces by the best of the three planes through their mean across the principal axes: the first axis
  /// alone leaves walls on both sides of every plane. False if too little was gained too often on the way here (E26),
  /// or the tree would hold triangles more than five times on average.
  bool part(const Task& task, Task& behind, Task& front) {
    centres_.clear();
    const glm::dvec3* corners = task.corners.data();
    for (const Piece& piece : task.pieces) {
      glm::dvec3 sum(0.0);
      for (std::uint32_t i = 0; i < piece.corners; ++i) sum += corners[i];
      centres_.push_back(sum / static_cast<double>(piece.corners));
      corners += piece.corners;
    }
    const PrincipalAxes axes = principal_axes(centres_);
    const auto all = static_cast<double>(task.pieces.size());
    PlaneNode& node = tree_.nodes[task.node];
    double best = 1.99 * all * all;
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3 normal = axes.axes[axis];
      const double offset = -glm::dot(normal, axes.mean);
      double low = 0.0, high = 0.0;
      corners = task.corners.data();
      for (const Piece& piece : task.pieces) {
        const Sides sides = sides_of({corners, piece.corners}, normal, offset);
        low += sides.behind ? 1.0 : 0.0;
        high += sides.front ? 1.0 : 0.0;
        corners += piece.corners;
      }
      if (low * low + high * high >= best) continue;
      best = low * low + high * high;
      node.normal = normal;
      node.offset = offset;
    }
    if (best > 0.85 * all * all)
      behind.bad = front.bad = task.bad + 1;  // enough: a tenth on one side, or three on both
    if (node.normal == glm::dvec3(0.0) || behind.bad > most_bad) return false;
    corners = task.corners.data();
    for (const Piece& piece : task.pieces) {
      const std::span<const glm::dvec3> polygon(corners, piece.corners);
      const Sides sides = sides_of(polygon, node.normal, node.offset);
      if (sides.behind) add_part(behind, piece.item, polygon, -node.normal, -node.offset);
      if (sides.front) add_part(front, piece.item, polygon, node.normal, node.offset);
      corners += piece.corners;
    }
    const std::size_t both = behind.pieces.size() + front.pieces.size(), twice = both - task.pieces.size();
    if (twice > task.room) return false;
    behind.room = (task.room - twice) * behind.pieces.size() / both;
    front.room = task.room - twice - behind.room;
    return true;
  }

  struct Sides {
    bool behind, front;
  };
  [[nodiscard]] Sides sides_of(std::span<const glm::dvec3> polygon, const glm::dvec3& normal, double offset) const {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const glm::dvec3& corner : polygon) {
      const double f = glm::dot(normal, corner) + offset;
      least = std::min(least, f);
      most = std::max(most, f);
    }
    return {least <= margin_, most >= -margin_};
  }

  /// What of a polygon lies before the plane or not farther than the margin behind it (Sutherland and Hodgman 1974).
  void add_part(Task& task, std::uint32_t item, std::span<const glm::dvec3> polygon, const glm::dvec3& normal,
                double offset) const {
    const auto height = [&](const glm::dvec3& p) { return glm::dot(normal, p) + offset + margin_; };
    const std::size_t before = task.corners.size();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double ha = height(a), hb = height(b);
      if (ha >= 0.0) task.corners.push_back(a);
      if ((ha >= 0.0) != (hb >= 0.0)) task.corners.push_back(a + ha / (ha - hb) * (b - a));
    }
    task.pieces.push_back({item, static_cast<std::uint32_t>(task.corners.size() - before)});
  }

  const TriangleSoup& soup_;
  PlaneTreeConfig config_;
  double margin_ = 0.0;
  std::vector<glm::dvec3> centres_;
  PlaneTree tree_;
};

/// A passage of the ray; times in double, as the planes are.
struct Step {
  double enter, leave;
  std::uint32_t node;
};

template <bool any>
RayHit walk(const PlaneTree& tree, const TriangleSoup& soup, const TraceRay& ray, TraceCounters& counters) {
  RayHit best{ray.t_far, no_triangle};
  const glm::dvec3 origin(ray.origin), direction(ray.direction);
  const double slack = 2.0 * static_cast<double>(tree.space.slack);
  Step now{static_cast<double>(ray.t_near), static_cast<double>(ray.t_far), 0};
  Mailbox mailbox;
  Step stack[most_depth];
  std::size_t top = 0;
  for (;;) {
    const PlaneNode& node = tree.nodes[now.node];
    ++counters.nodes;
    if (node.count == 0) {
      const double height = glm::dot(node.normal, origin) + node.offset, climb = glm::dot(node.normal, direction);
      const std::uint32_t first = node.first + (climb < 0.0 ? 1u : 0u), second = node.first + (climb < 0.0 ? 0u : 1u);
      // The interval in which the ray is within the slack of the plane; all or nothing for one along it.
      double from = (height < 0.0 ? 1.0 : -1.0) * std::numeric_limits<double>::infinity(), to = from;
      if (climb != 0.0) {
        const double t = -height / climb, width = slack / std::abs(climb);
        from = t - width;
        to = t + width;
      } else if (std::abs(height) <= slack) {
        from = -std::numeric_limits<double>::infinity();
        to = -from;
      }
      const bool near = now.enter <= to, far = now.leave >= from;
      if (near && far) {
        stack[top++] = {std::max(now.enter, from), now.leave, second};
        now = {now.enter, std::min(now.leave, to), first};
      } else {
        now.node = near ? first : second;
      }
      continue;
    }
    const std::span<const std::uint32_t> items = std::span(tree.items).subspan(node.first, node.count);
    if (test_items<any>(items, soup, ray, mailbox, counters, best) && any) return best;
    do {
      if (top == 0) return best;
      now = stack[--top];
    } while (now.enter > static_cast<double>(best.t));
  }
}

template <bool any>
RayHit trace(const PlaneTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (tree.nodes.empty() || !prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, walk<any>(tree, soup, prepared, counters));
}

template <class Keep, class Take>
std::vector<std::uint32_t> query(const PlaneTree& tree, const TriangleSoup& soup, Keep&& keep, Take&& take) {
  std::vector<std::uint32_t> found, stack;
  if (!tree.nodes.empty()) stack.push_back(0);
  while (!stack.empty()) {
    const PlaneNode& node = tree.nodes[stack.back()];
    stack.pop_back();
    if (!keep(node.bounds)) continue;
    if (node.count == 0) {
      stack.push_back(node.first);
      stack.push_back(node.first + 1);
    } else {
      found.insert(found.end(), tree.items.begin() + node.first, tree.items.begin() + node.first + node.count);
    }
  }
  return unique_places(std::move(found), soup, take);
}

}  // namespace

PlaneTree build_plane_tree(const TriangleSoup& soup, const PlaneTreeConfig& config) {
  return Builder(soup, config).build();
}

RayHit trace_nearest(const PlaneTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<false>(tree, soup, ray, counters);
}

bool trace_any(const PlaneTree& tree, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<true>(tree, soup, ray, counters).found();
}

std::vector<std::uint32_t> box_query(const PlaneTree& tree, const TriangleSoup& soup, const Aabb& box) {
  return query(
      tree, soup, [&](const Aabb& b) { return b.overlaps(box); },
      [&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
}

std::vector<std::uint32_t> frustum_query(const PlaneTree& tree, const TriangleSoup& soup, const Frustum& frustum) {
  return query(
      tree, soup, [&](const Aabb& b) { return classify(frustum, b) != Containment::outside; },
      [&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
}

}  // namespace sightline
