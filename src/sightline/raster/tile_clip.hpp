// The slow path of the tile rasteriser: triangles that cross the near or far plane or the guard band are clipped in
// double precision. Corners that stay keep their projected floats, so that no crack opens towards neighbours.
#pragma once

#include "sightline/raster/tile_kernels.hpp"

namespace sightline::raster {

/// Clips the triangle with corners a, b, c of `in` and writes the remaining convex polygon into `out` from index 0.
/// Returns the number of its corners, 0 or 3 to 9.
std::size_t clip_triangle(const VertexBuffer& in, std::size_t a, std::size_t b, std::size_t c, const MeshTransform&,
                          VertexBuffer& out);

}  // namespace sightline::raster
