// What the walks of the wide hierarchy share, lane by lane: a first look at triangles by vectors, before try_triangle
// decides, and the stack. Included by SIMD sources, once per target.

#if defined(SIGHTLINE_INDEX_BVH8_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_INDEX_BVH8_LANES_INL
#undef SIGHTLINE_INDEX_BVH8_LANES_INL
#else
#define SIGHTLINE_INDEX_BVH8_LANES_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/index/bvh8.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, 8>;
using Vec = hn::Vec<Float>;
constexpr std::size_t lanes = hn::MaxLanes(Float());

constexpr int deepest = 72;  // trees up to here need no allocation
constexpr std::size_t room = 8 + 7 * deepest;

/// What waits on the stack: a reference below, and above what is known of the visit.
using Entry = std::uint64_t;

HWY_INLINE std::uint32_t bits_of(hn::Mask<Float> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Float(), mask, bytes);
  return bytes[0];
}

/// A triangle in every lane, or one in all of them: coordinates on the axes of a shear, or sheared.
struct Corners {
  Vec ax, ay, az, bx, by, bz, cx, cy, cz;
};

/// A ray in every lane, or one in all of them.
struct ShearLanes {
  Vec origin_x, origin_y, origin_z, shear_x, shear_y, scale_z, t_near, t_far;
};

/// Lanes in which try_triangle may accept the triangle, and those in which it accepts it for certain.
struct Look {
  std::uint32_t maybe, certain;
};

/// As sheared() does, bit by bit.
HWY_INLINE Corners sheared(const Corners& p, const ShearLanes& s) {
  const Vec az = hn::Sub(p.az, s.origin_z), bz = hn::Sub(p.bz, s.origin_z), cz = hn::Sub(p.cz, s.origin_z);
  const Vec ax = hn::Sub(hn::Sub(p.ax, s.origin_x), hn::Mul(s.shear_x, az)),
            ay = hn::Sub(hn::Sub(p.ay, s.origin_y), hn::Mul(s.shear_y, az));
  const Vec bx = hn::Sub(hn::Sub(p.bx, s.origin_x), hn::Mul(s.shear_x, bz)),
            by = hn::Sub(hn::Sub(p.by, s.origin_y), hn::Mul(s.shear_y, bz));
  const Vec cx = hn::Sub(hn::Sub(p.cx, s.origin_x), hn::Mul(s.shear_x, cz)),
            cy = hn::Sub(hn::Sub(p.cy, s.origin_y), hn::Mul(s.shear_y, cz));
  return {ax, ay, az, bx, by, bz, cx, cy, cz};
}

/// At sheared triangles: edge functions in float, with a bound on their rounding, also where they are denormal.
HWY_INLINE Look look_at(const Corners& p, const ShearLanes& s) {
  const Float d;
  const auto& [ax, ay, az, bx, by, bz, cx, cy, cz] = p;
  const Vec u = hn::MulSub(cx, by, hn::Mul(cy, bx));
  const Vec v = hn::MulSub(ax, cy, hn::Mul(ay, cx));
  const Vec w = hn::MulSub(bx, ay, hn::Mul(by, ax));
  const Vec size = hn::Max(hn::Max(hn::Max(hn::Abs(ax), hn::Abs(ay)), hn::Max(hn::Abs(bx), hn::Abs(by))),
                           hn::Max(hn::Abs(cx), hn::Abs(cy)));
  const Vec bound = hn::MulAdd(hn::Mul(size, size), hn::Set(d, 0x1p-21f), hn::Set(d, 0x1p-120f));
  const Vec least = hn::Min(u, hn::Min(v, w)), most = hn::Max(u, hn::Max(v, w));
  // t lies between those of the corners, up to rounding.
  const Vec ta = hn::Mul(az, s.scale_z), tb = hn::Mul(bz, s.scale_z), tc = hn::Mul(cz, s.scale_z);
  const Vec first = hn::Min(ta, hn::Min(tb, tc)), last = hn::Max(ta, hn::Max(tb, tc));
  const Vec more = hn::Set(d, 1.0f + 0x1p-20f), less = hn::Set(d, 1.0f - 0x1p-20f);
  const auto crossed = hn::Or(hn::Ge(least, hn::Neg(bound)), hn::Le(most, bound));
  const auto within = hn::And(hn::Ge(hn::Mul(last, more), s.t_near), hn::Le(hn::Mul(first, less), s.t_far));
  const auto surely_crossed = hn::Or(hn::Gt(least, bound), hn::Lt(most, hn::Neg(bound)));
  const auto surely_within = hn::And(hn::Gt(hn::Mul(first, less), s.t_near), hn::Lt(hn::Mul(last, more), s.t_far));
  return {bits_of(hn::And(crossed, within)), bits_of(hn::And(surely_crossed, surely_within))};
}

