// Many segments down the wide hierarchy at once: neighbours in an order of their ends go together, one in every lane,
// so that a node is fetched and a child tested once for all of them (Wald et al. 2001). The answers of single rays.
#include <bit>
#include <cmath>
#include <cstddef>

#include "sightline/index/bvh8.hpp"
#include "sightline/index/coherent_order.hpp"
#include "sightline/parallel/parallel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/index/bvh8_segments.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/index/bvh8_lanes.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

/// Rays of one octant and one shear axis, one in every lane.
struct Packet {
  enum {
    inverse = 0,
    near = 3,
    far = 6,
    t_near = 9,
    t_far,
    origin_x,
    origin_y,
    origin_z,
    shear_x,
    shear_y,
    scale_z,
    rows
  };
  HWY_ALIGN float value[rows][lanes];
  TraceRay ray[lanes];
  std::uint8_t* answer[lanes];
  std::size_t count = 0;
};

/// Rays of different kinds do not go into one packet.
HWY_INLINE int kind_of(const TraceRay& ray) {
  int kind = ray.shear.z;
  for (int axis = 0; axis < 3; ++axis) kind = 2 * kind + static_cast<int>(std::signbit(ray.inverse[axis]));
  return kind;
}

HWY_INLINE void add(Packet& p, const TraceRay& ray, const glm::vec3& corner, std::uint8_t* answer) {
  const std::size_t i = p.count++;
  p.ray[i] = ray;
  p.answer[i] = answer;
  for (int axis = 0; axis < 3; ++axis) {
    const float from = (corner[axis] - ray.origin[axis]) * ray.inverse[axis];
    p.value[Packet::inverse + axis][i] = ray.inverse[axis];
    p.value[Packet::near + axis][i] = from - 3.0f * ray.slack[axis];
    p.value[Packet::far + axis][i] = from + 3.0f * ray.slack[axis];
  }
  p.value[Packet::t_near][i] = ray.t_near;
  p.value[Packet::t_far][i] = ray.t_far;
  p.value[Packet::origin_x][i] = ray.shear.origin_x;
  p.value[Packet::origin_y][i] = ray.shear.origin_y;
  p.value[Packet::origin_z][i] = ray.shear.origin_z;
  p.value[Packet::shear_x][i] = ray.shear.shear_x;
  p.value[Packet::shear_y][i] = ray.shear.shear_y;
  p.value[Packet::scale_z][i] = ray.shear.scale_z;
}

/// Those of the rays in the mask that a triangle of the leaf stops.
HWY_INLINE std::uint32_t stopped_by(const Bvh8& tree, std::uint32_t ref, const Packet& p, const ShearLanes& s,
                                    std::uint32_t mask) {
  const Float d;
  const LeafWords leaf = words_of(tree, ref);
  const Shear& axes = p.ray[0].shear;
  std::uint32_t stopped = 0;
  for (std::size_t i = 0; i < leaf.k; ++i) {
    const auto load = [&](int corner, int axis) HWY_ATTR {
      return hn::Set(d, leaf.coordinates[static_cast<std::size_t>(3 * corner + axis) * leaf.k + i]);
    };
    const Look look =
        look_at(sheared({load(0, axes.x), load(0, axes.y), load(0, axes.z), load(1, axes.x), load(1, axes.y),
                         load(1, axes.z), load(2, axes.x), load(2, axes.y), load(2, axes.z)},
                        s),
                s);
    stopped |= look.certain & mask;
    for (std::uint32_t left = look.maybe & mask & ~stopped; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      RayHit best{p.ray[lane].t_far, no_triangle};
      if (try_triangle(leaf, i, p.ray[lane], best)) stopped |= 1u << lane;
    }
  }
  return stopped;
}

/// Occluders that stopped rays lately, the last one first.
struct Occluders {
  static constexpr std::size_t most = 2;
  std::uint32_t leaf[most] = {};
  std::size_t count = 0;
  void add(std::uint32_t ref) {
    if (count > 0 && leaf[0] == ref) return;
    if (count < most) ++count;
    for (std::size_t k = count - 1; k > 0; --k) leaf[k] = leaf[k - 1];
    leaf[0] = ref;
  }
};

