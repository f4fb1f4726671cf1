// Many segments down the wide hierarchy at once, dozens of them under way: each takes a step in turn, so that while one
// waits for memory others compute (Kocberber, Falsafi and Grot 2015), and hardly a step branches on what its segment
// meets. Segments between the same places are tried first against what stopped the last one. The answers of single
// rays.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sightline/geometry/lane_ids.hpp"
#include "sightline/index/bvh8.hpp"
#include "sightline/parallel/parallel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/index/bvh8_segments.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/index/bvh8_lanes.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using Whole = hn::RebindToUnsigned<Float>;
using WholeVec = hn::Vec<Whole>;

constexpr std::size_t most_ways = 32;
constexpr int guess_bits = 11, cell_bits = 5;
static_assert(6 * cell_bits <= 32);
/// Below everything on a stack: a leaf that no tree has.
constexpr std::uint32_t arrived = 0xFFFFFFFFu;

/// Where in a node the bounds are that rays of an octant meet first, and last.
struct Sides {
  std::uint32_t near[3], far[3];
};
constexpr std::array<Sides, 8> sides_of_octant = [] {
  std::array<Sides, 8> table{};
  for (std::uint32_t octant = 0; octant < 8; ++octant)
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const bool backward = ((octant >> axis) & 1u) != 0;
      const std::uint32_t lo = offsetof(Bvh8Node, lo) + 32 * axis, hi = offsetof(Bvh8Node, hi) + 32 * axis;
      table[octant].near[axis] = backward ? hi : lo;
      table[octant].far[axis] = backward ? lo : hi;
    }
  return table;
}();

/// What a segment needs on its way. t of a place p on an axis is p * inverse + from.
enum Real { inverse = 0, from = 3, origin_x = 6, origin_y, origin_z, shear_x, shear_y, scale_z, reals };
enum Number { axis_x = 0, axis_y, axis_z, octant, guess_slot, numbers };
struct Way {
  float real[reals];
  const Sides* sides;
  std::uint32_t *stack, *top;
  std::uint32_t ref;
  std::uint32_t number[numbers];
  std::uint32_t segment;
};

/// As many segments as there are lanes, made ready.
struct Starts {
  HWY_ALIGN float real[reals][lanes];
  HWY_ALIGN std::uint32_t number[numbers][lanes];
  std::uint32_t ordinary;  // lanes that prepare() would take, and as they are
};