/// Leaf's triangles in memory.
struct LeafWords {
  std::size_t k;
  const std::uint32_t* places;
  const float* coordinates;  // coordinate j of triangle i is [j * k + i]
};
HWY_INLINE LeafWords words_of(const Bvh8& tree, std::uint32_t ref) {
  const auto [first, count] = leaf_of(ref);
  const std::uint32_t* places = tree.triangles.data() + std::size_t{first} * bvh8_words_per_triangle;
  return {count, places, reinterpret_cast<const float*>(places + count)};
}
HWY_INLINE bool try_triangle(const LeafWords& leaf, std::size_t i, const TraceRay& ray, RayHit& best) {
  float corner[9];
  for (std::size_t j = 0; j < 9; ++j) corner[j] = leaf.coordinates[j * leaf.k + i];
  return try_triangle(ray, corner, corner + 3, corner + 6, leaf.places[i], best);
}

/// Sheared triangles lane by lane.
struct ShearedLanes {
  HWY_ALIGN float value[9][lanes];
};
HWY_INLINE void store(const Corners& p, ShearedLanes& to) {
  const Float d;
  const Vec* from[9] = {&p.ax, &p.ay, &p.az, &p.bx, &p.by, &p.bz, &p.cx, &p.cy, &p.cz};
  for (std::size_t j = 0; j < 9; ++j) hn::Store(*from[j], d, to.value[j]);
}
/// Triangle i of the leaf, which is in this lane of those sheared.
HWY_INLINE bool try_triangle(const LeafWords& leaf, std::size_t i, const ShearedLanes& s, std::size_t lane,
                             const TraceRay& ray, RayHit& best) {
  float corner[9];
  for (std::size_t j = 0; j < 9; ++j) corner[j] = leaf.coordinates[j * leaf.k + i];
  const ShearedTriangle p{s.value[0][lane], s.value[1][lane], s.value[2][lane], s.value[3][lane], s.value[4][lane],
                          s.value[5][lane], s.value[6][lane], s.value[7][lane], s.value[8][lane]};
  return try_triangle(ray, p, corner, corner + 3, corner + 6, leaf.places[i], best);
}

HWY_INLINE std::uint32_t lowest(std::size_t bits) { return bits >= 32 ? ~0u : (1u << bits) - 1u; }

inline Entry* large_stack(int depth) {
  thread_local std::vector<Entry> stack;
  stack.resize(std::max(stack.size(), 8 + 7 * static_cast<std::size_t>(depth)));
  return stack.data();
}

/// Without branches: what a reference is, is as good as random.
HWY_INLINE void prefetch(const Bvh8& tree, std::uint32_t ref) {
  const auto leaf = reinterpret_cast<std::uintptr_t>(tree.triangles.data()) +
                    std::uintptr_t{ref & 0x0FFFFFFFu} * (4 * bvh8_words_per_triangle);
  const auto node = reinterpret_cast<std::uintptr_t>(tree.nodes.data()) + std::uintptr_t{ref} * sizeof(Bvh8Node);
  const auto which = static_cast<std::uintptr_t>(static_cast<std::int32_t>(ref) >> 31);
  const auto* at = reinterpret_cast<const char*>(node ^ ((node ^ leaf) & which));
  for (int line = 0; line < 4; ++line) hwy::Prefetch(at + 64 * line);  // a node, or six triangles
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
