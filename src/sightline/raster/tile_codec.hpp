// Lossless compression of 8 x 8 depth tiles of 24 bits (checklist 5.09, 5.14 with E7): first- and second-order DPCM as
// measures, and a format with a fast decoder that predicts by one plane, by two planes and a mask (silhouettes,
// creases), or for curved surfaces by second differences down the rows or along them, or by mixed differences; with a
// width of the residuals for each row.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sightline::raster {

/// Row by row; codes below 2^24.
using DepthTile = std::array<std::uint32_t, 64>;
inline constexpr std::size_t raw_tile_bytes = 192;  // 64 x 24 bits

/// second_order_turned is second_order on the tile with rows and columns exchanged; mixed (on such a tile, too) is the
/// difference along the rows of the difference down the columns.
enum class TileMode : std::uint8_t { plane, two_planes, second_order, second_order_turned, mixed, raw };
inline constexpr std::size_t tile_modes = 6;

/// What a decoder looks at first is in one cache line.
struct alignas(64) PackedTile {
  TileMode mode;
  std::uint8_t size;                                    // bytes in use; raw_tile_bytes if nothing helps
  std::array<std::uint8_t, raw_tile_bytes + 32> bytes;  // some room for loads beyond the end
};

/// The smallest of the modes. decode(encode(t)) == t for every t.
PackedTile encode_tile(const DepthTile& tile);
/// Stored as it is.
PackedTile raw_tile(const DepthTile& tile);
void decode_tile(const PackedTile& packed, DepthTile& tile);
/// `count` tiles at once, faster than one by one: those of one mode follow each other, so branches are foreseen.
void decode_tiles(const PackedTile* packed, std::size_t count, DepthTile* tiles);
/// The same without SIMD: the reference.
void decode_tile_scalar(const PackedTile& packed, DepthTile& tile);

/// Size in bytes if the tile is stored by first-order DPCM (differences to the left neighbour, first column to the
/// pixel above), or by second-order DPCM that is anchored at its first pixel and two differences; one residual width
/// for the tile.
std::size_t dpcm_first_order_bytes(const DepthTile& tile);
std::size_t dpcm_second_order_bytes(const DepthTile& tile);

}  // namespace sightline::raster
