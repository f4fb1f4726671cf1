#include "sightline/index/tracer.hpp"

#include <array>

#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/index/axis_tree.hpp"
#include "sightline/index/bvh8.hpp"
#include "sightline/index/bvh_builders.hpp"
#include "sightline/index/bvh_trace.hpp"
#include "sightline/index/grid.hpp"
#include "sightline/index/kdtree.hpp"
#include "sightline/index/plane_tree.hpp"

namespace sightline {
namespace {

RayHit retest_places(const TriangleSoup& soup, const TraceSpace& space, const Ray& ray,
                     std::span<const std::uint32_t> tested) {
  TraceRay prepared;
  if (!prepare(ray, space, prepared)) return {};
  RayHit best{prepared.t_far, no_triangle};
  for (const std::uint32_t place : tested) (void)try_triangle(prepared, soup, place, best);
  return finish(prepared, best);
}

class Bvh8Tracer final : public Tracer {
 public:
  explicit Bvh8Tracer(Bvh8 tree) : tree_(std::move(tree)) {}
  RayHit nearest(const Ray& ray, TraceCounters& counters) const override { return trace_nearest(tree_, ray, counters); }
  bool any(const Ray& ray, TraceCounters& counters) const override { return trace_any(tree_, ray, counters); }
  std::vector<std::uint32_t> in_box(const Aabb& box) const override { return box_query(tree_, box); }
  std::vector<std::uint32_t> in_frustum(const Frustum& frustum) const override { return frustum_query(tree_, frustum); }
  std::size_t bytes() const override { return tree_.bytes(); }
  RayHit retest(const Ray& ray, std::span<const std::uint32_t> tested) const override {
    return test_leaves(tree_, ray, tested);
  }

 private:
  Bvh8 tree_;
};

class BvhTracer final : public Tracer {
 public:
  BvhTracer(const TriangleSoup& soup, Bvh tree)
      : soup_(soup), tree_(std::move(tree)), space_(trace_space(bounds_of(soup))) {}
  RayHit nearest(const Ray& ray, TraceCounters& counters) const override {
    return trace_nearest(tree_, soup_, space_, ray, counters);
  }
  bool any(const Ray& ray, TraceCounters& counters) const override {
    return trace_any(tree_, soup_, space_, ray, counters);
  }
  std::vector<std::uint32_t> in_box(const Aabb& box) const override { return box_query(tree_, soup_, box); }
  std::vector<std::uint32_t> in_frustum(const Frustum& frustum) const override {
    return frustum_query(tree_, soup_, frustum);
  }
  std::size_t bytes() const override { return tree_.nodes.size() * sizeof(BvhNode) + tree_.items.size() * 4; }
  RayHit retest(const Ray& ray, std::span<const std::uint32_t> tested) const override {
    return retest_places(soup_, space_, ray, tested);
  }

 private:
  const TriangleSoup& soup_;
  Bvh tree_;
  TraceSpace space_;
};

/// A structure whose free functions take (structure, soup, ...).
template <class Structure>
class CellTracer final : public Tracer {
 public:
  CellTracer(const TriangleSoup& soup, Structure structure) : soup_(soup), structure_(std::move(structure)) {}
  RayHit nearest(const Ray& ray, TraceCounters& counters) const override {
    return trace_nearest(structure_, soup_, ray, counters);
  }
  bool any(const Ray& ray, TraceCounters& counters) const override {
    return trace_any(structure_, soup_, ray, counters);
  }
  std::vector<std::uint32_t> in_box(const Aabb& box) const override { return box_query(structure_, soup_, box); }
  std::vector<std::uint32_t> in_frustum(const Frustum& frustum) const override {
    return frustum_query(structure_, soup_, frustum);
  }
  std::size_t bytes() const override { return structure_.bytes(); }
  RayHit retest(const Ray& ray, std::span<const std::uint32_t> tested) const override {
    return retest_places(soup_, structure_.space, ray, tested);
  }

