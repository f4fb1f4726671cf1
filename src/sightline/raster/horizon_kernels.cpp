#include "sightline/raster/horizon_kernels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/raster/horizon_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE bool hidden(const HorizonPlan& plan, const HorizonBox& box, Counters& counters) {
  const hn::CappedTag<float, 8> d;
  const auto low = hn::Set(d, box.low), high = hn::Set(d, box.high);
  const std::size_t lanes = hn::Lanes(d), count = std::size_t{box.last} - box.first + 1;
  ++counters.queries;
  counters.cells_tested += count;
  for (std::size_t c = 0; c < count; c += lanes) {
    const auto open = hn::Or(hn::Gt(hn::LoadU(d, plan.low + box.first + c), low),
                             hn::Lt(hn::LoadU(d, plan.high + box.first + c), high));
    if (!hn::AllFalse(d, hn::And(open, hn::FirstN(d, count - c)))) return false;
  }
  return true;
}

bool hidden_simd(const HorizonPlan& plan, const HorizonBox& box, Counters& counters) {
  return hidden(plan, box, counters);
}

/// As many boxes as a vector has lanes, projected.
struct Lanes {
  alignas(64) float nearest[8], farthest[8], low[8], high[8];
  alignas(64) std::int32_t first[8], last[8];
};

/// Coordinates to the eye: lo and hi of the three axes. What is rounded is widened by 2^-21, eight times half an ulp,
/// of the terms that it came from.
template <bool perspective, class D, class V>
HWY_INLINE void project(D d, const HorizonPlan& plan, const V (&lo)[3], const V (&hi)[3], Lanes& out) {
  const hn::RebindToSigned<D> di;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f), rounding = hn::Set(d, 0x1p-21f);
  const auto set = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<float>(value)); };
  const auto limit = set(plan.limit);
  V nearest = zero, farthest = zero, u0 = zero, u1 = zero;
  for (int corner = 0; corner < 4; ++corner) {
    const auto x = (corner & 1) != 0 ? hi[0] : lo[0], z = (corner & 2) != 0 ? hi[2] : lo[2];
    const auto along = hn::Add(hn::Mul(set(plan.forward.x), x), hn::Mul(set(plan.forward.y), z));
    auto u = hn::Add(hn::Mul(set(plan.right.x), x), hn::Mul(set(plan.right.y), z));
    if constexpr (perspective) u = hn::Div(u, along);
    nearest = corner == 0 ? along : hn::Min(nearest, along);
    farthest = corner == 0 ? along : hn::Max(farthest, along);
    u0 = corner == 0 ? u : hn::Min(u0, u);
    u1 = corner == 0 ? u : hn::Max(u1, u);
  }
  const auto error =
      hn::Mul(rounding, hn::Add(hn::Max(hn::Abs(lo[0]), hn::Abs(hi[0])), hn::Max(hn::Abs(lo[2]), hn::Abs(hi[2]))));
  nearest = hn::Sub(nearest, error);
  farthest = hn::Add(farthest, error);
  V low, high, aside;
  auto askable = hn::Ge(farthest, nearest);
  if constexpr (perspective) {
    askable = hn::Gt(nearest, set(1e-3 * plan.near));
    const auto z_near = hn::Div(one, nearest), z_far = hn::Div(one, farthest);
    low = hn::Mul(lo[1], hn::IfThenElse(hn::Lt(lo[1], zero), z_near, z_far));
    high = hn::Mul(hi[1], hn::IfThenElse(hn::Gt(hi[1], zero), z_near, z_far));
    low = hn::Sub(low, hn::Mul(rounding, hn::Abs(low)));
    high = hn::Add(high, hn::Mul(rounding, hn::Abs(high)));
    aside = hn::Mul(hn::Mul(error, z_near), hn::Add(one, hn::Max(hn::Abs(u0), hn::Abs(u1))));
  } else {
    const auto a = hn::Mul(set(plan.tilt), nearest), b = hn::Mul(set(plan.tilt), farthest);
    const auto most = hn::Max(hn::Abs(a), hn::Abs(b));
    low = hn::Sub(hn::Sub(lo[1], hn::Max(a, b)), hn::Mul(rounding, hn::Add(hn::Abs(lo[1]), most)));
    high = hn::Add(hn::Sub(hi[1], hn::Min(a, b)), hn::Mul(rounding, hn::Add(hn::Abs(hi[1]), most)));
    aside = error;
  }
  if (plan.open_sides) askable = hn::And(askable, hn::And(hn::Ge(u0, hn::Neg(limit)), hn::Le(u1, limit)));
  aside = hn::Add(aside, set(1e-6 * plan.limit));  // columns are numbers of at most 2^16: their rounding
  const auto column = [&](V u) HWY_ATTR {
    const auto c = hn::IfThenElseZero(askable, hn::Mul(hn::Add(u, limit), set(plan.per_u)));
    return hn::ConvertTo(di, hn::Min(hn::Max(c, zero), set(plan.columns - 1)));
  };
  const auto asks = hn::RebindMask(di, askable);
  hn::Store(nearest, d, out.nearest);
  hn::Store(farthest, d, out.farthest);
  hn::Store(low, d, out.low);
  hn::Store(high, d, out.high);
  hn::Store(hn::IfThenElse(asks, column(hn::Sub(u0, aside)), hn::Set(di, 1)), di, out.first);
  hn::Store(hn::IfThenElseZero(asks, column(hn::Add(u1, aside))), di, out.last);
}

