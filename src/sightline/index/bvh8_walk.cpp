// Rays down the wide hierarchy, once per SIMD target (Highway). Boxes and a first look at triangles are vectors; what
// passes goes to try_triangle, which decides, so that every target gives the same hits.
#include <bit>
#include <vector>

#include "sightline/index/bvh8.hpp"
#include "sightline/index/coherent_order.hpp"
#include "sightline/parallel/parallel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/index/bvh8_walk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, 8>;
using Vec = hn::Vec<Float>;
constexpr std::size_t lanes = hn::MaxLanes(Float());

struct Entry {
  float enter;
  std::uint32_t ref;  // node, or leaf: bit 31, triangles - 1 in bits 28-30, first triangle below
};

constexpr std::uint32_t leaf_bit = 0x80000000u;
constexpr std::size_t room = 512;  // entries of the stack that need no allocation: depth 73

HWY_INLINE std::uint32_t bits_of(hn::Mask<Float> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Float(), mask, bytes);
  return bytes[0];
}

/// The ray as the boxes see it.
struct BoxRay {
  float origin[4], inverse[4], slack[4];
  int near_side[3];  // 0: lo is the near side
};

HWY_INLINE BoxRay box_ray(const TraceRay& ray) {
  BoxRay r{};
  for (int axis = 0; axis < 3; ++axis) {
    r.origin[axis] = ray.origin[axis];
    r.inverse[axis] = ray.inverse[axis];
    // Bounds in eight bits take two roundings more than those of the triangle's own box.
    r.slack[axis] = 2.0f * ray.slack[axis];
    r.near_side[axis] = ray.inverse[axis] >= 0.0f ? 0 : 1;
  }
  return r;
}

HWY_INLINE Vec bytes_to_floats(const std::uint8_t* bytes) {
  const hn::Rebind<std::uint8_t, Float> d8;
  const hn::RebindToSigned<Float> d32;
  return hn::ConvertTo(Float(), hn::PromoteTo(d32, hn::LoadU(d8, bytes)));
}

/// Bit i: the ray passes child i between t_near and t_far; enter[i] is where from.
HWY_INLINE std::uint32_t pass_children(const Bvh8Node& node, const BoxRay& ray, float t_near, float t_far,
                                       float* HWY_RESTRICT enter) {
  const Float d;
  float step[3], near_base[3], far_base[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float base = (node.origin[axis] - ray.origin[axis]) * ray.inverse[axis];
    step[axis] = std::bit_cast<float>(static_cast<std::uint32_t>(node.exponent[axis]) << 23) * ray.inverse[axis];
    near_base[axis] = base - ray.slack[axis];
    far_base[axis] = base + ray.slack[axis];
  }
  const std::uint8_t* sides[2] = {&node.lo[0][0], &node.hi[0][0]};
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < 8; i += lanes) {
    Vec from = hn::Set(d, t_near), to = hn::Set(d, t_far);
    for (int axis = 0; axis < 3; ++axis) {
      const int near = ray.near_side[axis];
      const Vec s = hn::Set(d, step[axis]);
      from = hn::Max(hn::MulAdd(bytes_to_floats(sides[near] + 8 * axis + i), s, hn::Set(d, near_base[axis])), from);
      to = hn::Min(hn::MulAdd(bytes_to_floats(sides[1 - near] + 8 * axis + i), s, hn::Set(d, far_base[axis])), to);
    }
    hn::StoreU(from, d, enter + i);
    mask |= bits_of(hn::Le(from, to)) << i;
  }
  return mask & ((1u << node.count()) - 1u);
}

