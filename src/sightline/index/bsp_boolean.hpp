// Union, intersection and difference of closed solids by BSP trees (Thibault and Naylor 1987; checklist 15.12).
// Promise: the polygons of the result bound the solid up to the trees' tolerance, normals outwards, faces that coincide
// once; they may meet at T-junctions.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/index/bsp.hpp"

namespace sightline {

enum class BooleanOp { unite, intersect, subtract };

/// Polygon i of `polygons` is a part of polygon source[i] of the first (from_second[i] == 0) or second solid.
struct BooleanResult {
  PolygonSet polygons;
  std::vector<std::uint32_t> source;
  std::vector<char> from_second;
};

/// Both must bound closed solids with outward normals; an empty set is the empty solid.
BooleanResult boolean_of(const PolygonSet& a, const PolygonSet& b, BooleanOp op, const BspConfig& config = {});

/// The volume within closed, outward polygons, by the divergence theorem.
double enclosed_volume(const PolygonSet& polygons);

}  // namespace sightline