std::size_t boxes_over_horizon_simd(const HorizonPlan& plan, const BoxArrays& boxes, std::size_t begin, std::size_t end,
                                    const Frustum& frustum, float walls_to, HorizonBox* out, Counters& counters) {
  const hn::CappedTag<float, 8> d;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t found = 0;
  for (std::size_t i = begin; i < end; i += lanes) {
    V lo[3], hi[3];
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = hn::LoadU(d, boxes.lo[axis].data() + i);
      hi[axis] = hn::LoadU(d, boxes.hi[axis].data() + i);
    }
    auto in = hn::And(hn::Le(lo[0], hi[0]), hn::FirstN(d, end - i));
    for (int p = 0; p < frustum.count; ++p) {
      const Plane& plane = frustum.planes[static_cast<std::size_t>(p)];
      auto distance = hn::Mul(hn::Set(d, plane.normal.x), plane.normal.x >= 0 ? hi[0] : lo[0]);
      for (int axis = 1; axis < 3; ++axis)
        distance =
            hn::Add(distance, hn::Mul(hn::Set(d, plane.normal[axis]), plane.normal[axis] >= 0 ? hi[axis] : lo[axis]));
      in = hn::And(in, hn::Ge(hn::Add(distance, hn::Set(d, plane.offset)), hn::Zero(d)));
    }
    if (hn::AllFalse(d, in)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const auto eye = static_cast<float>(plan.eye[axis]), rest = static_cast<float>(plan.eye[axis] - eye);
      lo[axis] = hn::Sub(hn::Sub(lo[axis], hn::Set(d, eye)), hn::Set(d, rest));
      hi[axis] = hn::Sub(hn::Sub(hi[axis], hn::Set(d, eye)), hn::Set(d, rest));
    }
    Lanes at;
    if (plan.perspective)
      project<true>(d, plan, lo, hi, at);
    else
      project<false>(d, plan, lo, hi, at);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, in, bits);
    for (std::uint32_t left = bits[0]; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      const HorizonBox box{static_cast<std::uint32_t>(i + k),
                           at.nearest[k],
                           at.farthest[k],
                           static_cast<std::uint16_t>(at.first[k]),
                           static_cast<std::uint16_t>(at.last[k]),
                           at.low[k],
                           at.high[k]};
      if (box.first > box.last || box.nearest < walls_to || !hidden(plan, box, counters)) out[found++] = box;
    }
  }
  return found;
}