 private:
  const TriangleSoup& soup_;
  Structure structure_;
};

class BruteTracer final : public Tracer {
 public:
  explicit BruteTracer(const TriangleSoup& soup) : soup_(soup), space_(trace_space(bounds_of(soup))) {}
  RayHit nearest(const Ray& ray, TraceCounters& counters) const override {
    if (counters.tested != nullptr)
      for (std::uint32_t i = 0; i < soup_.size(); ++i) counters.tested->push_back(i);
    return trace_brute(soup_, space_, ray, counters);
  }
  bool any(const Ray& ray, TraceCounters& counters) const override { return nearest(ray, counters).found(); }
  std::vector<std::uint32_t> in_box(const Aabb& box) const override {
    return filter([&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
  }
  std::vector<std::uint32_t> in_frustum(const Frustum& frustum) const override {
    return filter([&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
  }
  std::size_t bytes() const override { return 0; }
  RayHit retest(const Ray& ray, std::span<const std::uint32_t> tested) const override {
    return retest_places(soup_, space_, ray, tested);
  }

 private:
  template <class Take>
  std::vector<std::uint32_t> filter(Take&& take) const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < soup_.size(); ++i)
      if (take(soup_.triangle(i))) found.push_back(i);
    return found;
  }
  const TriangleSoup& soup_;
  TraceSpace space_;
};

using Made = std::unique_ptr<Tracer>;
constexpr BvhConfig wide_leaves{.max_leaf_size = static_cast<int>(bvh8_leaf_limit)};

Made make_bvh8(const TriangleSoup& soup) { return std::make_unique<Bvh8Tracer>(build_bvh8(soup)); }
Made make_bvh8_linear(const TriangleSoup& soup) {
  return std::make_unique<Bvh8Tracer>(widen(build_bvh_linear(bounds_of_triangles(soup), wide_leaves), soup));
}
template <Bvh (*build)(std::span<const Aabb>, const BvhConfig&)>
Made make_bvh(const TriangleSoup& soup) {
  return std::make_unique<BvhTracer>(soup, build(bounds_of_triangles(soup), {.grouped = false}));
}
Made make_grid(const TriangleSoup& soup) { return std::make_unique<CellTracer<Grid>>(soup, build_grid(soup)); }
Made make_octree(const TriangleSoup& soup) { return std::make_unique<CellTracer<AxisTree>>(soup, build_octree(soup)); }
Made make_quadtree(const TriangleSoup& soup) {
  return std::make_unique<CellTracer<AxisTree>>(soup, build_quadtree(soup));
}
Made make_kd_halving(const TriangleSoup& soup) {
  return std::make_unique<CellTracer<AxisTree>>(
      soup, build_axis_tree(soup, {.axes = 7, .alternating = true, .cube = false, .leaf_size = 4}));
}
Made make_kd_median(const TriangleSoup& soup) {
  return std::make_unique<CellTracer<KdTree>>(soup, build_kdtree(soup, {.split = KdSplit::median}));
}
Made make_kdtree(const TriangleSoup& soup) { return std::make_unique<CellTracer<KdTree>>(soup, build_kdtree(soup)); }
Made make_bsp(const TriangleSoup& soup) {
  return std::make_unique<CellTracer<PlaneTree>>(soup, build_plane_tree(soup));
}
Made make_brute(const TriangleSoup& soup) { return std::make_unique<BruteTracer>(soup); }

constexpr std::array kinds{
    TracerKind{"bvh8", "eight children, tested as vectors; surface area heuristic", make_bvh8},
    TracerKind{"bvh8_linear", "the same over a tree along a Morton curve", make_bvh8_linear},
    TracerKind{"bvh", "binary hierarchy, surface area heuristic", make_bvh<build_bvh>},
    TracerKind{"bvh_linear", "binary hierarchy along a Morton curve", make_bvh<build_bvh_linear>},
    TracerKind{"bvh_median", "binary hierarchy, median of the centroids", make_bvh<build_bvh_median>},
    TracerKind{"bvh_extent", "binary hierarchy, middle of the longest side", make_bvh<build_bvh_extent>},
    TracerKind{"kdtree", "one plane per node, surface area heuristic", make_kdtree},
    TracerKind{"kdtree_median", "one plane per node, median of the centroids", make_kd_median},
    TracerKind{"kdtree_halving", "one axis halved per node", make_kd_halving},
    TracerKind{"octree", "three axes halved per node", make_octree},
    TracerKind{"quadtree", "two axes halved per node", make_quadtree},
    TracerKind{"grid", "uniform voxels, walked cell by cell", make_grid},
    TracerKind{"bsp_pca", "one plane per node, across the principal axis", make_bsp},
    TracerKind{"brute", "every triangle for every ray", make_brute},
};

}  // namespace

std::span<const TracerKind> tracer_kinds() { return kinds; }

const TracerKind* find_tracer(std::string_view name) {
  for (const TracerKind& kind : kinds)
    if (kind.name == name) return &kind;
  return nullptr;
}

}  // namespace sightline
