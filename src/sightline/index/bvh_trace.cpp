#include "sightline/index/bvh_trace.hpp"

#include "sightline/geometry/triangle_overlap.hpp"

namespace sightline {
namespace {

struct Entry {
  float enter;
  std::uint32_t node;
};

template <bool any>
RayHit walk(const Bvh& bvh, const TriangleSoup& soup, const TraceRay& ray, TraceCounters& counters) {
  RayHit best{ray.t_far, no_triangle};
  float enter = 0.0f, leave = 0.0f;
  pass_box(ray, bvh.nodes[0].bounds.lo, bvh.nodes[0].bounds.hi, enter, leave);
  if (!(enter <= leave)) return best;
  thread_local std::vector<Entry> stack;
  stack.assign(1, {enter, 0});
  while (!stack.empty()) {
    const Entry entry = stack.back();
    stack.pop_back();
    if (entry.enter > best.t) continue;
    const BvhNode& node = bvh.nodes[entry.node];
    ++counters.nodes;
    if (node.leaf()) {
      counters.tests += node.count;
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (counters.tested != nullptr) counters.tested->push_back(bvh.items[i]);
        if (try_triangle(ray, soup, bvh.items[i], best) && any) return best;
      }
      continue;
    }
    Entry children[2];
    int count = 0;
    for (std::uint32_t child = node.first; child < node.first + 2; ++child) {
      const Aabb& box = bvh.nodes[child].bounds;
      if (box.empty()) continue;
      pass_box(ray, box.lo, box.hi, enter, leave);
      if (enter <= std::min(leave, best.t)) children[count++] = {enter, child};
    }
    if (count == 2 && children[0].enter < children[1].enter) std::swap(children[0], children[1]);
    for (int i = 0; i < count; ++i) stack.push_back(children[i]);
  }
  return best;
}

template <bool any>
RayHit trace(const Bvh& bvh, const TriangleSoup& soup, const TraceSpace& space, const Ray& ray,
             TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (bvh.nodes.empty() || !prepare(ray, space, prepared)) return {};
  return finish(prepared, walk<any>(bvh, soup, prepared, counters));
}

template <class Keep, class Take>
std::vector<std::uint32_t> query(const Bvh& bvh, const TriangleSoup& soup, Keep&& keep, Take&& take) {
  std::vector<std::uint32_t> found, stack;
  if (!bvh.nodes.empty()) stack.push_back(0);
  while (!stack.empty()) {
    const BvhNode& node = bvh.nodes[stack.back()];
    stack.pop_back();
    if (!keep(node.bounds)) continue;
    if (!node.leaf()) {
      stack.push_back(node.first);
      stack.push_back(node.first + 1);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (take(soup.triangle(bvh.items[i]))) found.push_back(bvh.items[i]);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

RayHit trace_nearest(const Bvh& bvh, const TriangleSoup& soup, const TraceSpace& space, const Ray& ray,
                     TraceCounters& counters) {
  return trace<false>(bvh, soup, space, ray, counters);
}

bool trace_any(const Bvh& bvh, const TriangleSoup& soup, const TraceSpace& space, const Ray& ray,
               TraceCounters& counters) {
  return trace<true>(bvh, soup, space, ray, counters).found();
}

std::vector<std::uint32_t> box_query(const Bvh& bvh, const TriangleSoup& soup, const Aabb& box) {
  return query(
      bvh, soup, [&](const Aabb& b) { return b.overlaps(box); },
      [&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
}

std::vector<std::uint32_t> frustum_query(const Bvh& bvh, const TriangleSoup& soup, const Frustum& frustum) {
  return query(
      bvh, soup, [&](const Aabb& b) { return !b.empty() && classify(frustum, b) != Containment::outside; },
      [&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
}

}  // namespace sightline
