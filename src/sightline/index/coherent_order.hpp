// An order in which neighbouring segments start and end near each other, so that tracing them one after the other finds
// the same nodes in the cache and the same occluders.
#pragma once

#include <span>
#include <vector>

#include "sightline/geometry/aabb.hpp"

namespace sightline {

struct Segment;

/// Indices of the segments by octant and largest axis of their direction, then along a Morton curve through the six
/// coordinates of their ends (four bits each) within the bounds; equal ones keep their order. Ends that are not finite
/// go anywhere. Empty if most neighbours would still be far apart, so that the order would not pay.
std::vector<std::uint32_t> coherent_order(const Aabb& bounds, std::span<const Segment> segments);

}  // namespace sightline
