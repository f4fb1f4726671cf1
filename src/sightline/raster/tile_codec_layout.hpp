// The bytes of a packed depth tile, for its encoder and decoders. Internal to raster/.
// Header: 8 widths of 4 bits, then what the mode predicts from. Then the rows: row r takes width[r] bytes, pixel i of
// it `width` bits from bit i * width on: a residual with sign. A raw tile is its 64 codes of 24 bits.
//   plane:        predictor
//   two planes:   predictor, 8 bytes of mask (bit set: second plane), predictor
//   second order: z (3 bytes), slope of the first row, first step down, slope of the steps (2 bytes each)
//   mixed:        z (3 bytes), first steps right and down (2 bytes each), their changes, twist (1 byte each)
#pragma once

#include <cstdint>
#include <cstring>

namespace sightline::raster::tile_layout {

inline constexpr int widths = 16;  // of a residual: 0 to 15 bits
inline constexpr std::size_t header = 4, predictor = 10, mask = 8, second_order = 9, mixed = 10;
inline constexpr int fraction_bits = 8;  // of a plane's numbers
inline constexpr int slope_bits = 2;     // fractional bits of the slopes of second order

/// z at the first pixel (32 bits) and slopes (24 bits with sign), with fractions; arithmetic is modulo 2^32.
struct Plane {
  std::uint32_t z;
  std::int32_t dx, dy;
  [[nodiscard]] std::int32_t at(int x, int y) const {
    return static_cast<std::int32_t>((z + static_cast<std::uint32_t>(x * dx + y * dy)) >> fraction_bits);
  }
};

/// Row 0 is z + i * slope, the step from row 0 to row 1 is step + i * step_slope; then steps stay as they are.
struct SecondOrder {
  std::int32_t z, slope, step, step_slope;
};

/// Mixed differences z(x, y) - z(x - 1, y) - z(x, y - 1) + z(x - 1, y - 1), with 0 beyond the tile: z at its first
/// pixel, right + (x - 1) * bend_x along the first row, down + (y - 1) * bend_y along the first column, twist inside.
struct Mixed {
  std::int32_t z, right, down, bend_x, bend_y, twist;
  [[nodiscard]] std::int32_t at(int x, int y) const {
    if (x > 0 && y > 0) return twist;
    if (x > 0) return right + (x - 1) * bend_x;
    return y > 0 ? down + (y - 1) * bend_y : z;
  }
};

/// A number with sign in 1 to 4 bytes, lowest first. Looks at four bytes.
template <std::size_t Bytes>
std::int32_t read(const std::uint8_t* p) {
  std::uint32_t v = 0;
  std::memcpy(&v, p, sizeof v);
  constexpr int spare = 32 - 8 * static_cast<int>(Bytes);
  return static_cast<std::int32_t>(v << spare) >> spare;
}
template <std::size_t Bytes>
void write(std::uint8_t* p, std::int32_t v) {
  for (std::size_t i = 0; i < Bytes; ++i) p[i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(v) >> (8 * i));
}

inline Plane read_plane(const std::uint8_t* p) {
  return {static_cast<std::uint32_t>(read<4>(p)), read<3>(p + 4), read<3>(p + 7)};
}
inline void write_plane(std::uint8_t* p, const Plane& v) {
  write<4>(p, static_cast<std::int32_t>(v.z));
  write<3>(p + 4, v.dx);
  write<3>(p + 7, v.dy);
}
inline SecondOrder read_second_order(const std::uint8_t* p) {
  return {read<3>(p) & 0xFFFFFF, read<2>(p + 3), read<2>(p + 5), read<2>(p + 7)};
}
inline void write_second_order(std::uint8_t* p, const SecondOrder& v) {
  write<3>(p, v.z);
  write<2>(p + 3, v.slope);
  write<2>(p + 5, v.step);
  write<2>(p + 7, v.step_slope);
}
inline Mixed read_mixed(const std::uint8_t* p) {
  return {read<3>(p) & 0xFFFFFF, read<2>(p + 3), read<2>(p + 5), read<1>(p + 7), read<1>(p + 8), read<1>(p + 9)};
}
inline void write_mixed(std::uint8_t* p, const Mixed& v) {
  write<3>(p, v.z);
  write<2>(p + 3, v.right);
  write<2>(p + 5, v.down);
  write<1>(p + 7, v.bend_x);
  write<1>(p + 8, v.bend_y);
  write<1>(p + 9, v.twist);
}

inline int width_of(std::uint32_t header_word, int row) { return static_cast<int>((header_word >> (4 * row)) & 15); }

}  // namespace sightline::raster::tile_layout