/// As prepare() does, bit by bit. Lanes above the count repeat the last one.
HWY_INLINE void make_ready(const TraceSpace& space, const Segment* segments, std::size_t count, Starts& s) {
  const Float d;
  const Whole whole;
  HWY_ALIGN float ends[6][lanes];
  for (std::size_t i = 0; i < lanes; ++i) {
    const Segment& segment = segments[std::min(i, count - 1)];
    const float *a = &segment.a.x, *b = &segment.b.x;
    for (std::size_t axis = 0; axis < 3; ++axis) ends[axis][i] = a[axis], ends[3 + axis][i] = b[axis];
  }
  const auto real = [&](int row, const Vec& v) HWY_ATTR { hn::Store(v, d, s.real[row]); };
  const auto number = [&](int row, const WholeVec& v) HWY_ATTR { hn::Store(v, whole, s.number[row]); };

  Vec a[3], direction[3], size[3];
  auto ordinary = hn::Eq(hn::Zero(d), hn::Zero(d));
  WholeVec cells = hn::Zero(whole);
  const glm::vec3 extent = space.bounds.extent();
  const Vec last_cell = hn::Set(d, static_cast<float>((1 << cell_bits) - 1));
  const Vec scale = hn::Div(last_cell, hn::Set(d, std::max({extent.x, extent.y, extent.z, 1e-30f})));
  for (int axis = 0; axis < 3; ++axis) {
    a[axis] = hn::Load(d, ends[axis]);
    const Vec b = hn::Load(d, ends[3 + axis]);
    direction[axis] = hn::Sub(b, a[axis]);
    size[axis] = hn::Abs(direction[axis]);
    const auto reached =
        hn::And(hn::Ge(a[axis], hn::Set(d, space.reach.lo[axis])), hn::Le(a[axis], hn::Set(d, space.reach.hi[axis])));
    ordinary = hn::And(ordinary, hn::And(reached, hn::Le(size[axis], hn::Set(d, longest_direction))));
    for (const Vec& end : {a[axis], b}) {
      const Vec at = hn::Mul(hn::Sub(end, hn::Set(d, space.bounds.lo[axis])), scale);
      const auto cell = hn::ConvertTo(hn::RebindToSigned<Float>(), hn::Min(hn::Max(at, hn::Zero(d)), last_cell));
      cells = hn::Or(hn::ShiftLeft<cell_bits>(cells), hn::BitCast(whole, cell));
    }
  }
  number(guess_slot, hn::ShiftRight<32 - guess_bits>(hn::Mul(cells, hn::Set(whole, 0x9E3779B1u))));
  const Vec longest = hn::Max(hn::Max(size[0], size[1]), size[2]);
  s.ordinary = bits_of(hn::And(ordinary, hn::Ge(longest, hn::Set(d, shortest_direction))));

  const Vec least = hn::Max(hn::Mul(longest, hn::Set(d, 1e-12f)), hn::Set(d, space.least)), one = hn::Set(d, 1.0f);
  WholeVec signs = hn::Zero(whole);
  for (int axis = 2; axis >= 0; --axis) {
    const Vec over = hn::Div(one, hn::CopySign(hn::Max(size[axis], least), direction[axis]));
    real(inverse + axis, over);
    real(from + axis, hn::Mul(hn::Sub(hn::Set(d, space.bounds.lo[axis]), a[axis]), over));
    signs = hn::Or(hn::ShiftLeft<1>(signs), hn::ShiftRight<31>(hn::BitCast(whole, over)));
  }
  number(octant, signs);

  const auto is_z = hn::Gt(size[2], hn::Max(size[0], size[1])), is_y = hn::AndNot(is_z, hn::Gt(size[1], size[0]));
  // So many axes after the largest.
  const auto turned = [&](const Vec* v, int n) HWY_ATTR {
    return hn::IfThenElse(is_z, v[(2 + n) % 3], hn::IfThenElse(is_y, v[(1 + n) % 3], v[n % 3]));
  };
  Vec axes[3];
  for (std::uint32_t axis = 0; axis < 3; ++axis) axes[axis] = hn::BitCast(d, hn::Set(whole, axis));
  for (int n = 0; n < 3; ++n) {
    constexpr int origins[3] = {origin_z, origin_x, origin_y}, names[3] = {axis_z, axis_x, axis_y};
    real(origins[n], turned(a, n));
    number(names[n], hn::BitCast(whole, turned(axes, n)));
  }
  const Vec depth = turned(direction, 0);
  real(shear_x, hn::Div(turned(direction, 1), depth));
  real(shear_y, hn::Div(turned(direction, 2), depth));
  real(scale_z, hn::Div(one, depth));
}

/// Bit i: the way passes child i.
HWY_INLINE std::uint32_t pass_children(const Bvh8Node& node, const Way& way, float t_near, float t_far) {
  const Float d;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&node);
  const Sides& sides = *way.sides;
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < 8; i += lanes) {
    const auto pass = [&](const std::uint32_t* side, std::size_t axis) HWY_ATTR {
      return hn::MulAdd(hn::LoadU(d, reinterpret_cast<const float*>(bytes + side[axis]) + i),
                        hn::Set(d, way.real[inverse + axis]), hn::Set(d, way.real[from + axis]));
    };
    const Vec enter =
        hn::Max(hn::Max(pass(sides.near, 0), pass(sides.near, 1)), hn::Max(pass(sides.near, 2), hn::Set(d, t_near)));
    const Vec leave =
        hn::Min(hn::Min(pass(sides.far, 0), pass(sides.far, 1)), hn::Min(pass(sides.far, 2), hn::Set(d, t_far)));
    mask |= bits_of(hn::Le(enter, leave)) << i;
  }
  return mask;
}

