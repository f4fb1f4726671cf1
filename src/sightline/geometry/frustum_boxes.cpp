#include "sightline/geometry/frustum_boxes.hpp"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/frustum_boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/geometry/lane_ids.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t at_a_time = 4;  // vectors of boxes, so that loading the planes costs a quarter

/// Where all boxes of a step lie outside of one of the first planes the others are skipped. An empty box, infinity to
/// -infinity, is -infinity or NaN from every plane.
template <int plane_count>
HWY_INLINE std::size_t test(const BoxArrays& boxes, std::size_t begin, std::size_t end, const Plane* planes,
                            std::uint32_t* ids) {
  const hn::CappedTag<float, 16> d;
  const std::size_t lanes = hn::Lanes(d);
  using V = hn::Vec<decltype(d)>;
  const float* corner[plane_count + 1][3];  // per plane the arrays that hold the p-vertex
  for (int p = 0; p < plane_count; ++p)
    for (int axis = 0; axis < 3; ++axis)
      corner[p][axis] = (planes[p].normal[axis] >= 0 ? boxes.hi : boxes.lo)[axis].data();
  // Of the boxes from i on to planes [first, last): the least distance, which decides for all of them.
  const auto least = [&](int first, int last, std::size_t i, V(&out)[at_a_time]) __attribute__((always_inline)) {
    for (int p = first; p < last; ++p) {
      const auto x = hn::Set(d, planes[p].normal.x), y = hn::Set(d, planes[p].normal.y),
                 z = hn::Set(d, planes[p].normal.z), offset = hn::Set(d, planes[p].offset);
      for (std::size_t k = 0; k < at_a_time; ++k) {
        const std::size_t at = i + k * lanes;
        const auto sum =
            hn::Add(hn::Add(hn::Mul(x, hn::LoadU(d, corner[p][0] + at)), hn::Mul(y, hn::LoadU(d, corner[p][1] + at))),
                    hn::Mul(z, hn::LoadU(d, corner[p][2] + at)));
        const auto distance = hn::Add(sum, offset);
        out[k] = p == first ? distance : hn::Min(out[k], distance);
      }
    }
  };
  constexpr int first_planes = plane_count < 3 ? plane_count : 3;
  std::size_t found = 0;
  for (std::size_t i = begin; i < end; i += at_a_time * lanes) {
    V in[at_a_time];  // >= 0 where the box is not outside
    if constexpr (plane_count == 0) {
      for (std::size_t k = 0; k < at_a_time; ++k)
        in[k] =
            hn::Sub(hn::LoadU(d, boxes.hi[0].data() + i + k * lanes), hn::LoadU(d, boxes.lo[0].data() + i + k * lanes));
    } else {
      least(0, first_planes, i, in);
    }
    if constexpr (plane_count > first_planes) {
      auto any = hn::Ge(in[0], hn::Zero(d));  // not the largest: that of a number and a NaN may be the NaN
      for (std::size_t k = 1; k < at_a_time; ++k) any = hn::Or(any, hn::Ge(in[k], hn::Zero(d)));
      if (hn::AllFalse(d, any)) continue;
      V others[at_a_time];
      least(first_planes, plane_count, i, others);
      for (std::size_t k = 0; k < at_a_time; ++k) in[k] = hn::Min(in[k], others[k]);
    }
    for (std::size_t k = 0; k < at_a_time; ++k)
      found += store_lane_ids(d, hn::Ge(in[k], hn::Zero(d)), i + k * lanes, ids + found);
  }
  while (found > 0 && ids[found - 1] >= end) --found;  // of the last step
  return found;
}

std::size_t boxes_in_frustum_simd(const BoxArrays& boxes, std::size_t begin, std::size_t end, const Plane* planes,
                                  int count, std::uint32_t* ids) {
  switch (count) {
    case 0:
      return test<0>(boxes, begin, end, planes, ids);
    case 1:
      return test<1>(boxes, begin, end, planes, ids);
    case 2:
      return test<2>(boxes, begin, end, planes, ids);
    case 3:
      return test<3>(boxes, begin, end, planes, ids);
    case 4:
      return test<4>(boxes, begin, end, planes, ids);
    case 5:
      return test<5>(boxes, begin, end, planes, ids);
    default:
      return test<6>(boxes, begin, end, planes, ids);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(boxes_in_frustum_simd);

BoxArrays::BoxArrays(std::span<const Aabb> boxes) : count(boxes.size()) {
  constexpr std::size_t padding = 64;  // a step of the widest vectors
  for (int axis = 0; axis < 3; ++axis) {
    // The padding is empty boxes, which no frustum holds.
    lo[axis].assign(count + padding, std::numeric_limits<float>::infinity());
    hi[axis].assign(count + padding, -std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
      if (boxes[i].empty()) continue;
      lo[axis][i] = boxes[i].lo[axis];
      hi[axis][i] = boxes[i].hi[axis];
    }
  }
}

std::size_t boxes_in_frustum(const BoxArrays& boxes, const Frustum& frustum, std::uint32_t* ids) {
  return HWY_DYNAMIC_DISPATCH(boxes_in_frustum_simd)(boxes, 0, boxes.count, frustum.planes.data(), frustum.count, ids);
}

std::size_t boxes_in_frustum(const BoxArrays& boxes, std::size_t begin, std::size_t end, const Frustum& frustum,
                             std::uint32_t planes, std::uint32_t* ids) {
  Plane chosen[6];
  int count = 0;
  for (int i = 0; i < frustum.count; ++i)
    if (((planes >> i) & 1u) != 0) chosen[count++] = frustum.planes[static_cast<std::size_t>(i)];
  return HWY_DYNAMIC_DISPATCH(boxes_in_frustum_simd)(boxes, begin, end, chosen, count, ids);
}

std::size_t boxes_in_frustum_scalar(const BoxArrays& boxes, const Frustum& frustum, std::uint32_t* ids) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < boxes.count; ++i) {
    const Aabb box{{boxes.lo[0][i], boxes.lo[1][i], boxes.lo[2][i]}, {boxes.hi[0][i], boxes.hi[1][i], boxes.hi[2][i]}};
    if (!box.empty() && classify(frustum, box) != Containment::outside) ids[found++] = static_cast<std::uint32_t>(i);
  }
  return found;
}

}  // namespace sightline
#endif
