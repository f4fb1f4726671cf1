// Rays down the binary hierarchy of bvh.hpp over a soup's triangles: the readable walk. Promise: the hits of brute
// force. Checklist 13.13, 13.14.
#pragma once

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/bvh.hpp"
#include "sightline/index/trace.hpp"

namespace sightline {

/// `space` is that of the soup; items of the hierarchy are places in it.
RayHit trace_nearest(const Bvh& bvh, const TriangleSoup& soup, const TraceSpace& space, const Ray& ray,
                     TraceCounters& counters);
bool trace_any(const Bvh& bvh, const TriangleSoup& soup, const TraceSpace& space, const Ray& ray,
               TraceCounters& counters);

/// Places of the triangles that touch the box / the frustum; ascending.
std::vector<std::uint32_t> box_query(const Bvh& bvh, const TriangleSoup& soup, const Aabb& box);
std::vector<std::uint32_t> frustum_query(const Bvh& bvh, const TriangleSoup& soup, const Frustum& frustum);

}  // namespace sightline