constexpr double share = 1e-6;  // relative rounding that walls allow for

/// Walls joined end to end that go from left to right across the columns.
struct Run {
  const double *u, *z;  // of every upright edge: place across the columns, ascending; what is affine in u along a wall
  std::size_t count;    // at least 2
  double y0, y1;        // from where to where every wall is solid: height over the eye
  double slack;         // by how much the real walls may stand aside, metres
};

/// What is affine in u, at the borders of columns and, of the walls' corners, within columns.
struct ColumnDepths {
  double *at_border, *least, *most;
};

/// From `first` on, so many columns.
HWY_INLINE void find_depths(const HorizonPlan& plan, const Run& run, std::size_t first, std::size_t columns,
                            const ColumnDepths& out) {
  const hn::CappedTag<double, 4> d;
  const std::size_t lanes = hn::Lanes(d);
  std::fill_n(out.least, columns, std::numeric_limits<double>::infinity());
  std::fill_n(out.most, columns, -std::numeric_limits<double>::infinity());
  const auto from = hn::Set(d, static_cast<double>(first)), width = hn::Set(d, 1 / plan.per_u),
             limit = hn::Set(d, plan.limit);
  std::size_t border = 0;
  for (std::size_t wall = 0; wall + 1 < run.count; ++wall) {
    const double u0 = run.u[wall], u1 = run.u[wall + 1], z0 = run.z[wall], z1 = run.z[wall + 1];
    const auto end = hn::Set(d, wall + 2 < run.count ? u1 : std::numeric_limits<double>::infinity());
    const auto z_per_u = hn::Set(d, u1 > u0 ? (z1 - z0) / (u1 - u0) : 0.0);
    for (std::size_t taken = lanes; taken == lanes && border <= columns; border += taken) {
      const auto column = hn::Add(from, hn::Iota(d, static_cast<double>(border)));
      const auto u = hn::Sub(hn::Mul(column, width), limit);
      const auto along = hn::Max(hn::Zero(d), hn::Sub(u, hn::Set(d, u0)));
      const auto z =
          hn::IfThenElse(hn::Ge(u, hn::Set(d, u1)), hn::Set(d, z1), hn::Add(hn::Set(d, z0), hn::Mul(along, z_per_u)));
      hn::StoreU(z, d, out.at_border + border);
      taken = hn::CountTrue(d, hn::Le(u, end));
    }
    if (wall + 2 < run.count && border > 0 && border <= columns) {  // a corner within a column
      out.least[border - 1] = std::min(out.least[border - 1], z1);
      out.most[border - 1] = std::max(out.most[border - 1], z1);
    }
  }
}

