// Bounding volume hierarchy with eight children per node, whose bounds are vectors (Wald, Benthin and Boulos 2008): the
// fast one. 224 bytes a node, 40 bytes a triangle, which is stored in the leaves. Promise: the hits of brute force, bit
// by bit, on every SIMD target. Checklist 13.14.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/bvh.hpp"
#include "sightline/index/large_pages.hpp"
#include "sightline/index/trace.hpp"

namespace sightline {

/// Child i is ref[i]: a node by its number, or with the highest bit set a leaf, whose triangles - 1 stand in bits 28 to
/// 30 and the first of them below. lo and hi bound child i on each axis, from the lower corner of the tree's space on,
/// and hold the slack that rays need; of a child that is not there they are infinity and -infinity, which no ray passes
/// between.
struct alignas(32) Bvh8Node {
  float lo[3][8], hi[3][8];
  std::uint32_t ref[8];
  [[nodiscard]] bool has(int i) const { return lo[0][i] <= hi[0][i]; }
};
static_assert(sizeof(Bvh8Node) == 224);

inline constexpr std::uint32_t bvh8_leaf = 0x80000000u;
struct Bvh8Leaf {
  std::uint32_t first, count;
};
inline Bvh8Leaf leaf_of(std::uint32_t ref) { return {ref & 0x0FFFFFFFu, ((ref >> 28) & 7u) + 1u}; }

inline constexpr std::uint32_t bvh8_leaf_limit = 8;           // triangles in a leaf
inline constexpr std::uint32_t bvh8_words_per_triangle = 10;  // place and nine coordinates

struct Bvh8 {
  TraceSpace space;
  PagedVector<Bvh8Node> nodes;  // nodes[0] is the root; empty if there is nothing to hit
  /// 32-bit words. A leaf of k triangles from triangle f on is the k places in the soup at word 10 f, then k ax, k ay,
  /// k az, k bx and so on: loaded as vectors without padding between leaves.
  PagedVector<std::uint32_t> triangles;
  std::uint32_t triangle_count = 0;
  int depth = 0;

  [[nodiscard]] std::size_t bytes() const { return nodes.size() * sizeof(Bvh8Node) + triangles.size() * 4; }
};

/// Widens a binary hierarchy over the triangles of a soup (items are places, leaves of at most bvh8_leaf_limit) by
/// cost: what is cheapest by surface area (Ylitie, Karras and Laine 2017). Throws std::length_error above 2^28
/// triangles.
Bvh8 widen(const Bvh& bvh, const TriangleSoup& soup);

/// Surface area heuristic, then widened: what is wanted mostly.
Bvh8 build_bvh8(const TriangleSoup& soup);

/// The nearest triangle, or nothing for what is no ray.
RayHit trace_nearest(const Bvh8& tree, const Ray& ray);
RayHit trace_nearest(const Bvh8& tree, const Ray& ray, TraceCounters& counters);
/// True if any triangle is met within the interval of the ray.
bool trace_any(const Bvh8& tree, const Ray& ray);
bool trace_any(const Bvh8& tree, const Ray& ray, TraceCounters& counters);
/// The same without SIMD: the reference.
RayHit trace_nearest_scalar(const Bvh8& tree, const Ray& ray, TraceCounters& counters);

/// Tests the triangles of these leaves (as TraceCounters::tested names them) and nothing else.
RayHit test_leaves(const Bvh8& tree, const Ray& ray, std::span<const std::uint32_t> leaves);

/// True if no triangle lies between a and b.
inline bool segment_visible(const Bvh8& tree, const glm::vec3& a, const glm::vec3& b,
                            float clearance = default_clearance) {
  return !trace_any(tree, segment_ray(a, b, clearance));
}

struct Segment {
  glm::vec3 a, b;
};
/// visible[i] = 1 if no triangle lies between the ends of segment i, else 0: the answers of segment_visible, for many
/// at once, in any order. Many are under way at a time, and those between the same places are tried first against what
/// hid the last of them. On all threads; the same for any number.
void segments_visible(const Bvh8& tree, std::span<const Segment> segments, std::span<std::uint8_t> visible,
                      float clearance = default_clearance);

/// Places of the triangles that touch the box / the frustum; ascending.
std::vector<std::uint32_t> box_query(const Bvh8& tree, const Aabb& box);
std::vector<std::uint32_t> frustum_query(const Bvh8& tree, const Frustum& frustum);

}  // namespace sightline