/// Writes the children in the mask, where there must be room for eight. How many.
HWY_INLINE std::size_t list_children(const Bvh8Node& node, std::uint32_t mask, std::uint32_t* to) {
  if constexpr (lanes == 8) {
    const Whole d;
    const hn::Rebind<std::uint8_t, Float> bytes;
    const auto order = hn::PromoteTo(hn::RebindToSigned<Float>(), hn::LoadU(bytes, lanes_of_bits[mask].data()));
    hn::StoreU(hn::TableLookupLanes(hn::LoadU(d, node.ref), hn::IndicesFromVec(d, order)), d, to);
    return static_cast<std::size_t>(std::popcount(mask));
  } else {
    std::size_t count = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      to[count] = node.ref[i];
      count += (mask >> i) & 1u;
    }
    return count;
  }
}

class Walk {
 public:
  Walk(const Bvh8& tree, const Segment* segments, float clearance, std::uint8_t* visible)
      : tree_(tree),
        segments_(segments),
        visible_(visible),
        clearance_(clearance),
        t_near_(std::max(0.0f, clearance)),
        t_far_(1.0f - clearance),
        guesses_(std::size_t{1} << guess_bits, arrived) {
    const std::size_t each = 16 + 7 * static_cast<std::size_t>(tree.depth);
    stacks_.resize(most_ways * each);
    for (std::size_t i = 0; i < most_ways; ++i) {
      ways_[i].stack = &stacks_[i * each];
      ways_[i].stack[0] = arrived;
      free_[i] = &ways_[i];
    }
  }

  void run(std::size_t begin, std::size_t end) {
    for (std::size_t next = begin; next < end || free_count_ < most_ways;) {
      while (next < end && free_count_ >= lanes) {
        const std::size_t count = std::min(lanes, end - next);
        start(next, count);
        next += count;
      }
      visit_nodes();
      test_leaves();
    }
  }

