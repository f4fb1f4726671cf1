// Builders of the binary hierarchy of bvh.hpp, as peers (checklist 13.15): by extent, by density, by surface area,
// along a space-filling curve. Every box becomes an item once; boxes may be empty, else they are finite. None recurses.
// All give the same tree for any number of threads and every SIMD target.
#pragma once

#include <span>

#include "sightline/index/bvh.hpp"

namespace sightline {

struct BvhBuildConfig {
  int max_leaf_size = 4;   // boxes, 1 to 255
  float node_cost = 1.0f;  // of visiting a node, in tests of an item; 0 or more; only where areas are compared
};

/// By extent: the middle of the longest side, by centroids; halves the count where all fall on one side.
Bvh build_bvh_extent(std::span<const Aabb> boxes, const BvhBuildConfig& config = {});

/// By density: the median centroid along the axis in which centroids are spread widest.
Bvh build_bvh_median(std::span<const Aabb> boxes, const BvhBuildConfig& config = {});

/// Binned surface area heuristic (Wald 2007), with leaves where they are cheaper than a split.
Bvh build_bvh_sah(std::span<const Aabb> boxes, const BvhBuildConfig& config = {});

/// Linear: sorted along a Morton curve, split where its bits change (Lauterbach et al. 2009); the tree above groups of
/// a few dozen boxes by surface area (Pantaleoni and Luebke 2010).
Bvh build_bvh_linear(std::span<const Aabb> boxes, const BvhBuildConfig& config = {});

}  // namespace sightline
