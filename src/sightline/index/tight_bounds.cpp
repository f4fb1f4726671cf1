#include "sightline/index/tight_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace sightline {
namespace {

double volume(const Aabb& box) {
  if (box.empty()) return 0.0;
  const glm::dvec3 e = glm::dvec3(box.hi) - glm::dvec3(box.lo);
  return e.x * e.y * e.z;
}

/// Adds up over a grid of columns along `axis` what f makes of the intervals that the boxes cut out of the column.
/// f(intervals merged to disjoint ones) gives a number per unit of the column's area.
template <class F>
double over_columns(std::span<const Aabb> boxes, int axis, F&& f) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<float> us, vs;
  for (const Aabb& box : boxes) {
    if (box.empty()) continue;
    us.insert(us.end(), {box.lo[u], box.hi[u]});
    vs.insert(vs.end(), {box.lo[v], box.hi[v]});
  }
  for (std::vector<float>* grid : {&us, &vs}) {
    std::sort(grid->begin(), grid->end());
    grid->erase(std::unique(grid->begin(), grid->end()), grid->end());
  }
  std::vector<const Aabb*> row;
  std::vector<std::array<float, 2>> intervals;
  double total = 0.0;
  for (std::size_t i = 0; i + 1 < us.size(); ++i) {
    row.clear();
    for (const Aabb& box : boxes)
      if (!box.empty() && box.lo[u] <= us[i] && box.hi[u] >= us[i + 1]) row.push_back(&box);
    std::sort(row.begin(), row.end(), [&](const Aabb* a, const Aabb* b) { return a->lo[axis] < b->lo[axis]; });
    for (std::size_t j = 0; j + 1 < vs.size() && !row.empty(); ++j) {
      intervals.clear();
      for (const Aabb* box : row) {
        if (!(box->lo[v] <= vs[j] && box->hi[v] >= vs[j + 1])) continue;
        if (intervals.empty() || box->lo[axis] > intervals.back()[1])
          intervals.push_back({box->lo[axis], box->hi[axis]});
        else
          intervals.back()[1] = std::max(intervals.back()[1], box->hi[axis]);
      }
      total += (static_cast<double>(us[i + 1]) - us[i]) * (static_cast<double>(vs[j + 1]) - vs[j]) * f(intervals);
    }
  }
  return total;
}

/// A cluster of triangles: a range of `order`, and how it would be cut.
struct Cluster {
  std::uint32_t begin, end;
  int depth;
  Aabb box;
  std::uint32_t middle = 0;  // begin: cannot be cut
  Aabb left{}, right{};
  double saved = 0.0;
};

struct Builder {
  std::vector<Aabb> triangles;
  std::vector<std::uint32_t> order;
  int deepest;

  void sort_along(const Cluster& cluster, int axis) {
    std::sort(order.begin() + cluster.begin, order.begin() + cluster.end, [&](std::uint32_t a, std::uint32_t b) {
      const float ca = triangles[a].centre()[axis], cb = triangles[b].centre()[axis];
      return ca != cb ? ca < cb : a < b;
    });
  }

  /// Where to cut, along each axis: the least sum of half areas.
  void plan(Cluster& cluster) {
    cluster.middle = cluster.begin;
    if (cluster.end - cluster.begin < 2 || cluster.depth >= deepest) return;
    const std::uint32_t count = cluster.end - cluster.begin;
    std::vector<Aabb> from_right(count + 1);
    double best = std::numeric_limits<double>::infinity();
    int best_axis = -1;
    for (int axis = 0; axis < 3; ++axis) {
      sort_along(cluster, axis);
      for (std::uint32_t i = count; i-- > 0;) {
        from_right[i] = from_right[i + 1];
        from_right[i].extend(triangles[order[cluster.begin + i]]);
      }
      Aabb left;
      for (std::uint32_t i = 1; i < count; ++i) {
        left.extend(triangles[order[cluster.begin + i - 1]]);
        const double cost = static_cast<double>(left.half_area()) + static_cast<double>(from_right[i].half_area());
        if (cost >= best) continue;
        best = cost;
        best_axis = axis;
        cluster.middle = cluster.begin + i;
        cluster.left = left;
        cluster.right = from_right[i];
      }
    }
    sort_along(cluster, std::max(best_axis, 0));
    // Flat boxes have no volume to save, but area.
    const double area = static_cast<double>(cluster.box.half_area()) - best;
    cluster.saved = volume(cluster.box) - volume(cluster.left) - volume(cluster.right) +
                    1e-6 * static_cast<double>(glm::length(cluster.box.extent())) * std::max(0.0, area);
  }
};

}  // namespace

double union_surface(std::span<const Aabb> boxes) {
  double total = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    total +=
        over_columns(boxes, axis, [](const auto& intervals) { return 2.0 * static_cast<double>(intervals.size()); });
  return total;
}

double union_volume(std::span<const Aabb> boxes) {
  return over_columns(boxes, 0, [](const auto& intervals) {
    double length = 0.0;
    for (const auto& [lo, hi] : intervals) length += static_cast<double>(hi) - static_cast<double>(lo);
    return length;
  });
}

TightBounds tight_bounds(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                         const TightBoundsConfig& config) {
  TightBounds result;
  if (triangles.empty()) return result;
  Builder builder{{}, std::vector<std::uint32_t>(triangles.size()), config.depth};
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  Cluster whole{0, static_cast<std::uint32_t>(triangles.size()), 0, {}};
  for (const glm::uvec3& t : triangles) {
    Aabb box;
    for (int k = 0; k < 3; ++k) box.extend(positions[t[k]]);
    builder.triangles.push_back(box);
    whole.box.extend(box);
  }
  const double allowed = config.sigma * 2.0 * static_cast<double>(whole.box.half_area()) * (1.0 + 1e-6);
  builder.plan(whole);
  std::vector<Cluster> clusters{whole};
  std::vector<Aabb> boxes{whole.box};
  while (clusters.size() < static_cast<std::size_t>(config.boxes)) {
    const auto best = std::max_element(clusters.begin(), clusters.end(),
                                       [](const Cluster& a, const Cluster& b) { return a.saved < b.saved; });
    if (!(best->saved > 0.0)) break;
    const auto index = static_cast<std::size_t>(best - clusters.begin());
    const Aabb before = boxes[index];
    boxes[index] = best->left;
    boxes.push_back(best->right);
    if (union_surface(boxes) > allowed) {  // this one stays as it is; others may still be cut
      boxes[index] = before;
      boxes.pop_back();
      best->saved = 0.0;
      continue;
    }
    Cluster left{best->begin, best->middle, best->depth + 1, best->left},
        right{best->middle, best->end, best->depth + 1, best->right};
    builder.plan(left);
    builder.plan(right);
    clusters[index] = left;
    clusters.push_back(right);
  }
  result.boxes = std::move(boxes);
  result.box_of.resize(triangles.size());
  for (std::size_t c = 0; c < clusters.size(); ++c)
    for (std::uint32_t i = clusters[c].begin; i < clusters[c].end; ++i)
      result.box_of[builder.order[i]] = static_cast<std::uint32_t>(c);
  return result;
}

}  // namespace sightline
