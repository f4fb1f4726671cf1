#include "sightline/geometry/clip_boxes.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/clip_boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/geometry/lane_ids.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t at_a_time = 4;  // vectors of boxes, so that loading the rows costs a quarter

/// Sums and differences of a box's ends stand for twice its centre and half extent: rows and radii are halved instead.
std::size_t boxes_in_clip_space_simd(const BoxArrays& boxes, const ClipRows& rows, std::uint32_t* ids) {
  const hn::CappedTag<float, 16> d;
  const std::size_t lanes = hn::Lanes(d);
  using V = hn::Vec<decltype(d)>;
  const auto zero = hn::Zero(d);
  std::size_t found = 0;
  for (std::size_t i = 0; i < boxes.count; i += at_a_time * lanes) {
    V sum[3][at_a_time], difference[3][at_a_time];
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t k = 0; k < at_a_time; ++k) {
        const auto lo = hn::LoadU(d, boxes.lo[axis].data() + i + k * lanes),
                   hi = hn::LoadU(d, boxes.hi[axis].data() + i + k * lanes);
        sum[axis][k] = hn::Add(lo, hi);
        difference[axis][k] = hn::Sub(hi, lo);
      }
    const auto row = [&](int r, V(&out)[at_a_time]) __attribute__((always_inline)) {
      const glm::vec4& v = rows.row[r];
      const auto x = hn::Set(d, 0.5f * v.x), y = hn::Set(d, 0.5f * v.y), z = hn::Set(d, 0.5f * v.z),
                 offset = hn::Set(d, v.w);
      for (std::size_t k = 0; k < at_a_time; ++k)
        out[k] = hn::Add(hn::Add(hn::Mul(x, sum[0][k]), hn::Mul(y, sum[1][k])), hn::Add(hn::Mul(z, sum[2][k]), offset));
    };
    // The least over the sides decides; an empty box, infinity to -infinity, is NaN or -infinity from every side.
    V w[at_a_time], at[at_a_time], least[at_a_time];
    row(3, w);
    for (int axis = 0; axis < 3; ++axis) {
      row(axis, at);
      for (int side = 0; side < 2; ++side) {
        const glm::vec3& r = rows.radius[2 * axis + side];
        const auto x = hn::Set(d, 0.5f * r.x), y = hn::Set(d, 0.5f * r.y), z = hn::Set(d, 0.5f * r.z),
                   slack = hn::Set(d, rows.slack[2 * axis + side]);
        for (std::size_t k = 0; k < at_a_time; ++k) {
          const auto radius = hn::Add(hn::Add(hn::Mul(x, difference[0][k]), hn::Mul(y, difference[1][k])),
                                      hn::Add(hn::Mul(z, difference[2][k]), slack));
          const auto inside = hn::Add(side == 0 ? hn::Add(w[k], at[k]) : hn::Sub(w[k], at[k]), radius);
          least[k] = axis == 0 && side == 0 ? inside : hn::Min(least[k], inside);
        }
      }
    }
    for (std::size_t k = 0; k < at_a_time; ++k)
      found += store_lane_ids(d, hn::Ge(least[k], zero), i + k * lanes, ids + found);
  }
  while (found > 0 && ids[found - 1] >= boxes.count) --found;  // of the last step
  return found;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(boxes_in_clip_space_simd);

Containment classify_in_clip_space(const Aabb& box, const glm::dmat4& view_projection) {
  if (box.empty()) return Containment::outside;
  int outside[6] = {}, inside = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 q = view_projection * glm::dvec4(glm::dvec3(box.corner(i)), 1.0);
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) {
      outside[2 * axis] += q[axis] < -q.w ? 1 : 0;
      outside[2 * axis + 1] += q[axis] > q.w ? 1 : 0;
      all = all && q[axis] >= -q.w && q[axis] <= q.w;
    }
    inside += all ? 1 : 0;
  }
  for (const int corners : outside)
    if (corners == 8) return Containment::outside;
  return inside == 8 ? Containment::inside : Containment::intersecting;
}

ClipRows clip_rows(const glm::dmat4& view_projection, double reach) {
  const glm::dmat4 rows = glm::transpose(view_projection);
  ClipRows result{};
  for (int r = 0; r < 4; ++r) result.row[r] = glm::vec4(rows[r]);
  const auto weight = [&](const glm::dvec4& row) {
    return (std::abs(row.x) + std::abs(row.y) + std::abs(row.z)) * reach + std::abs(row.w);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const glm::dvec3 sum = glm::dvec3(rows[3]) + (side == 0 ? 1.0 : -1.0) * glm::dvec3(rows[axis]);
      result.radius[2 * axis + side] = glm::vec3(glm::abs(sum));
      // Rounding of rows, centre, extents and some twenty operations on terms no larger than these.
      result.slack[2 * axis + side] = static_cast<float>(0x1p-20 * (weight(rows[3]) + weight(rows[axis])));
    }
  return result;
}

std::size_t boxes_in_clip_space(const BoxArrays& boxes, const ClipRows& rows, std::uint32_t* ids) {
  return HWY_DYNAMIC_DISPATCH(boxes_in_clip_space_simd)(boxes, rows, ids);
}

std::size_t boxes_in_clip_space_scalar(const BoxArrays& boxes, const ClipRows& rows, std::uint32_t* ids) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < boxes.count; ++i) {
    const glm::vec3 lo(boxes.lo[0][i], boxes.lo[1][i], boxes.lo[2][i]),
        hi(boxes.hi[0][i], boxes.hi[1][i], boxes.hi[2][i]);
    if (!(lo.x <= hi.x)) continue;
    const glm::vec3 c = 0.5f * (lo + hi), e = 0.5f * (hi - lo);
    const auto row = [&](int r) {
      const glm::vec4& v = rows.row[r];
      return (v.x * c.x + v.y * c.y) + (v.z * c.z + v.w);
    };
    const float w = row(3);
    bool in = true;
    for (int axis = 0; axis < 3; ++axis) {
      const float at = row(axis);
      for (int side = 0; side < 2; ++side) {
        const glm::vec3& r = rows.radius[2 * axis + side];
        const float radius = (r.x * e.x + r.y * e.y) + (r.z * e.z + rows.slack[2 * axis + side]);
        in = in && (side == 0 ? w + at : w - at) + radius >= 0.0f;
      }
    }
    if (in) ids[found++] = static_cast<std::uint32_t>(i);
  }
  return found;
}

}  // namespace sightline
#endif