/// Lanes of a leaf's triangles that try_triangle may accept: sheared as it does, edge functions in float with a bound
/// on their rounding.
HWY_INLINE std::uint32_t candidates(const float* coordinates, std::size_t k, std::size_t i, const Shear& s,
                                    float t_near, float t_far) {
  const Float d;
  const Vec ox = hn::Set(d, s.origin[s.x]), oy = hn::Set(d, s.origin[s.y]), oz = hn::Set(d, s.origin[s.z]);
  const Vec sx = hn::Set(d, s.shear_x), sy = hn::Set(d, s.shear_y);
  const auto load = [&](int corner, int axis) HWY_ATTR {
    return hn::LoadU(d, coordinates + static_cast<std::size_t>(3 * corner + axis) * k + i);
  };
  const Vec az = hn::Sub(load(0, s.z), oz), bz = hn::Sub(load(1, s.z), oz), cz = hn::Sub(load(2, s.z), oz);
  const Vec ax = hn::Sub(hn::Sub(load(0, s.x), ox), hn::Mul(sx, az)),
            ay = hn::Sub(hn::Sub(load(0, s.y), oy), hn::Mul(sy, az));
  const Vec bx = hn::Sub(hn::Sub(load(1, s.x), ox), hn::Mul(sx, bz)),
            by = hn::Sub(hn::Sub(load(1, s.y), oy), hn::Mul(sy, bz));
  const Vec cx = hn::Sub(hn::Sub(load(2, s.x), ox), hn::Mul(sx, cz)),
            cy = hn::Sub(hn::Sub(load(2, s.y), oy), hn::Mul(sy, cz));
  const Vec u = hn::MulSub(cx, by, hn::Mul(cy, bx));
  const Vec v = hn::MulSub(ax, cy, hn::Mul(ay, cx));
  const Vec w = hn::MulSub(bx, ay, hn::Mul(by, ax));
  const Vec size = hn::Max(hn::Max(hn::Max(hn::Abs(ax), hn::Abs(ay)), hn::Max(hn::Abs(bx), hn::Abs(by))),
                           hn::Max(hn::Abs(cx), hn::Abs(cy)));
  const Vec bound = hn::Mul(hn::Mul(size, size), hn::Set(d, 0x1p-21f));
  const auto not_negative = hn::Ge(hn::Min(u, hn::Min(v, w)), hn::Neg(bound));
  const auto not_positive = hn::Le(hn::Max(u, hn::Max(v, w)), bound);
  // t lies between those of the corners, up to rounding.
  const Vec scale = hn::Set(d, s.scale_z);
  const Vec ta = hn::Mul(az, scale), tb = hn::Mul(bz, scale), tc = hn::Mul(cz, scale);
  const Vec first = hn::Min(ta, hn::Min(tb, tc)), last = hn::Max(ta, hn::Max(tb, tc));
  const auto not_behind = hn::Ge(hn::Mul(last, hn::Set(d, 1.0f + 0x1p-20f)), hn::Set(d, t_near));
  const auto not_beyond = hn::Le(hn::Mul(first, hn::Set(d, 1.0f - 0x1p-20f)), hn::Set(d, t_far));
  return bits_of(hn::And(hn::Or(not_negative, not_positive), hn::And(not_behind, not_beyond)));
}

/// True if a triangle of the leaf became the best hit.
HWY_INLINE bool try_leaf(const Bvh8& tree, std::uint32_t ref, const TraceRay& ray, RayHit& best) {
  const std::size_t k = ((ref >> 28) & 7u) + 1u;
  const std::uint32_t* words = tree.triangles.data() + std::size_t{ref & 0x0FFFFFFFu} * bvh8_words_per_triangle;
  const float* coordinates = reinterpret_cast<const float*>(words + k);
  bool found = false;
  for (std::size_t i = 0; i < k; i += lanes) {
    const std::uint32_t in_leaf = k - i >= 32 ? ~0u : (1u << (k - i)) - 1u;
    for (std::uint32_t mask = candidates(coordinates, k, i, ray.shear, ray.t_near, best.t) & in_leaf; mask != 0;
         mask &= mask - 1) {
      const std::size_t lane = i + static_cast<std::size_t>(std::countr_zero(mask));
      float corner[9];
      for (std::size_t j = 0; j < 9; ++j) corner[j] = coordinates[j * k + lane];
      found |= try_triangle(ray, corner, corner + 3, corner + 6, words[lane], best);
    }
  }
  return found;
}

HWY_INLINE std::uint32_t reference(const Bvh8Node& node, std::uint32_t child) {
  const auto inner = static_cast<std::uint32_t>(node.inner());
  if (child < inner) return node.first_child + child;
  const std::uint32_t begin = child == inner ? 0u : node.ends[child - 1];
  return leaf_bit | ((node.ends[child] - begin - 1u) << 28) | (node.first_triangle + begin);
}