/// `side`: by how much the real walls may stand aside, in u.
HWY_INLINE void join_slopes(const HorizonPlan& plan, const Run& run, std::size_t first, std::size_t columns,
                            double side, const ColumnDepths& depths) {
  const hn::CappedTag<double, 4> d;
  const hn::Rebind<float, decltype(d)> df;
  const std::size_t lanes = hn::Lanes(d);
  const auto aside = hn::Set(d, side), rounding = hn::Set(d, share);
  const auto slopes = [&](double y, hn::Vec<decltype(d)> z) HWY_ATTR {
    return plan.perspective ? hn::Mul(hn::Set(d, y), z) : hn::Sub(hn::Set(d, y), hn::Mul(hn::Set(d, plan.tilt), z));
  };
  for (std::size_t c = 0; c < columns; c += lanes) {
    const auto left = hn::LoadU(d, depths.at_border + c), right = hn::LoadU(d, depths.at_border + c + 1);
    auto z0 = hn::Min(hn::LoadU(d, depths.least + c), hn::Min(left, right));
    auto z1 = hn::Max(hn::LoadU(d, depths.most + c), hn::Max(left, right));
    const auto widening =
        hn::Add(hn::Mul(rounding, hn::Add(hn::Abs(z0), hn::Abs(z1))), plan.perspective ? hn::Mul(aside, z1) : aside);
    z0 = hn::Sub(z0, widening);
    z1 = hn::Add(z1, widening);
    const auto foot0 = slopes(run.y0, z0), foot1 = slopes(run.y0, z1), top0 = slopes(run.y1, z0),
               top1 = slopes(run.y1, z1);
    const auto margin =
        hn::Add(hn::Mul(hn::Set(d, 4.0), aside), hn::Mul(rounding, hn::Add(hn::Abs(foot1), hn::Abs(top1))));
    const auto low = hn::Add(hn::Max(foot0, foot1), margin), high = hn::Sub(hn::Min(top0, top1), margin);
    const auto l = hn::DemoteTo(df, low), h = hn::DemoteTo(df, high);
    float *const lows = plan.low + first + c, *const highs = plan.high + first + c;
    const auto a = hn::LoadU(df, lows), b = hn::LoadU(df, highs);
    const auto some = hn::And(hn::Lt(l, h), hn::FirstN(df, columns - c)), none = hn::Gt(a, b);
    const auto touch = hn::And(hn::Le(l, b), hn::Ge(h, a));
    // Of two intervals that lie apart the longer one is kept.
    const auto replace = hn::Or(none, hn::AndNot(touch, hn::Gt(hn::Sub(h, l), hn::Sub(b, a))));
    const auto join = hn::AndNot(none, touch);
    const auto low_now = hn::IfThenElse(replace, l, hn::IfThenElse(join, hn::Min(a, l), a));
    const auto high_now = hn::IfThenElse(replace, h, hn::IfThenElse(join, hn::Max(b, h), b));
    hn::StoreU(hn::IfThenElse(some, low_now, a), df, lows);
    hn::StoreU(hn::IfThenElse(some, high_now, b), df, highs);
  }
}

void add_run(const HorizonPlan& plan, const Run& run, double* scratch) {
  const double first_u = run.u[0], last_u = run.u[run.count - 1];
  if ((last_u - first_u) * plan.per_u < 1) return;
  const auto [z_least, z_most] = std::minmax_element(run.z, run.z + run.count);
  // The real walls end and stand up to `slack` aside, which looks this large.
  const double side = plan.perspective ? run.slack * *z_most : run.slack;
  const auto border = [&](double at) { return std::clamp(at, 0.0, static_cast<double>(plan.columns)); };
  const double from_column =
      border(std::ceil((first_u + 4 * side * (1 + std::abs(first_u)) + plan.limit) * plan.per_u + share));
  const double to_column =
      border(std::floor((last_u - 4 * side * (1 + std::abs(last_u)) + plan.limit) * plan.per_u - share));
  if (!(from_column < to_column)) return;
  const auto slope = [&](double y, double z) { return plan.perspective ? y * z : y - plan.tilt * z; };
  // The far walls of a house: nothing that nearer ones do not hide already.
  HorizonBox all{};
  all.first = static_cast<std::uint16_t>(from_column);
  all.last = static_cast<std::uint16_t>(to_column - 1);
  all.low = static_cast<float>(std::min(slope(run.y0, *z_least), slope(run.y0, *z_most)));
  all.high = static_cast<float>(std::max(slope(run.y1, *z_least), slope(run.y1, *z_most)));
  Counters unused;
  if (hidden(plan, all, unused)) return;

  const std::size_t padded = static_cast<std::size_t>(plan.columns) + 8, columns = all.last - all.first + 1u;
  const ColumnDepths depths{scratch, scratch + padded, scratch + 2 * padded};
  find_depths(plan, run, all.first, columns, depths);
  join_slopes(plan, run, all.first, columns, side, depths);
}

