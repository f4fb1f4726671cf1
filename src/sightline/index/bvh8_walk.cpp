// Rays down the wide hierarchy, once per SIMD target (Highway). Boxes and a first look at triangles are vectors; what
// passes goes to try_triangle, which decides, so that every target gives the same hits.
#include <bit>
#include <cstddef>
#include <vector>

#include "sightline/index/bvh8.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/index/bvh8_walk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/index/bvh8_lanes.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
/// Three floats as three scalars.
struct Axes {
  float v[3];
};
template <int axis>
HWY_INLINE Vec along(const Axes& a) {
  return hn::Set(Float(), a.v[axis]);
}
HWY_INLINE Axes axes(const float* p) { return {{p[0], p[1], p[2]}}; }
#else
/// Three floats, and a fourth of no meaning, in every block of four lanes: a third of the registers, and faster than a
/// vector of each.
struct Axes {
  Vec v;
};
template <int axis>
HWY_INLINE Vec along(const Axes& a) {
  return hn::Broadcast<axis>(a.v);
}
/// From floats that were written one by one, which a vector load would wait for.
HWY_INLINE Axes axes(const float* p) {
  const Float d;
  const hn::RebindToUnsigned<Float> d32;
  const auto lane = hn::And(hn::Iota(d32, 0), hn::Set(d32, 3u));
  const auto is = [&](std::uint32_t i) HWY_ATTR { return hn::RebindMask(d, hn::Eq(lane, hn::Set(d32, i))); };
  return {hn::IfThenElse(is(0), hn::Set(d, p[0]), hn::IfThenElse(is(1), hn::Set(d, p[1]), hn::Set(d, p[2])))};
}
#endif

/// The ray as the boxes see it: t of a place p on an axis is p * inverse + from.
struct BoxRay {
  Axes inverse, from;
  std::size_t near_side[3], far_side[3];  // where in a node the bounds are that the ray meets first and last
};

HWY_INLINE BoxRay box_ray(const TraceRay& ray, const glm::vec3& corner) {
  BoxRay r;
  float from[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<int>(a);
    from[a] = (corner[axis] - ray.origin[axis]) * ray.inverse[axis];
    const std::size_t lo = offsetof(Bvh8Node, lo) + 32 * a, hi = offsetof(Bvh8Node, hi) + 32 * a;
    const bool forward = ray.inverse[axis] >= 0.0f;
    r.near_side[a] = forward ? lo : hi;
    r.far_side[a] = forward ? hi : lo;
  }
  r.inverse = axes(&ray.inverse.x);
  r.from = axes(from);
  return r;
}

/// Bit i: the ray passes child i between t_near and t_far; key[i] is where from.
HWY_INLINE std::uint32_t pass_children(const Bvh8Node& node, const BoxRay& ray, float t_near, float t_far,
                                       std::uint32_t* HWY_RESTRICT key) {
  const Float d;
  const hn::RebindToUnsigned<Float> d32;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&node);
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < 8; i += lanes) {
    const auto pass = [&]<int axis>(const std::size_t* side) HWY_ATTR {
      return hn::MulAdd(hn::LoadU(d, reinterpret_cast<const float*>(bytes + side[axis]) + i), along<axis>(ray.inverse),
                        along<axis>(ray.from));
    };
    const Vec enter =
        hn::Max(hn::Max(pass.template operator()<0>(ray.near_side), pass.template operator()<1>(ray.near_side)),
                hn::Max(pass.template operator()<2>(ray.near_side), hn::Set(d, t_near)));
    const Vec leave =
        hn::Min(hn::Min(pass.template operator()<0>(ray.far_side), pass.template operator()<1>(ray.far_side)),
                hn::Min(pass.template operator()<2>(ray.far_side), hn::Set(d, t_far)));
    mask |= bits_of(hn::Le(enter, leave)) << i;
    hn::StoreU(hn::BitCast(d32, enter), d32, key + i);
  }
  return mask;
}

