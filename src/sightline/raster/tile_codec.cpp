#include "sightline/raster/tile_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <span>

#include "sightline/raster/tile_codec_layout.hpp"

namespace sightline::raster {
namespace {

using tile_layout::Predictor;
using Residuals = std::array<std::int64_t, 64>;

/// Bits that hold v + 2^(bits-1) without sign.
int bits_for(std::int64_t v) {
  if (v == 0) return 0;
  const auto magnitude = static_cast<std::uint64_t>(v < 0 ? -v - 1 : v);
  return static_cast<int>(std::bit_width(magnitude)) + 1;
}

/// Least squares through the pixels of `members`; the constant is what the residuals are centred on.
Predictor fit(const DepthTile& tile, std::uint64_t members) {
  double n = 0, sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, syy = 0, sxz = 0, syz = 0;
  const double origin = tile[static_cast<std::size_t>(std::countr_zero(members))];
  for (std::size_t i = 0; i < 64; ++i) {
    if (((members >> i) & 1) == 0) continue;
    const double x = static_cast<double>(i % 8), y = static_cast<double>(i / 8), z = tile[i] - origin;
    n += 1;
    sx += x;
    sy += y;
    sz += z;
    sxx += x * x;
    sxy += x * y;
    syy += y * y;
    sxz += x * z;
    syz += y * z;
  }
  const double axx = sxx - sx * sx / n, axy = sxy - sx * sy / n, ayy = syy - sy * sy / n;
  const double bx = sxz - sx * sz / n, by = syz - sy * sz / n, det = axx * ayy - axy * axy;
  double dx = 0, dy = 0;
  if (det > 1e-6) {
    dx = (bx * ayy - by * axy) / det;
    dy = (by * axx - bx * axy) / det;
  } else if (axx > 1e-6) {
    dx = bx / axx;
  } else if (ayy > 1e-6) {
    dy = by / ayy;
  }
  constexpr double one = 1 << tile_layout::fraction_bits;
  const auto slope = [](double v) {
    return static_cast<std::int32_t>(
        std::clamp(std::round(v * one), -1.0 * tile_layout::largest_slope, 1.0 * tile_layout::largest_slope));
  };
  Predictor p{0, slope(dx), slope(dy)};
  std::int64_t least = INT64_MAX, most = INT64_MIN;
  for (std::size_t i = 0; i < 64; ++i) {
    if (((members >> i) & 1) == 0) continue;
    const std::int64_t r = static_cast<std::int64_t>(tile[i]) - p.at(static_cast<int>(i % 8), static_cast<int>(i / 8));
    least = std::min(least, r);
    most = std::max(most, r);
  }
  p.z = static_cast<std::int32_t>(std::clamp<std::int64_t>((least + most + 1) / 2, 0, 0xFFFFFF));
  return p;
}

/// Writes header and residuals after `used` bytes of predictors; false if a residual is too wide or nothing is gained.
bool finish(const Residuals& residuals, std::size_t used, TileMode mode, PackedTile& out) {
  std::array<int, 8> width{};
  std::size_t size = used;
  for (std::size_t row = 0; row < 8; ++row) {
    for (std::size_t i = 0; i < 8; ++i) width[row] = std::max(width[row], bits_for(residuals[8 * row + i]));
    if (width[row] > tile_layout::most_width) return false;
    size += static_cast<std::size_t>(width[row]);
  }
  if (size >= raw_tile_bytes) return false;
  for (std::size_t row = 0; row < 4; ++row)
    out.bytes[row] = static_cast<std::uint8_t>(width[2 * row] | (width[2 * row + 1] << 4));
  std::uint8_t* p = out.bytes.data() + used;
  for (std::size_t row = 0; row < 8; ++row) {
    std::uint64_t half[2] = {0, 0};
    for (std::size_t i = 0; i < 8 && width[row] > 0; ++i)
      half[i / 4] |= static_cast<std::uint64_t>(residuals[8 * row + i] + tile_layout::bias_of(width[row]))
                     << (static_cast<int>(i % 4) * width[row]);
    for (int bit = 0; bit < 8 * width[row]; bit += 4) {
      const int of_half = bit < 4 * width[row] ? bit : bit - 4 * width[row];
      const auto nibble = static_cast<std::uint8_t>((half[bit < 4 * width[row] ? 0 : 1] >> of_half) & 15);
      p[bit / 8] = static_cast<std::uint8_t>(bit % 8 == 0 ? nibble : p[bit / 8] | (nibble << 4));
    }
    p += width[row];
  }
  out.size = static_cast<std::uint16_t>(size);
  out.mode = mode;
  return true;
}

void write_predictor(std::uint8_t* at, const Predictor& p) {
  tile_layout::write24(at, p.z);
  tile_layout::write24(at + 3, p.dx);
  tile_layout::write24(at + 6, p.dy);
}

bool encode_planes(const DepthTile& tile, std::uint64_t far, PackedTile& out) {
  const bool two = far != 0;
  const Predictor near_plane = fit(tile, ~far), far_plane = two ? fit(tile, far) : near_plane;
  Residuals residuals;
  for (std::size_t i = 0; i < 64; ++i) {
    const Predictor& p = ((far >> i) & 1) != 0 ? far_plane : near_plane;
    residuals[i] = static_cast<std::int64_t>(tile[i]) - p.at(static_cast<int>(i % 8), static_cast<int>(i / 8));
  }
  std::size_t used = tile_layout::widths;
  write_predictor(out.bytes.data() + used, near_plane);
  used += tile_layout::predictor;
  if (two) {
    std::memcpy(out.bytes.data() + used, &far, sizeof far);
    used += tile_layout::mask;
    write_predictor(out.bytes.data() + used, far_plane);
    used += tile_layout::predictor;
  }
  return finish(residuals, used, two ? TileMode::two_planes : TileMode::plane, out);
}

/// Pixels beyond the largest gap between neighbouring depths; 0 if there is but one depth.
std::uint64_t far_side(const DepthTile& tile) {
  DepthTile sorted = tile;
  std::sort(sorted.begin(), sorted.end());
  std::uint32_t gap = 0, first_far = 0;
  for (std::size_t i = 1; i < 64; ++i)
    if (sorted[i] - sorted[i - 1] > gap) {
      gap = sorted[i] - sorted[i - 1];
      first_far = sorted[i];
    }
  std::uint64_t far = 0;
  for (std::size_t i = 0; gap > 0 && i < 64; ++i) far |= tile[i] >= first_far ? std::uint64_t{1} << i : 0;
  return far;
}

/// Row 0 from a line; the step from row 0 to row 1 from a line; from then on what the last step predicts.
bool encode_second_order(const DepthTile& tile, TileMode mode, PackedTile& out) {
  const auto value = [&](std::size_t row, std::size_t i) { return static_cast<std::int64_t>(tile[8 * row + i]); };
  Residuals residuals;
  const Predictor line = fit(tile, 0xFF);
  std::array<std::int64_t, 8> step;
  for (std::size_t i = 0; i < 8; ++i) {
    residuals[i] = value(0, i) - line.at(static_cast<int>(i), 0);
    step[i] = value(1, i) - value(0, i);
  }
  // The line of the first steps goes through its ends; its constant is centred.
  constexpr std::int64_t one = 1 << tile_layout::fraction_bits;
  const std::int64_t slope =
      std::clamp<std::int64_t>((step[7] - step[0]) * one / 7, -tile_layout::largest_slope, tile_layout::largest_slope);
  const auto at = [&](std::size_t i) { return (static_cast<std::int64_t>(i) * slope) >> tile_layout::fraction_bits; };
  std::int64_t least = INT64_MAX, most = INT64_MIN;
  for (std::size_t i = 0; i < 8; ++i) {
    least = std::min(least, step[i] - at(i));
    most = std::max(most, step[i] - at(i));
  }
  const std::int64_t base = (least + most + 1) / 2;
  if (std::abs(base) > tile_layout::largest_slope) return false;
  for (std::size_t i = 0; i < 8; ++i) residuals[8 + i] = step[i] - base - at(i);
  for (std::size_t row = 2; row < 8; ++row)
    for (std::size_t i = 0; i < 8; ++i)
      residuals[8 * row + i] = value(row, i) - 2 * value(row - 1, i) + value(row - 2, i);
  write_predictor(out.bytes.data() + tile_layout::widths, {line.z, line.dx, static_cast<std::int32_t>(slope)});
  tile_layout::write24(out.bytes.data() + tile_layout::widths + tile_layout::predictor,
                       static_cast<std::int32_t>(base));
  return finish(residuals, tile_layout::widths + tile_layout::predictor + 3, mode, out);
}

void encode_raw(const DepthTile& tile, PackedTile& out) {
  for (std::size_t i = 0; i < 64; ++i)
    tile_layout::write24(out.bytes.data() + 3 * i, static_cast<std::int32_t>(tile[i]));
  out.size = raw_tile_bytes;
  out.mode = TileMode::raw;
}

DepthTile turned(const DepthTile& tile) {
  DepthTile result;
  for (std::size_t i = 0; i < 64; ++i) result[i % 8 * 8 + i / 8] = tile[i];
  return result;
}

std::size_t whole_bytes(std::size_t bits) { return (bits + 7) / 8; }

}  // namespace

PackedTile raw_tile(const DepthTile& tile) {
  PackedTile raw{};
  encode_raw(tile, raw);
  return raw;
}

PackedTile encode_tile(const DepthTile& tile) {
  PackedTile best = raw_tile(tile), trial{};
  const auto keep_smaller = [&](bool fits) {
    if (fits && trial.size < best.size) best = trial;
  };
  keep_smaller(encode_planes(tile, 0, trial));
  keep_smaller(encode_second_order(tile, TileMode::second_order, trial));
  keep_smaller(encode_second_order(turned(tile), TileMode::second_order_turned, trial));
  const std::uint64_t far = far_side(tile);
  if (far != 0) keep_smaller(encode_planes(tile, far, trial));
  return best;
}

void decode_tile_scalar(const PackedTile& packed, DepthTile& tile) {
  const std::uint8_t* bytes = packed.bytes.data();
  if (packed.mode == TileMode::raw) {
    for (std::size_t i = 0; i < 64; ++i)
      tile[i] = static_cast<std::uint32_t>(tile_layout::read24(bytes + 3 * i)) & 0xFFFFFF;
    return;
  }
  const bool second_order = packed.mode == TileMode::second_order || packed.mode == TileMode::second_order_turned;
  const Predictor first = tile_layout::read_predictor(bytes + tile_layout::widths);
  const std::uint8_t* p = bytes + tile_layout::widths + tile_layout::predictor;
  Predictor second = first;
  std::uint64_t far = 0;
  std::int32_t base = 0;
  if (packed.mode == TileMode::two_planes) {
    std::memcpy(&far, p, sizeof far);
    second = tile_layout::read_predictor(p + tile_layout::mask);
    p += tile_layout::mask + tile_layout::predictor;
  } else if (second_order) {
    base = tile_layout::read24(p);
    p += 3;
  }
  for (int row = 0; row < 8; ++row) {
    const int width = tile_layout::width_of(bytes, row);
    for (int i = 0; i < 8; ++i) {
      const auto at = static_cast<std::size_t>(8 * row + i);
      const std::uint64_t field =
          (tile_layout::half_row(p, width, i / 4) >> (i % 4 * width)) & ((std::uint64_t{1} << width) - 1);
      std::int32_t value = static_cast<std::int32_t>(field) - tile_layout::bias_of(width);
      if (!second_order)
        value += (((far >> at) & 1) != 0 ? second : first).at(i, row);
      else if (row == 0)
        value += first.z + ((i * first.dx) >> tile_layout::fraction_bits);
      else if (row == 1)
        value += static_cast<std::int32_t>(tile[at - 8]) + base + ((i * first.dy) >> tile_layout::fraction_bits);
      else
        value += 2 * static_cast<std::int32_t>(tile[at - 8]) - static_cast<std::int32_t>(tile[at - 16]);
      tile[at] = static_cast<std::uint32_t>(value);
    }
    p += width;
  }
  if (packed.mode == TileMode::second_order_turned) tile = turned(tile);
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
