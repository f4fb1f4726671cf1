#include "sightline/geometry/frustum_boxes.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/frustum_boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The planes are loaded once; whole vectors of boxes outside of one plane skip the others.
template <int plane_count>
HWY_INLINE std::size_t test(const BoxArrays& boxes, std::size_t begin, std::size_t end, const Plane* planes,
                            std::uint32_t* ids) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  const float* corner[plane_count + 1][3];  // per plane the arrays that hold the p-vertex
  for (int p = 0; p < plane_count; ++p)
    for (int axis = 0; axis < 3; ++axis)
      corner[p][axis] = (planes[p].normal[axis] >= 0 ? boxes.hi : boxes.lo)[axis].data();
  const auto distance = [&](int p, std::size_t i) __attribute__((always_inline)) {
    const auto x = hn::Mul(hn::Set(d, planes[p].normal.x), hn::LoadU(d, corner[p][0] + i));
    const auto y = hn::Mul(hn::Set(d, planes[p].normal.y), hn::LoadU(d, corner[p][1] + i));
    const auto z = hn::Mul(hn::Set(d, planes[p].normal.z), hn::LoadU(d, corner[p][2] + i));
    return hn::Add(hn::Add(hn::Add(x, y), z), hn::Set(d, planes[p].offset));
  };
  std::size_t found = 0;
  for (std::size_t i = begin; i < end; i += lanes) {
    // BoxArrays makes lo > hi on every axis of an empty box.
    auto in = hn::Le(hn::LoadU(d, boxes.lo[0].data() + i), hn::LoadU(d, boxes.hi[0].data() + i));
    if (end - i < lanes) in = hn::And(in, hn::FirstN(d, end - i));
    if constexpr (plane_count > 0) {
      // The least distance decides for several planes at once.
      constexpr int first = plane_count < 3 ? plane_count : 3;
      auto least = distance(0, i);
      for (int p = 1; p < first; ++p) least = hn::Min(least, distance(p, i));
      in = hn::And(in, hn::Ge(least, hn::Zero(d)));
      if constexpr (plane_count > first) {
        if (hn::AllFalse(d, in)) continue;
        least = distance(first, i);
        for (int p = first + 1; p < plane_count; ++p) least = hn::Min(least, distance(p, i));
        in = hn::And(in, hn::Ge(least, hn::Zero(d)));
      }
    }
    const auto id = hn::Iota(du, static_cast<std::uint32_t>(i));
    found += hn::CompressStore(id, hn::RebindMask(du, in), du, ids + found);
  }
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
  constexpr std::size_t padding = 16;
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
