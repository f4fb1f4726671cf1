#include "sightline/geometry/frustum_boxes.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/frustum_boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

std::size_t boxes_in_frustum_simd(const BoxArrays& boxes, const Frustum& frustum, std::uint32_t* ids) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  const float* corner[6][3];  // per plane the arrays that hold the p-vertex
  for (int p = 0; p < frustum.count; ++p)
    for (int axis = 0; axis < 3; ++axis) {
      const bool positive = frustum.planes[static_cast<std::size_t>(p)].normal[axis] >= 0;
      corner[p][axis] = (positive ? boxes.hi : boxes.lo)[axis].data();
    }
  std::size_t found = 0;
  for (std::size_t i = 0; i < boxes.count; i += lanes) {
    // An empty box has lo > hi.
    auto in = hn::Le(hn::LoadU(d, boxes.lo[0].data() + i), hn::LoadU(d, boxes.hi[0].data() + i));
    for (int p = 0; p < frustum.count; ++p) {
      const Plane& plane = frustum.planes[static_cast<std::size_t>(p)];
      const auto x = hn::Mul(hn::Set(d, plane.normal.x), hn::LoadU(d, corner[p][0] + i));
      const auto y = hn::Mul(hn::Set(d, plane.normal.y), hn::LoadU(d, corner[p][1] + i));
      const auto z = hn::Mul(hn::Set(d, plane.normal.z), hn::LoadU(d, corner[p][2] + i));
      const auto distance = hn::Add(hn::Add(hn::Add(x, y), z), hn::Set(d, plane.offset));
      in = hn::And(in, hn::Ge(distance, hn::Zero(d)));
    }
    const auto id = hn::Iota(du, static_cast<std::uint32_t>(i));
    found += hn::CompressStore(id, hn::RebindMask(du, in), du, ids + found);
  }
  return found;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(boxes_in_frustum_simd);

BoxArrays::BoxArrays(std::span<const Aabb> boxes) : count(boxes.size()) {
  constexpr std::size_t padding = 16;
  for (int axis = 0; axis < 3; ++axis) {
    // The padding is empty boxes, which no frustum holds.
    lo[axis].assign(count + padding, std::numeric_limits<float>::infinity());
    hi[axis].assign(count + padding, -std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
      lo[axis][i] = boxes[i].lo[axis];
      hi[axis][i] = boxes[i].hi[axis];
    }
  }
}

std::size_t boxes_in_frustum(const BoxArrays& boxes, const Frustum& frustum, std::uint32_t* ids) {
  return HWY_DYNAMIC_DISPATCH(boxes_in_frustum_simd)(boxes, frustum, ids);
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
