// Rays down the wide hierarchy, once per SIMD target (Highway). Boxes and a first look at triangles are vectors; what
// passes goes to try_triangle, which decides, so that every target gives the same hits.
#include <bit>
#include <cstddef>
#include <cstring>
#include <vector>

#include "sightline/index/bvh8.hpp"
#include "sightline/index/coherent_order.hpp"
#include "sightline/parallel/parallel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/index/bvh8_walk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/cache_control.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, 8>;
using Vec = hn::Vec<Float>;
constexpr std::size_t lanes = hn::MaxLanes(Float());

constexpr int deepest = 72;  // trees up to here need no allocation
constexpr std::size_t room = 8 + 7 * deepest;

/// What waits on the stack: above, where the ray enters (bits of a float that is not negative, which order as integers
/// do), below, the reference.
using Entry = std::uint64_t;

HWY_INLINE std::uint32_t bits_of(hn::Mask<Float> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Float(), mask, bytes);
  return bytes[0];
}

HWY_INLINE Vec bytes_to_floats(const std::uint8_t* bytes) {
  const hn::Rebind<std::uint8_t, Float> d8;
  const hn::RebindToSigned<Float> d32;
  return hn::ConvertTo(Float(), hn::PromoteTo(d32, hn::LoadU(d8, bytes)));
}

#if HWY_TARGET == HWY_SCALAR
/// Three floats as three scalars.
struct Axes {
  float v[4];
};
template <int axis>
HWY_INLINE Vec along(const Axes& a) {
  return hn::Set(Float(), a.v[axis]);
}
HWY_INLINE Axes load_axes(const float* p) { return {{p[0], p[1], p[2], 0.0f}}; }
HWY_INLINE Axes gather_axes(const float* p) { return load_axes(p); }
HWY_INLINE Axes load_exponents(const Bvh8Node& node) {
  Axes a{};
  for (int axis = 0; axis < 3; ++axis)
    a.v[axis] = std::bit_cast<float>(static_cast<std::uint32_t>(node.exponent[axis]) << 23);
  return a;
}
template <class F>
HWY_INLINE Axes each_axis(F&& f) {
  return {{f(0), f(1), f(2), 0.0f}};
}
HWY_INLINE Axes operator*(const Axes& a, const Axes& b) {
  return each_axis([&](int i) { return a.v[i] * b.v[i]; });
}
HWY_INLINE Axes multiply_add(const Axes& a, const Axes& b, const Axes& c) {
  return each_axis([&](int i) { return a.v[i] * b.v[i] + c.v[i]; });
}
#else
/// Three floats, and a fourth of no meaning, in every block of four lanes.
struct Axes {
  Vec v;
};
template <int axis>
HWY_INLINE Vec along(const Axes& a) {
  return hn::Broadcast<axis>(a.v);
}
HWY_INLINE Axes load_axes(const float* p) { return {hn::LoadDup128(Float(), p)}; }
/// From floats that were written one by one, which a vector load would wait for.
HWY_INLINE Axes gather_axes(const float* p) {
  const Float d;
  const hn::RebindToUnsigned<Float> d32;
  const auto lane = hn::And(hn::Iota(d32, 0), hn::Set(d32, 3u));
  const auto is = [&](std::uint32_t i) HWY_ATTR { return hn::RebindMask(d, hn::Eq(lane, hn::Set(d32, i))); };
  return {hn::IfThenElse(is(0), hn::Set(d, p[0]), hn::IfThenElse(is(1), hn::Set(d, p[1]), hn::Set(d, p[2])))};
}
HWY_INLINE Axes load_exponents(const Bvh8Node& node) {
  const hn::RebindToUnsigned<Float> d32;
  const hn::Rebind<std::uint8_t, Float> d8;
  const hn::Repartition<std::uint32_t, decltype(d8)> words;
  std::uint32_t word = 0;
  std::memcpy(&word, node.exponent, 4);
  const auto bytes = hn::BitCast(d8, hn::Set(words, word));
  return {hn::BitCast(Float(), hn::ShiftLeft<23>(hn::PromoteTo(d32, bytes)))};
}
HWY_INLINE Axes operator*(const Axes& a, const Axes& b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE Axes multiply_add(const Axes& a, const Axes& b, const Axes& c) { return {hn::MulAdd(a.v, b.v, c.v)}; }
#endif

/// The ray as the boxes see it: t of a place p on an axis is p * inverse + near for bounds where the ray enters, p *
/// inverse + far where it leaves; they differ by the slack.
struct BoxRay {
  Axes inverse, near, far;
  std::size_t near_side[3], far_side[3];  // where in a node the bounds are that the ray meets first and last
};

HWY_INLINE BoxRay box_ray(const TraceRay& ray, const glm::vec3& corner) {
  BoxRay r;
  float near[3], far[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<int>(a);
    const float from = (corner[axis] - ray.origin[axis]) * ray.inverse[axis];
    // Places are within three extents of the origin; what is rounded here and in pass_children is less than 2^-20 of
    // the extent, which the slack has thrice.
    near[a] = from - 3.0f * ray.slack[axis];
    far[a] = from + 3.0f * ray.slack[axis];
    const std::size_t lo = offsetof(Bvh8Node, lo) + 8 * a, hi = offsetof(Bvh8Node, hi) + 8 * a;
    const bool forward = ray.inverse[axis] >= 0.0f;
    r.near_side[a] = forward ? lo : hi;
    r.far_side[a] = forward ? hi : lo;
  }
  r.inverse = gather_axes(&ray.inverse.x);
  r.near = gather_axes(near);
  r.far = gather_axes(far);
  return r;
}

/// Bit i: the ray passes child i between t_near and t_far; key[i] is where from.
HWY_INLINE std::uint32_t pass_children(const Bvh8Node& node, const BoxRay& ray, float t_near, float t_far,
                                       std::uint32_t* HWY_RESTRICT key) {
  const Float d;
  const hn::RebindToUnsigned<Float> d32;
  const Axes origin = load_axes(&node.origin.x), step = load_exponents(node) * ray.inverse;
  const Axes near = multiply_add(origin, ray.inverse, ray.near), far = multiply_add(origin, ray.inverse, ray.far);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&node);
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < 8; i += lanes) {
    const auto pass = [&]<int axis>(const std::size_t* side, const Axes& from) HWY_ATTR {
      return hn::MulAdd(bytes_to_floats(bytes + side[axis] + i), along<axis>(step), along<axis>(from));
    };
    const Vec enter = hn::Max(
        hn::Max(pass.template operator()<0>(ray.near_side, near), pass.template operator()<1>(ray.near_side, near)),
        hn::Max(pass.template operator()<2>(ray.near_side, near), hn::Set(d, t_near)));
    const Vec leave =
        hn::Min(hn::Min(pass.template operator()<0>(ray.far_side, far), pass.template operator()<1>(ray.far_side, far)),
                hn::Min(pass.template operator()<2>(ray.far_side, far), hn::Set(d, t_far)));
    mask |= bits_of(hn::Le(enter, leave)) << i;
    hn::StoreU(hn::BitCast(d32, enter), d32, key + i);
  }
  return mask & ((1u << node.count) - 1u);
}