/// True if a triangle of the leaf became the best hit; or, if any will do, one of it is hit.
template <bool any>
HWY_INLINE bool try_leaf(const Bvh8& tree, std::uint32_t ref, const TraceRay& ray, RayHit& best) {
  const Float d;
  const LeafWords leaf = words_of(tree, ref);
  const Shear& s = ray.shear;
  const ShearLanes lanes_of_ray{hn::Set(d, s.origin_x), hn::Set(d, s.origin_y), hn::Set(d, s.origin_z),
                                hn::Set(d, s.shear_x),  hn::Set(d, s.shear_y),  hn::Set(d, s.scale_z),
                                hn::Set(d, ray.t_near), hn::Set(d, best.t)};
  bool found = false;
  for (std::size_t i = 0; i < leaf.k; i += lanes) {
    const auto load = [&](int corner, int axis) HWY_ATTR {
      return hn::LoadU(d, leaf.coordinates + static_cast<std::size_t>(3 * corner + axis) * leaf.k + i);
    };
    const Corners p = sheared({load(0, s.x), load(0, s.y), load(0, s.z), load(1, s.x), load(1, s.y), load(1, s.z),
                               load(2, s.x), load(2, s.y), load(2, s.z)},
                              lanes_of_ray);
    const Look look = look_at(p, lanes_of_ray);
    const std::uint32_t in_leaf = lowest(leaf.k - i);
    if (any && (look.certain & in_leaf) != 0) {
      best.triangle = 0;
      return true;
    }
    std::uint32_t mask = look.maybe & in_leaf;
    if (mask == 0) continue;
    ShearedLanes in_lanes;
    store(p, in_lanes);
    for (; mask != 0; mask &= mask - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
      found |= try_triangle(leaf, i + lane, in_lanes, lane, ray, best);
    }
  }
  return found;
}

/// Puts the children in the mask onto the stack, above the references where the ray enters (bits of a float that is not
/// negative, which order as integers do); if they are to be sorted, the nearest last, and if not, all are fetched
/// ahead.
template <bool sorted>
HWY_INLINE void push(const Bvh8& tree, Entry* stack, std::size_t& top, const std::uint32_t* key, std::uint32_t mask,
                     const Bvh8Node& node) {
  const std::size_t base = top;
  for (; mask != 0; mask &= mask - 1) {
    const auto child = static_cast<std::size_t>(std::countr_zero(mask));
    const Entry entry = Entry{key[child]} << 32 | node.ref[child];
    std::size_t at = top++;
    if (sorted)
      for (; at > base && stack[at - 1] < entry; --at) stack[at] = stack[at - 1];
    stack[at] = entry;
    if (!sorted) prefetch(tree, node.ref[child]);
  }
}

/// The nearest hit, or any one.
template <bool any, bool counted>
HWY_INLINE RayHit walk(const Bvh8& tree, const TraceRay& ray, TraceCounters* counters) {
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
        push<!any>(tree, stack, top, key, mask | 1u << first, node);
        ref = static_cast<std::uint32_t>(stack[--top]);
        if (!any) prefetch(tree, static_cast<std::uint32_t>(stack[top - 1]));
        continue;
      }
    } else {
      if (counted) {
        tests += leaf_of(ref).count;
        if (counters->tested != nullptr) counters->tested->push_back(ref);
      }
      if (try_leaf<any>(tree, ref, ray, best) && any) break;
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
  for (const std::uint32_t leaf : leaves) (void)try_leaf<false>(tree, leaf, ray, best);
  return best;
}

template <bool any>
HWY_INLINE RayHit trace(const Bvh8& tree, const Ray& ray, TraceCounters* counters) {
  TraceRay prepared;
  if (!prepare(ray, tree.space, prepared)) return {};
  return finish(prepared, counters == nullptr ? walk<any, false>(tree, prepared, nullptr)
                                              : walk<any, true>(tree, prepared, counters));
}
RayHit walk_nearest(const Bvh8& tree, const Ray& ray, TraceCounters* counters) {
  return trace<false>(tree, ray, counters);
}
RayHit walk_any(const Bvh8& tree, const Ray& ray, TraceCounters* counters) { return trace<true>(tree, ray, counters); }

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(walk_nearest);
HWY_EXPORT(walk_any);
HWY_EXPORT(retest);

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