HWY_INLINE void walk_packet(const Bvh8& tree, Packet& p, Occluders& occluders) {
  const Float d;
  const auto row = [&](int r) HWY_ATTR { return hn::Load(d, p.value[r]); };
  const ShearLanes shear{row(Packet::origin_x), row(Packet::origin_y), row(Packet::origin_z), row(Packet::shear_x),
                         row(Packet::shear_y),  row(Packet::scale_z),  row(Packet::t_near),   row(Packet::t_far)};
  std::uint32_t alive = lowest(p.count);
  for (std::size_t k = 0; k < occluders.count && alive != 0; ++k)
    alive &= ~stopped_by(tree, occluders.leaf[k], p, shear, alive);
  const bool forward[3] = {!std::signbit(p.ray[0].inverse.x), !std::signbit(p.ray[0].inverse.y),
                           !std::signbit(p.ray[0].inverse.z)};
  std::size_t near_side[3], far_side[3];
  for (std::size_t a = 0; a < 3; ++a) {
    near_side[a] = (forward[a] ? offsetof(Bvh8Node, lo) : offsetof(Bvh8Node, hi)) + 32 * a;
    far_side[a] = (forward[a] ? offsetof(Bvh8Node, hi) : offsetof(Bvh8Node, lo)) + 32 * a;
  }
  Entry local[room];
  Entry* stack = tree.depth <= deepest ? local : large_stack(tree.depth);
  std::size_t top = 0;
  std::uint32_t ref = 0, mask = alive;
  while (alive != 0) {
    if ((ref & bvh8_leaf) != 0) {
      const std::uint32_t stopped = stopped_by(tree, ref, p, shear, mask);
      alive &= ~stopped;
      if (stopped != 0) occluders.add(ref);
    } else {
      const Bvh8Node& node = tree.nodes[ref];
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(&node);
      for (std::size_t i = 0; i < 8; ++i) {
        const auto at = [&](std::size_t side, int axis, int from) HWY_ATTR {
          return hn::MulAdd(hn::Set(d, reinterpret_cast<const float*>(bytes + side)[i]), row(Packet::inverse + axis),
                            row(from + axis));
        };
        const Vec enter = hn::Max(hn::Max(at(near_side[0], 0, Packet::near), at(near_side[1], 1, Packet::near)),
                                  hn::Max(at(near_side[2], 2, Packet::near), shear.t_near));
        const Vec leave = hn::Min(hn::Min(at(far_side[0], 0, Packet::far), at(far_side[1], 1, Packet::far)),
                                  hn::Min(at(far_side[2], 2, Packet::far), shear.t_far));
        const std::uint32_t pass = bits_of(hn::Le(enter, leave)) & mask;
        stack[top] = Entry{pass} << 32 | node.ref[i];
        if (pass != 0) prefetch(tree, node.ref[i]);
        top += pass != 0 ? 1 : 0;
      }
    }
    do {
      if (top == 0) goto done;
      --top;
      mask = static_cast<std::uint32_t>(stack[top] >> 32) & alive;
    } while (mask == 0);
    ref = static_cast<std::uint32_t>(stack[top]);
  }
done:
  for (std::size_t i = 0; i < p.count; ++i) *p.answer[i] = static_cast<std::uint8_t>((alive >> i) & 1u);
  p.count = 0;
}

/// Segments order[0 .. count), neighbours alike, as many at a time as there are lanes.
void walk_segments(const Bvh8& tree, const Segment* segments, const std::uint32_t* order, std::size_t count,
                   float clearance, std::uint8_t* visible) {
  Occluders occluders;
  Packet packet{};
  int kind = 0;
  constexpr std::size_t ahead = 32;  // the order jumps about in memory
  for (std::size_t i = 0; i < count; ++i) {
    if (i + ahead < count) hwy::Prefetch(&segments[order[i + ahead]]);
    const Segment& s = segments[order[i]];
    TraceRay ray;
    visible[order[i]] = 1;
    if (!prepare(segment_ray(s.a, s.b, clearance), tree.space, ray)) continue;
    if (packet.count == lanes || (packet.count > 0 && kind != kind_of(ray))) walk_packet(tree, packet, occluders);
    kind = kind_of(ray);
    add(packet, ray, tree.space.bounds.lo, &visible[order[i]]);
  }
  if (packet.count > 0) walk_packet(tree, packet, occluders);
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(walk_segments);

void segments_visible(const Bvh8& tree, std::span<const Segment> segments, std::span<std::uint8_t> visible,
                      float clearance) {
  const std::vector<std::uint32_t> order = coherent_order(tree.space.bounds, segments);
  constexpr std::size_t block = 16384;
  parallel_blocks(segments.size(), block, [&](std::size_t begin, std::size_t end) {
    if (!order.empty()) HWY_DYNAMIC_DISPATCH(walk_segments)
    (tree, segments.data(), order.data() + begin, end - begin, clearance, visible.data());
    else for (std::size_t i = begin; i < end; ++i) visible[i] =
        segment_visible(tree, segments[i].a, segments[i].b, clearance) ? 1 : 0;
  });
}

}  // namespace sightline
#endif
