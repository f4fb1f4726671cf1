#include "sightline/raster/tile_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "sightline/raster/tile_codec_layout.hpp"
#include "sightline/raster/tile_planes.hpp"

namespace sightline::raster {
namespace {

using tile_layout::Mixed;
using tile_layout::Plane;
using tile_layout::SecondOrder;
using tile_planes::has;
using Residuals = std::array<std::int64_t, 64>;

/// Bits that hold v with its sign.
int bits_for(std::int64_t v) {
  if (v == 0) return 0;
  return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(v < 0 ? -v - 1 : v))) + 1;
}

bool fits(std::int64_t v, int bits) { return bits_for(v) <= bits; }

std::size_t whole_bytes(std::size_t bits) { return (bits + 7) / 8; }

DepthTile turned(const DepthTile& tile) {
  DepthTile result;
  for (std::size_t i = 0; i < 64; ++i) result[i % 8 * 8 + i / 8] = tile[i];
  return result;
}

// ---- rows of residuals

void write_row(std::uint8_t* row, int width, const std::int64_t* values) {
  for (int i = 0; i < 8; ++i) {
    const int bit = i * width;
    std::uint32_t word = 0;
    std::memcpy(&word, row + bit / 8, sizeof word);
    word |= (static_cast<std::uint32_t>(values[i]) & ((1u << width) - 1)) << (bit % 8);
    std::memcpy(row + bit / 8, &word, sizeof word);
  }
}

std::int32_t read_field(const std::uint8_t* row, int width, int i) {
  if (width == 0) return 0;
  std::uint32_t word = 0;
  std::memcpy(&word, row + i * width / 8, sizeof word);
  return static_cast<std::int32_t>(word << (32 - width - i * width % 8)) >> (32 - width);
}

/// Writes the header and the residuals after `used` bytes of prediction; false if nothing is gained.
bool finish(const Residuals& residuals, std::size_t used, TileMode mode, PackedTile& out) {
  std::uint32_t header = 0;
  std::size_t size = tile_layout::header + used;
  for (std::size_t row = 0; row < 8; ++row) {
    int bits = 0;
    for (std::size_t i = 0; i < 8; ++i) bits = std::max(bits, bits_for(residuals[8 * row + i]));
    if (bits >= tile_layout::widths) return false;
    header |= static_cast<std::uint32_t>(bits) << (4 * row);
    size += static_cast<std::size_t>(bits);
  }
  if (size >= raw_tile_bytes) return false;
  tile_layout::write<4>(out.bytes.data(), static_cast<std::int32_t>(header));
  std::uint8_t* p = out.bytes.data() + tile_layout::header + used;
  std::fill(p, out.bytes.data() + out.bytes.size(), std::uint8_t{0});
  for (int row = 0; row < 8; ++row) {
    const int width = tile_layout::width_of(header, row);
    write_row(p, width, residuals.data() + static_cast<std::ptrdiff_t>(8 * row));
    p += width;
  }
  out.size = static_cast<std::uint8_t>(size);
  out.mode = mode;
  return true;
}

// ---- planes

bool encode_planes(const DepthTile& tile, std::uint64_t second, PackedTile& out) {
  const bool two = second != 0;
  const Plane first_plane = tile_planes::fit(tile, ~second),
              second_plane = two ? tile_planes::fit(tile, second) : first_plane;
  Residuals residuals;
  for (std::size_t i = 0; i < 64; ++i) {
    const Plane& p = has(second, i) ? second_plane : first_plane;
    residuals[i] = static_cast<std::int64_t>(tile[i]) - p.at(static_cast<int>(i % 8), static_cast<int>(i / 8));
  }
  std::uint8_t* at = out.bytes.data() + tile_layout::header;
  tile_layout::write_plane(at, first_plane);
  if (!two) return finish(residuals, tile_layout::predictor, TileMode::plane, out);
  std::memcpy(at + tile_layout::predictor, &second, sizeof second);
  tile_layout::write_plane(at + tile_layout::predictor + tile_layout::mask, second_plane);
  return finish(residuals, 2 * tile_layout::predictor + tile_layout::mask, TileMode::two_planes, out);
}

// ---- differences

/// Coefficient and constant of the line through v(first..last) by least squares, so that v(i) ~ constant + i * slope.
template <class Value>
std::array<double, 2> line(std::size_t first, std::size_t last, Value&& v) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = first; i <= last; ++i) {
    const auto x = static_cast<double>(i), y = static_cast<double>(v(i));
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double slope = (sxy - sx * sy / n) / (sxx - sx * sx / n);
  return {(sy - slope * sx) / n, slope};
}

/// Half way between the least and the greatest of v(first..last).
template <class Value>
std::int64_t middle(std::size_t first, std::size_t last, Value&& v) {
  std::int64_t least = INT64_MAX, most = INT64_MIN;
  for (std::size_t i = first; i <= last; ++i) {
    least = std::min<std::int64_t>(least, v(i));
    most = std::max<std::int64_t>(most, v(i));
  }
  return (least + most + 1) >> 1;
}

