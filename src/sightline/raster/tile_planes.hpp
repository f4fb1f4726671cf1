// Planes for the encoder of depth tiles: the best one for some of the pixels, and which pixels belong together. Sets of
// pixels are 64 bits, row by row. Internal to raster/.
#pragma once

#include "sightline/raster/tile_codec.hpp"
#include "sightline/raster/tile_codec_layout.hpp"

namespace sightline::raster::tile_planes {

inline bool has(std::uint64_t members, std::size_t i) { return ((members >> i) & 1) != 0; }

/// The plane for the pixels of `members` (not empty): least squares, then tilted towards the smallest range of
/// residuals (codes of a flat surface are rounded, so a range below one means that no residual is left), and centred on
/// it.
tile_layout::Plane fit(const DepthTile& tile, std::uint64_t members);

/// Pixels beyond the largest gap between neighbouring depths; 0 if there is but one depth.
std::uint64_t far_side(const DepthTile& tile);

/// Moves pixels to that of two planes which is nearer to them, until that changes nothing (k-means with planes): those
/// of the second plane, which begins with `second`; 0 if one plane takes all.
std::uint64_t settled(const DepthTile& tile, std::uint64_t second);

}  // namespace sightline::raster::tile_planes