/// Lanes of a leaf's triangles that try_triangle may accept: sheared as it does, edge functions in float with a bound
/// on their rounding.
HWY_INLINE std::uint32_t candidates(const float* coordinates, std::size_t k, std::size_t i, const Shear& s,
                                    float t_near, float t_far) {
  const Float d;
  const Vec ox = hn::Set(d, s.origin_x), oy = hn::Set(d, s.origin_y), oz = hn::Set(d, s.origin_z);
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
  const auto [first, count] = leaf_of(ref);
  const std::size_t k = count;
  const std::uint32_t* words = tree.triangles.data() + std::size_t{first} * bvh8_words_per_triangle;
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

Entry* large_stack(int depth) {
  thread_local std::vector<Entry> stack;
  stack.resize(std::max(stack.size(), 8 + 7 * static_cast<std::size_t>(depth)));
  return stack.data();
}

HWY_INLINE void prefetch(const Bvh8& tree, std::uint32_t ref) {
  const auto* leaf =
      reinterpret_cast<const char*>(tree.triangles.data() + std::size_t{ref & 0x0FFFFFFFu} * bvh8_words_per_triangle);
  const auto* node = reinterpret_cast<const char*>(tree.nodes.data() + (ref & 0x7FFFFFFFu));
  const char* at = (ref & bvh8_leaf) != 0 ? leaf : node;
  hwy::Prefetch(at);
  hwy::Prefetch(at + 64);
}

/// Puts the children in the mask onto the stack; if they are to be sorted, the nearest last.
template <bool sorted>
HWY_INLINE void push(Entry* stack, std::size_t& top, const std::uint32_t* key, std::uint32_t mask,
                     const Bvh8Node& node) {
  const std::size_t base = top;
  for (; mask != 0; mask &= mask - 1) {
    const auto child = static_cast<std::size_t>(std::countr_zero(mask));
    const Entry entry = Entry{key[child]} << 32 | node.ref[child];
    std::size_t at = top++;
    if (sorted)
      for (; at > base && stack[at - 1] < entry; --at) stack[at] = stack[at - 1];
    stack[at] = entry;
  }
}

/// The nearest hit; or any one, and then `occluder` is the leaf that has it.
template <bool any, bool counted>
HWY_INLINE RayHit walk(const Bvh8& tree, const TraceRay& ray, TraceCounters* counters, std::uint32_t& occluder) {
  Entry local[room];
  Entry* stack = tree.depth <= deepest ? local : large_stack(tree.depth);
  const BoxRay boxes = box_ray(ray, tree.space.bounds.lo);
  const Bvh8Node* nodes = tree.nodes.data();
  RayHit best{ray.t_far, no_triangle};
  std::size_t top = 0;
  std::uint32_t ref = 0;
  std::uint64_t visits = 0, tests = 0;
  for (;;) {
    if ((ref & bvh8_leaf) == 0) {
      const Bvh8Node& node = nodes[ref];
      HWY_ALIGN std::uint32_t key[8];
      std::uint32_t mask = pass_children(node, boxes, ray.t_near, best.t, key);
      if (counted) ++visits;
      if (mask != 0) {
        const auto first = static_cast<std::uint32_t>(std::countr_zero(mask));
        mask &= mask - 1;
        if (mask == 0) {
          ref = node.ref[first];
          continue;
        }
        const auto second = static_cast<std::uint32_t>(std::countr_zero(mask));
        if (!any && (mask & (mask - 1)) == 0) {
          const Entry a = Entry{key[first]} << 32 | node.ref[first], b = Entry{key[second]} << 32 | node.ref[second];
          stack[top++] = std::max(a, b);
          ref = static_cast<std::uint32_t>(std::min(a, b));
          prefetch(tree, static_cast<std::uint32_t>(stack[top - 1]));
          continue;
        }
        push<!any>(stack, top, key, mask | 1u << first, node);
        ref = static_cast<std::uint32_t>(stack[--top]);
        prefetch(tree, static_cast<std::uint32_t>(stack[top - 1]));
        continue;
      }
    } else {
      if (counted) {
        tests += leaf_of(ref).count;
        if (counters->tested != nullptr) counters->tested->push_back(ref);
      }
      if (try_leaf(tree, ref, ray, best) && any) {
        occluder = ref;
        break;
      }
    }
    const auto limit = std::bit_cast<std::uint32_t>(best.t);
    do {
      if (top == 0) goto done;
      --top;
    } while (static_cast<std::uint32_t>(stack[top] >> 32) > limit);
    ref = static_cast<std::uint32_t>(stack[top]);
  }
done:
  if (counted) {
    counters->nodes += visits;
    counters->tests += tests;
  }
  return best;
}

RayHit retest(const Bvh8& tree, const TraceRay& ray, std::span<const std::uint32_t> leaves) {
  RayHit best{ray.t_far, no_triangle};
  for (const std::uint32_t leaf : leaves) (void)try_leaf(tree, leaf, ray, best);
  return best;
}

template <bool any>
HWY_INLINE RayHit trace(const Bvh8& tree, const Ray& ray, TraceCounters* counters) {
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return {};
  std::uint32_t unused = 0;
  return finish(prepared, counters == nullptr ? walk<any, false>(tree, prepared, nullptr, unused)
                                              : walk<any, true>(tree, prepared, counters, unused));
}
RayHit walk_nearest(const Bvh8& tree, const Ray& ray, TraceCounters* counters) {
  return trace<false>(tree, ray, counters);
}
RayHit walk_any(const Bvh8& tree, const Ray& ray, TraceCounters* counters) { return trace<true>(tree, ray, counters); }

/// Segments order[0 .. count), neighbours alike, one after the other.
void walk_segments(const Bvh8& tree, const Segment* segments, const std::uint32_t* order, std::size_t count,
                   float clearance, std::uint8_t* visible) {
  constexpr std::size_t remembered = 4;
  std::uint32_t occluders[remembered] = {};
  std::size_t known = 0;
  int worth = 16;  // trying them, lately; else only every 16th segment does
  for (std::size_t i = 0; i < count; ++i) {
    const Segment& s = segments[order[i]];
    TraceRay ray;
    std::uint8_t& answer = visible[order[i]];
    answer = 1;
    if (!prepare(segment_ray(s.a, s.b, clearance), tree.space, ray)) continue;
    RayHit best{ray.t_far, no_triangle};
    if (worth > 0 || i % 16 == 0) {
      for (std::size_t k = 0; k < known && answer != 0; ++k) {
        if (!try_leaf(tree, occluders[k], ray, best)) continue;
        answer = 0;
        std::swap(occluders[k], occluders[k / 2]);
      }
      worth = answer == 0 ? std::min(worth + 4, 64) : std::max(worth - 1, 0);
      if (answer == 0) continue;
    }
    std::uint32_t occluder = 0;
    if (!walk<true, false>(tree, ray, nullptr, occluder).found()) continue;
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
  return HWY_DYNAMIC_DISPATCH(walk_nearest)(tree, ray, nullptr);
}

RayHit trace_nearest(const Bvh8& tree, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  return HWY_DYNAMIC_DISPATCH(walk_nearest)(tree, ray, &counters);
}

bool trace_any(const Bvh8& tree, const Ray& ray) { return HWY_DYNAMIC_DISPATCH(walk_any)(tree, ray, nullptr).found(); }

bool trace_any(const Bvh8& tree, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  return HWY_DYNAMIC_DISPATCH(walk_any)(tree, ray, &counters).found();
}

}  // namespace sightline
#endif