bool encode_second_order(const DepthTile& tile, TileMode mode, PackedTile& out) {
  const auto value = [&](std::size_t row, std::size_t i) { return static_cast<std::int64_t>(tile[8 * row + i]); };
  const auto step = [&](std::size_t i) { return value(1, i) - value(0, i); };
  constexpr double one = 1 << tile_layout::slope_bits;
  const auto slope = std::llround(line(0, 7, [&](std::size_t i) { return value(0, i); })[1] * one);
  const auto step_slope = std::llround(line(0, 7, step)[1] * one);
  const auto along = [](std::int64_t s, std::size_t i) {
    return (s * static_cast<std::int64_t>(i)) >> tile_layout::slope_bits;
  };
  const std::int64_t z = middle(0, 7, [&](std::size_t i) { return value(0, i) - along(slope, i); });
  const std::int64_t first = middle(0, 7, [&](std::size_t i) { return step(i) - along(step_slope, i); });
  if (!fits(slope, 16) || !fits(step_slope, 16) || !fits(first, 16) || z < 0 || z > 0xFFFFFF) return false;
  Residuals residuals;
  for (std::size_t i = 0; i < 8; ++i) {
    residuals[i] = value(0, i) - z - along(slope, i);
    residuals[8 + i] = step(i) - first - along(step_slope, i);
  }
  for (std::size_t row = 2; row < 8; ++row)
    for (std::size_t i = 0; i < 8; ++i)
      residuals[8 * row + i] = value(row, i) - 2 * value(row - 1, i) + value(row - 2, i);
  tile_layout::write_second_order(out.bytes.data() + tile_layout::header,
                                  {static_cast<std::int32_t>(z), static_cast<std::int32_t>(slope),
                                   static_cast<std::int32_t>(first), static_cast<std::int32_t>(step_slope)});
  return finish(residuals, tile_layout::second_order, mode, out);
}

bool encode_mixed(const DepthTile& tile, PackedTile& out) {
  std::array<std::int64_t, 64> difference;
  const auto value = [&](std::size_t x, std::size_t y) { return static_cast<std::int64_t>(tile[8 * y + x]); };
  for (std::size_t y = 0; y < 8; ++y)
    for (std::size_t x = 0; x < 8; ++x)
      difference[8 * y + x] = value(x, y) - (x > 0 ? value(x - 1, y) : 0) - (y > 0 ? value(x, y - 1) : 0) +
                              (x > 0 && y > 0 ? value(x - 1, y - 1) : 0);
  const auto right = [&](std::size_t x) { return difference[x]; };
  const auto down = [&](std::size_t y) { return difference[8 * y]; };
  const auto bend = [](double v) { return std::llround(std::clamp(v, -128.0, 127.0)); };
  const std::int64_t bend_x = bend(line(1, 7, right)[1]), bend_y = bend(line(1, 7, down)[1]);
  const auto index = [](std::size_t i) { return static_cast<std::int64_t>(i) - 1; };
  const std::int64_t first_right = middle(1, 7, [&](std::size_t x) { return right(x) - index(x) * bend_x; });
  const std::int64_t first_down = middle(1, 7, [&](std::size_t y) { return down(y) - index(y) * bend_y; });
  std::array<std::int64_t, 49> inner;
  for (std::size_t i = 0; i < 49; ++i) inner[i] = difference[8 * (i / 7 + 1) + i % 7 + 1];
  std::nth_element(inner.begin(), inner.begin() + 24, inner.end());
  const std::int64_t twist = inner[24];  // the median
  if (!fits(first_right, 16) || !fits(first_down, 16) || !fits(twist, 8)) return false;
  const Mixed m{static_cast<std::int32_t>(tile[0]),    static_cast<std::int32_t>(first_right),
                static_cast<std::int32_t>(first_down), static_cast<std::int32_t>(bend_x),
                static_cast<std::int32_t>(bend_y),     static_cast<std::int32_t>(twist)};
  Residuals residuals;
  for (std::size_t i = 0; i < 64; ++i)
    residuals[i] = difference[i] - m.at(static_cast<int>(i % 8), static_cast<int>(i / 8));
  tile_layout::write_mixed(out.bytes.data() + tile_layout::header, m);
  return finish(residuals, tile_layout::mixed, TileMode::mixed, out);
}

/// Tiles of which a sixth is left are not worth the search for two planes.
constexpr std::size_t good_enough = raw_tile_bytes / 6;

}  // namespace

PackedTile raw_tile(const DepthTile& tile) {
  PackedTile raw{};
  for (std::size_t i = 0; i < 64; ++i)
    tile_layout::write<3>(raw.bytes.data() + 3 * i, static_cast<std::int32_t>(tile[i]));
  raw.size = raw_tile_bytes;
  raw.mode = TileMode::raw;
  return raw;
}

