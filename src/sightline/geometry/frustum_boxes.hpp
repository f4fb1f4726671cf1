// Many boxes against the planes of a frustum at once: bounds as arrays, one per coordinate, tested by p-vertices in
// SIMD (Highway, best target of the machine) or one by one (the reference). Both give the answers of classify() bit by
// bit (checklist 20.14).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/frustum.hpp"

namespace sightline {

/// Bounds of boxes 0 .. count-1, padded so that kernels may read whole vectors; empty boxes are outside of everything.
struct BoxArrays {
  explicit BoxArrays(std::span<const Aabb> boxes);
  std::size_t count;
  std::vector<float> lo[3], hi[3];
};

/// Indices of the boxes that are not outside of one plane, ascending, into `ids`, which must hold count + 64. Returns
/// how many. Conservative as classify() is.
std::size_t boxes_in_frustum(const BoxArrays& boxes, const Frustum& frustum, std::uint32_t* ids);
std::size_t boxes_in_frustum_scalar(const BoxArrays& boxes, const Frustum& frustum, std::uint32_t* ids);

/// The same for boxes [begin, end) and the planes of a bit mask alone; `ids` must hold end - begin + 64.
std::size_t boxes_in_frustum(const BoxArrays& boxes, std::size_t begin, std::size_t end, const Frustum& frustum,
                             std::uint32_t planes, std::uint32_t* ids);

}  // namespace sightline
