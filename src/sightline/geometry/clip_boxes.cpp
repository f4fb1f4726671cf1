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

std::size_t boxes_in_clip_space_simd(const BoxArrays& boxes, const ClipRows& rows, std::uint32_t* ids) {
  const hn::CappedTag<float, 16> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t found = 0;
  for (std::size_t i = 0; i < boxes.count; i += lanes) {
    const auto half = hn::Set(d, 0.5f);
    const auto lx = hn::LoadU(d, boxes.lo[0].data() + i), hx = hn::LoadU(d, boxes.hi[0].data() + i);
    const auto ly = hn::LoadU(d, boxes.lo[1].data() + i), hy = hn::LoadU(d, boxes.hi[1].data() + i);
    const auto lz = hn::LoadU(d, boxes.lo[2].data() + i), hz = hn::LoadU(d, boxes.hi[2].data() + i);
    const auto cx = hn::Mul(half, hn::Add(lx, hx)), ex = hn::Mul(half, hn::Sub(hx, lx));
    const auto cy = hn::Mul(half, hn::Add(ly, hy)), ey = hn::Mul(half, hn::Sub(hy, ly));
    const auto cz = hn::Mul(half, hn::Add(lz, hz)), ez = hn::Mul(half, hn::Sub(hz, lz));
    const auto row = [&](int r) HWY_ATTR {
      const glm::vec4& v = rows.row[r];
      return hn::Add(hn::Add(hn::Mul(hn::Set(d, v.x), cx), hn::Mul(hn::Set(d, v.y), cy)),
                     hn::Add(hn::Mul(hn::Set(d, v.z), cz), hn::Set(d, v.w)));
    };
    const auto w = row(3);
    auto in = hn::Le(lx, hx);  // an empty box has lo > hi
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = row(axis);
      for (int side = 0; side < 2; ++side) {
        const glm::vec3& r = rows.radius[2 * axis + side];
        const auto radius = hn::Add(hn::Add(hn::Mul(hn::Set(d, r.x), ex), hn::Mul(hn::Set(d, r.y), ey)),
                                    hn::Add(hn::Mul(hn::Set(d, r.z), ez), hn::Set(d, rows.slack[2 * axis + side])));
        in = hn::And(in, hn::Ge(hn::Add(side == 0 ? hn::Add(w, at) : hn::Sub(w, at), radius), hn::Zero(d)));
      }
    }
    found += store_lane_ids(d, in, i, ids + found);
  }
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