PackedTile encode_tile(const DepthTile& tile) {
  PackedTile best = raw_tile(tile), trial{};
  const auto keep_smaller = [&](bool gains) {
    if (gains && trial.size < best.size) best = trial;
  };
  keep_smaller(encode_planes(tile, 0, trial));
  keep_smaller(encode_second_order(tile, TileMode::second_order, trial));
  keep_smaller(encode_second_order(turned(tile), TileMode::second_order_turned, trial));
  keep_smaller(encode_mixed(turned(tile), trial));
  if (best.size <= good_enough) return best;
  // Two planes: what the largest gap divides, and what comes of halves and of the two sides of the diagonals.
  const std::uint64_t far = tile_planes::far_side(tile);
  if (far == 0) return best;
  keep_smaller(encode_planes(tile, far, trial));
  for (const std::uint64_t start :
       {far, 0xF0F0F0F0F0F0F0F0u, 0xFFFFFFFF00000000u, 0xFEFCF8F0E0C08000u, 0x7F3F1F0F07030100u}) {
    const std::uint64_t second = tile_planes::settled(tile, start);
    if (second != 0 && second != far) keep_smaller(encode_planes(tile, second, trial));
  }
  return best;
}

void decode_tile_scalar(const PackedTile& packed, DepthTile& tile) {
  const std::uint8_t* bytes = packed.bytes.data();
  if (packed.mode == TileMode::raw) {
    for (std::size_t i = 0; i < 64; ++i)
      tile[i] = static_cast<std::uint32_t>(tile_layout::read<3>(bytes + 3 * i)) & 0xFFFFFF;
    return;
  }
  const auto header = static_cast<std::uint32_t>(tile_layout::read<4>(bytes));
  const std::uint8_t* p = bytes + tile_layout::header;
  const bool planes = packed.mode == TileMode::plane || packed.mode == TileMode::two_planes;
  Plane first{}, second{};
  std::uint64_t members = 0;
  SecondOrder order{};
  Mixed mixed{};
  if (planes) {
    first = tile_layout::read_plane(p);
    p += tile_layout::predictor;
    if (packed.mode == TileMode::two_planes) {
      std::memcpy(&members, p, sizeof members);
      second = tile_layout::read_plane(p + tile_layout::mask);
      p += tile_layout::mask + tile_layout::predictor;
    }
  } else if (packed.mode == TileMode::mixed) {
    mixed = tile_layout::read_mixed(p);
    p += tile_layout::mixed;
  } else {
    order = tile_layout::read_second_order(p);
    p += tile_layout::second_order;
  }
  for (int y = 0; y < 8; ++y) {
    const int width = tile_layout::width_of(header, y);
    for (int x = 0; x < 8; ++x) {
      const auto at = static_cast<std::size_t>(8 * y + x);
      const auto before = [&](int dx, int dy) {
        return x < dx || y < dy ? 0 : static_cast<std::int32_t>(tile[at - static_cast<std::size_t>(8 * dy + dx)]);
      };
      std::int32_t value = read_field(p, width, x);
      if (planes)
        value += (has(members, at) ? second : first).at(x, y);
      else if (packed.mode == TileMode::mixed)
        value += mixed.at(x, y) + before(1, 0) + before(0, 1) - before(1, 1);
      else if (y == 0)
        value += order.z + ((x * order.slope) >> tile_layout::slope_bits);
      else if (y == 1)
        value += before(0, 1) + order.step + ((x * order.step_slope) >> tile_layout::slope_bits);
      else
        value += 2 * before(0, 1) - before(0, 2);
      tile[at] = static_cast<std::uint32_t>(value);
    }
    p += width;
  }
  if (packed.mode == TileMode::second_order_turned || packed.mode == TileMode::mixed) tile = turned(tile);
}

std::size_t dpcm_first_order_bytes(const DepthTile& tile) {
  int width = 0;
  for (std::size_t i = 1; i < 64; ++i) {
    const std::size_t before = i % 8 == 0 ? i - 8 : i - 1;
    width = std::max(width, bits_for(static_cast<std::int64_t>(tile[i]) - tile[before]));
  }
  return std::min(raw_tile_bytes, whole_bytes(24 + 5 + 63 * static_cast<std::size_t>(width)));
}

std::size_t dpcm_second_order_bytes(const DepthTile& tile) {
  const auto z = [&](std::size_t i) { return static_cast<std::int64_t>(tile[i]); };
  int width = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    const std::size_t x = i % 8, y = i / 8;
    std::int64_t predicted = 0;
    if (i == 0 || i == 1 || i == 8) continue;  // the anchor and its two differences
    if (x >= 2)
      predicted = 2 * z(i - 1) - z(i - 2);
    else if (y >= 2)
      predicted = 2 * z(i - 8) - z(i - 16);
    else
      predicted = z(i - 1) + z(i - 8) - z(i - 9);
    width = std::max(width, bits_for(z(i) - predicted));
  }
  return std::min(raw_tile_bytes, whole_bytes(24 + 25 + 25 + 5 + 61 * static_cast<std::size_t>(width)));
}

}  // namespace sightline::raster