void add_fence_simd(const HorizonPlan& plan, std::span<const glm::dvec2> points, const HorizonWall& wall,
                    std::vector<double>& scratch) {
  const hn::CappedTag<double, 4> d;
  const std::size_t lanes = hn::Lanes(d), count = points.size();
  scratch.resize(std::max(scratch.size(), 3 * (static_cast<std::size_t>(plan.columns) + 8) + 4 * (count + 8)));
  double* const u = scratch.data();
  double *const z = u + count + 8, *const left_u = z + count + 8, *const left_z = left_u + count + 8,
                *const rest = left_z + count + 8;
  const double y0 = wall.y0 - plan.eye.y, y1 = wall.y1 - plan.eye.y;
  const auto rise = hn::Set(d, std::min(plan.climb * y0, plan.climb * y1));
  const auto eye_x = hn::Set(d, plan.eye.x - wall.x), eye_z = hn::Set(d, plan.eye.z - wall.z);
  for (std::size_t i = 0; i < count; i += lanes) {
    double tail[8] = {};
    const double* from = &points[i].x;
    if (i + lanes > count) from = std::copy_n(from, 2 * (count - i), tail) - 2 * (count - i);
    hn::Vec<decltype(d)> x, y;
    hn::LoadInterleaved2(d, from, x, y);
    x = hn::Sub(x, eye_x);
    y = hn::Sub(y, eye_z);
    const auto distance = hn::Add(hn::Mul(hn::Set(d, plan.forward.x), x), hn::Mul(hn::Set(d, plan.forward.y), y));
    const auto across = hn::Add(hn::Mul(hn::Set(d, plan.right.x), x), hn::Mul(hn::Set(d, plan.right.y), y));
    const auto nearest = hn::Add(hn::Mul(hn::Set(d, plan.level), distance), rise);
    // Edges before the near plane have no place.
    auto usable = hn::Gt(
        nearest, hn::Add(hn::Set(d, plan.near * (1 + share)), hn::Mul(hn::Set(d, 2 * share), hn::Abs(distance))));
    if (plan.perspective) usable = hn::And(usable, hn::Ge(distance, hn::Set(d, 1e-3 * plan.near)));
    const auto nowhere = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
    const auto inverse = plan.perspective ? hn::Div(hn::Set(d, 1.0), distance) : distance;
    hn::StoreU(inverse, d, z + i);
    hn::StoreU(hn::IfThenElse(usable, plan.perspective ? hn::Mul(across, inverse) : across, nowhere), d, u + i);
  }
  // Runs that go one way across the columns.
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= count; ++i) {
    const bool joined = i < count && !std::isnan(u[i]) && !std::isnan(u[i - 1]);
    const bool turns = joined && i - begin >= 2 && (u[i] > u[i - 1]) != (u[begin + 1] > u[begin]);
    if (joined && !turns) continue;
    if (i - begin >= 2) {
      Run run{u + begin, z + begin, i - begin, y0, y1, wall.slack};
      if (u[begin] > u[i - 1]) {
        std::reverse_copy(u + begin, u + i, left_u);
        std::reverse_copy(z + begin, z + i, left_z);
        run.u = left_u;
        run.z = left_z;
      }
      add_run(plan, run, rest);
    }
    begin = turns ? i - 1 : i;
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(hidden_simd);
HWY_EXPORT(boxes_over_horizon_simd);
HWY_EXPORT(add_fence_simd);

std::size_t boxes_over_horizon(const HorizonPlan& plan, const BoxArrays& boxes, std::size_t begin, std::size_t end,
                               const Frustum& frustum, float walls_to, HorizonBox* out, Counters& counters) {
  return HWY_DYNAMIC_DISPATCH(boxes_over_horizon_simd)(plan, boxes, begin, end, frustum, walls_to, out, counters);
}

bool hidden_by_horizon(const HorizonPlan& plan, const HorizonBox& box, Counters& counters) {
  return box.first <= box.last && HWY_DYNAMIC_DISPATCH(hidden_simd)(plan, box, counters);
}

void add_fence(const HorizonPlan& plan, std::span<const glm::dvec2> points, const HorizonWall& wall,
               std::vector<double>& scratch) {
  if (!points.empty()) HWY_DYNAMIC_DISPATCH(add_fence_simd)(plan, points, wall, scratch);
}

}  // namespace sightline
#endif