 private:
  void start(std::size_t first, std::size_t count) {
    Starts starts;
    make_ready(tree_.space, segments_ + first, count, starts);
    if (!(t_near_ <= t_far_)) starts.ordinary = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Segment& segment = segments_[first + i];
      visible_[first + i] = 1;
      if (((starts.ordinary >> i) & 1u) == 0) {
        visible_[first + i] = segment_visible(tree_, segment.a, segment.b, clearance_) ? 1 : 0;
        continue;
      }
      Way* const way = free_[--free_count_];
      for (std::size_t row = 0; row < reals; ++row) way->real[row] = starts.real[row][i];
      for (std::size_t row = 0; row < numbers; ++row) way->number[row] = starts.number[row][i];
      way->sides = &sides_of_octant[way->number[octant]];
      way->segment = static_cast<std::uint32_t>(first + i);
      way->stack[1] = 0;  // the root; above it the guess
      const std::uint32_t guess = guessing_ ? guesses_[way->number[guess_slot]] : arrived;
      const std::size_t known = guess != arrived ? 1 : 0;
      way->top = way->stack + 1 + known;
      way->ref = known != 0 ? guess : 0;
      prefetch(tree_, way->ref);
      guessed_ += known;
      go_on(way, true);
    }
    // Where segments have little in common guesses cost more than they save, which shows soon.
    guessing_ = guessed_ <= 256 + 8 * guessed_right_;
  }

  /// Where the way is tested next, unless it ends here. By counting, not by branches.
  HWY_INLINE void go_on(Way* way, bool goes) {
    const std::size_t is_leaf = way->ref >> 31, on = goes ? 1 : 0;
    nodes_[node_count_] = way;
    leaves_[leaf_count_] = way;
    free_[free_count_] = way;
    node_count_ += on & (1 - is_leaf);
    leaf_count_ += on & is_leaf;
    free_count_ += 1 - on;
  }

  void visit_nodes() {
    const std::size_t count = node_count_;
    const Bvh8Node* nodes = tree_.nodes.data();
    const float t_near = t_near_, t_far = t_far_;
    Way** leaves = leaves_ + leaf_count_;
    std::size_t stay = 0;  // at nodes
    for (std::size_t i = 0; i < count; ++i) {
      Way* const way = nodes_[i];
      const Bvh8Node& node = nodes[way->ref];
      std::uint32_t* top = way->top;
      top += list_children(node, pass_children(node, *way, t_near, t_far), top);
      const std::uint32_t ref = *--top;
      prefetch(tree_, ref);
      way->top = top;
      way->ref = ref;
      nodes_[stay] = way;
      leaves[i - stay] = way;
      stay += (ref >> 31) ^ 1u;
    }
    node_count_ = stay;
    leaf_count_ += count - stay;
  }

  void test_leaves() {
    const std::size_t count = std::exchange(leaf_count_, 0);
    for (std::size_t i = 0; i < count; ++i) {
      Way* const way = leaves_[i];
      if (way->ref == arrived) {
        free_[free_count_++] = way;
        continue;
      }
      const bool stopped = is_stopped(*way);
      visible_[way->segment] = stopped ? 0 : 1;
      if (guessing_) {
        std::uint32_t& guess = guesses_[way->number[guess_slot]];
        guessed_right_ += stopped && guess == way->ref ? 1 : 0;
        guess = stopped ? way->ref : guess;
      }
      way->ref = *--way->top;
      prefetch(tree_, way->ref);
      go_on(way, !stopped);
    }
  }

  HWY_INLINE bool is_stopped(const Way& way) const {
    const Float d;
    const LeafWords leaf = words_of(tree_, way.ref);
    const float* x = leaf.coordinates + way.number[axis_x] * leaf.k;
    const float* y = leaf.coordinates + way.number[axis_y] * leaf.k;
    const float* z = leaf.coordinates + way.number[axis_z] * leaf.k;
    const auto all = [&](int row) HWY_ATTR { return hn::Set(d, way.real[row]); };
    const ShearLanes s{all(origin_x), all(origin_y), all(origin_z),       all(shear_x),
                       all(shear_y),  all(scale_z),  hn::Set(d, t_near_), hn::Set(d, t_far_)};
    for (std::size_t a = 0; a < leaf.k; a += lanes) {
      const std::size_t b = a + 3 * leaf.k, c = a + 6 * leaf.k;
      const Corners p = sheared(
          {hn::LoadU(d, x + a), hn::LoadU(d, y + a), hn::LoadU(d, z + a), hn::LoadU(d, x + b), hn::LoadU(d, y + b),
           hn::LoadU(d, z + b), hn::LoadU(d, x + c), hn::LoadU(d, y + c), hn::LoadU(d, z + c)},
          s);
      const Look look = look_at(p, s);
      const std::uint32_t in_leaf = lowest(leaf.k - a), maybe = look.maybe & in_leaf;
      if ((look.certain & in_leaf) != 0 || (maybe != 0 && is_stopped_by(leaf, a, maybe, way.segment))) return true;
    }
    return false;
  }

  /// The exact test, of the triangles in the mask, from the first on. Seldom asked.
  HWY_NOINLINE bool is_stopped_by(const LeafWords& leaf, std::size_t first, std::uint32_t mask,
                                  std::uint32_t segment) const {
    TraceRay ray;
    if (!prepare(segment_ray(segments_[segment].a, segments_[segment].b, clearance_), tree_.space, ray)) return false;
    RayHit best{ray.t_far, no_triangle};
    for (; mask != 0; mask &= mask - 1)
      if (try_triangle(leaf, first + static_cast<std::size_t>(std::countr_zero(mask)), ray, best)) return true;
    return false;
  }

  const Bvh8& tree_;
  const Segment* segments_;
  std::uint8_t* visible_;
  float clearance_, t_near_, t_far_;
  std::vector<std::uint32_t> guesses_;  // by slot, the leaf that stopped a segment last
  bool guessing_ = true;
  std::size_t guessed_ = 0, guessed_right_ = 0;
  std::vector<std::uint32_t> stacks_;
  Way ways_[most_ways];
  // Ways that are at a node, at a leaf or the end, and nowhere; with room for one that is written and does not count.
  Way *nodes_[most_ways + 1], *leaves_[most_ways + 1], *free_[most_ways + 1];
  std::size_t node_count_ = 0, leaf_count_ = 0, free_count_ = most_ways;
};

void walk_segments(const Bvh8& tree, const Segment* segments, std::size_t begin, std::size_t end, float clearance,
                   std::uint8_t* visible) {
  Walk(tree, segments, clearance, visible).run(begin, end);
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(walk_segments);

void segments_visible(const Bvh8& tree, std::span<const Segment> segments, std::span<std::uint8_t> visible,
                      float clearance) {
  constexpr std::size_t block = 16384;
  parallel_blocks(segments.size(), block, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(walk_segments)(tree, segments.data(), begin, end, clearance, visible.data());
  });
}

}  // namespace sightline
#endif
