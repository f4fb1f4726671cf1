// The bytes of a packed depth tile, for its encoder and decoders. Internal to raster/.
// Header: 8 widths of 4 bits; then for each predictor z (3 bytes) and two slopes (3 bytes each, 2 fractional bits);
// two planes: 8 bytes of mask after the first. Then the rows: row r takes width[r] bytes, pixel i its bits from i *
// width. A residual v is stored as v + 2^(width-1), so that all are >= 0.
#pragma once

#include <cstdint>
#include <cstring>

namespace sightline::raster::tile_layout {

inline constexpr int most_width = 15;    // bits of a residual
inline constexpr int fraction_bits = 2;  // of slopes
inline constexpr std::size_t widths = 4, predictor = 9, mask = 8;
inline constexpr std::int32_t largest_slope = (1 << 23) - 1;

struct Predictor {
  std::int32_t z, dx, dy;
  [[nodiscard]] std::int32_t at(int x, int y) const { return z + ((x * dx + y * dy) >> fraction_bits); }
};

inline std::int32_t read24(const std::uint8_t* p) {  // signed
  std::uint32_t v = p[0] | (std::uint32_t{p[1]} << 8) | (std::uint32_t{p[2]} << 16);
  return static_cast<std::int32_t>(v << 8) >> 8;
}
inline void write24(std::uint8_t* p, std::int32_t v) {
  for (int i = 0; i < 3; ++i) p[i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(v) >> (8 * i));
}
/// z is unsigned, slopes are signed.
inline Predictor read_predictor(const std::uint8_t* p) { return {read24(p) & 0xFFFFFF, read24(p + 3), read24(p + 6)}; }
inline int width_of(const std::uint8_t* bytes, int row) { return (bytes[row / 2] >> (4 * (row & 1))) & 15; }
/// The four pixels of half a row, each `width` bits from bit 0 on.
inline std::uint64_t half_row(const std::uint8_t* row, int width, int half) {
  std::uint64_t word = 0;
  std::memcpy(&word, row + (half != 0 ? width >> 1 : 0), sizeof word);
  return half != 0 ? word >> ((4 * width) & 7) : word;
}
inline std::int32_t bias_of(int width) { return width > 0 ? 1 << (width - 1) : 0; }

}  // namespace sightline::raster::tile_layout