/// The nearest hit; or any one, and then `occluder` is the leaf that has it.
template <bool any>
HWY_INLINE RayHit walk(const Bvh8& tree, const TraceRay& ray, TraceCounters* counters, std::uint32_t& occluder) {
  Entry local[room];
  std::vector<Entry> large;
  Entry* stack = local;
  if (static_cast<std::size_t>(tree.depth) * 7 + 8 > room) {
    large.resize(static_cast<std::size_t>(tree.depth) * 7 + 8);
    stack = large.data();
  }
  const BoxRay boxes = box_ray(ray);
  RayHit best{ray.t_far, no_triangle};
  std::size_t top = 0;
  std::uint32_t ref = 0;
  std::uint64_t nodes = 0, tests = 0;
  for (;;) {
    if ((ref & leaf_bit) == 0) {
      const Bvh8Node& node = tree.nodes[ref];
      HWY_ALIGN float enter[8];
      std::uint32_t mask = pass_children(node, boxes, ray.t_near, best.t, enter);
      ++nodes;
      if (mask != 0) {
        const auto first = static_cast<std::uint32_t>(std::countr_zero(mask));
        mask &= mask - 1;
        if (mask == 0) {
          ref = reference(node, first);
          continue;
        }
        const std::size_t base = top;
        stack[top++] = {enter[first], reference(node, first)};
        for (; mask != 0; mask &= mask - 1) {
          const auto child = static_cast<std::uint32_t>(std::countr_zero(mask));
          const Entry entry{enter[child], reference(node, child)};
          std::size_t at = top++;
          // Any hit needs no order; leaves, which come last in a node, are then tested first.
          if (!any)
            for (; at > base && stack[at - 1].enter < entry.enter; --at) stack[at] = stack[at - 1];
          stack[at] = entry;
        }
        ref = stack[--top].ref;
        continue;
      }
    } else {
      tests += ((ref >> 28) & 7u) + 1u;
      if (counters != nullptr && counters->tested != nullptr) counters->tested->push_back(ref);
      if (try_leaf(tree, ref, ray, best) && any) {
        occluder = ref;
        break;
      }
    }
    do {
      if (top == 0) goto done;
      --top;
    } while (stack[top].enter > best.t);
    ref = stack[top].ref;
  }
done:
  if (counters != nullptr) {
    counters->nodes += nodes;
    counters->tests += tests;
  }
  return best;
}

RayHit retest(const Bvh8& tree, const TraceRay& ray, std::span<const std::uint32_t> leaves) {
  RayHit best{ray.t_far, no_triangle};
  for (const std::uint32_t leaf : leaves) (void)try_leaf(tree, leaf, ray, best);
  return best;
}

RayHit walk_nearest(const Bvh8& tree, const TraceRay& ray, TraceCounters* counters) {
  std::uint32_t unused = 0;
  return walk<false>(tree, ray, counters, unused);
}
RayHit walk_any(const Bvh8& tree, const TraceRay& ray, TraceCounters* counters) {
  std::uint32_t unused = 0;
  return walk<true>(tree, ray, counters, unused);
}

/// Segments order[0 .. count), neighbours alike, one after the other.
void walk_segments(const Bvh8& tree, const Segment* segments, const std::uint32_t* order, std::size_t count,
                   float clearance, std::uint8_t* visible) {
  constexpr std::size_t remembered = 4;
  std::uint32_t occluders[remembered] = {};
  std::size_t known = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Segment& s = segments[order[i]];
    TraceRay ray;
    std::uint8_t& answer = visible[order[i]];
    answer = 1;
    if (!prepare(segment_ray(s.a, s.b, clearance), tree.space, ray)) continue;
    RayHit best{ray.t_far, no_triangle};
    for (std::size_t k = 0; k < known && answer != 0; ++k) {
      if (!try_leaf(tree, occluders[k], ray, best)) continue;
      answer = 0;
      std::swap(occluders[k], occluders[k / 2]);
    }
    if (answer == 0) continue;
    std::uint32_t occluder = 0;
    if (!walk<true>(tree, ray, nullptr, occluder).found()) continue;
    answer = 0;
    for (std::size_t k = known < remembered ? known++ : remembered - 1; k > 0; --k) occluders[k] = occluders[k - 1];
    occluders[0] = occluder;
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(walk_nearest);
HWY_EXPORT(walk_any);
HWY_EXPORT(retest);
HWY_EXPORT(walk_segments);

void segments_visible(const Bvh8& tree, std::span<const Segment> segments, std::span<std::uint8_t> visible,
                      float clearance) {
  const std::vector<std::uint32_t> order = coherent_order(tree.space.bounds, segments);
  constexpr std::size_t block = 16384;
  parallel_blocks(segments.size(), block, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(walk_segments)
    (tree, segments.data(), order.data() + begin, end - begin, clearance, visible.data());
  });
}

RayHit test_leaves(const Bvh8& tree, const Ray& ray, std::span<const std::uint32_t> leaves) {
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, HWY_DYNAMIC_DISPATCH(retest)(tree, prepared, leaves));
}

RayHit trace_nearest(const Bvh8& tree, const Ray& ray) {
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, HWY_DYNAMIC_DISPATCH(walk_nearest)(tree, prepared, nullptr));
}

RayHit trace_nearest(const Bvh8& tree, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, HWY_DYNAMIC_DISPATCH(walk_nearest)(tree, prepared, &counters));
}

bool trace_any(const Bvh8& tree, const Ray& ray) {
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return false;
  return HWY_DYNAMIC_DISPATCH(walk_any)(tree, prepared, nullptr).found();
}

bool trace_any(const Bvh8& tree, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return false;
  return HWY_DYNAMIC_DISPATCH(walk_any)(tree, prepared, &counters).found();
}

}  // namespace sightline
#endif
