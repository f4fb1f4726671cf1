// Further builders of the binary hierarchy of bvh.hpp, as peers (checklist 13.15): by extent, by density, along a
// space-filling curve; by surface area stands there. Every box becomes an item once; boxes may be empty, else they are
// finite. None recurses. All give the same tree for any number of threads and every SIMD target.
#pragma once

#include <span>

#include "sightline/index/bvh.hpp"

namespace sightline {

/// By extent: the middle of the longest side, by centroids; halves the count where all fall on one side.
Bvh build_bvh_extent(std::span<const Aabb> boxes, const BvhConfig& config = {});

/// By density: the median centroid along the axis in which centroids are spread widest.
Bvh build_bvh_median(std::span<const Aabb> boxes, const BvhConfig& config = {});

/// Linear: sorted along a Morton curve, split where its bits change (Lauterbach et al. 2009); the tree above groups of
/// a few dozen boxes by surface area (Pantaleoni and Luebke 2010).
Bvh build_bvh_linear(std::span<const Aabb> boxes, const BvhConfig& config = {});

}  // namespace sightline
