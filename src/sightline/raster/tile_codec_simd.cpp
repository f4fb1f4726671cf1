// decode_tile for every SIMD target that the compiler can make, chosen at run time (Highway). A row of residuals of any
// width takes the same few instructions: a byte shuffle, a shift to the left and one to the right, from a table.
#include "sightline/raster/tile_codec.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/raster/tile_codec_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "sightline/raster/tile_codec_layout.hpp"

#ifndef SIGHTLINE_RASTER_TILE_CODEC_TABLE
#define SIGHTLINE_RASTER_TILE_CODEC_TABLE
namespace sightline::raster::tile_layout {

/// How a row of one width comes apart: the four bytes that hold pixel i (0x80: none), and the shifts that leave its
/// bits with their sign.
struct alignas(128) RowTable {
  std::uint8_t bytes[32];
  std::int32_t left[8], right[8];
};

constexpr std::array<RowTable, widths> make_row_tables() {
  std::array<RowTable, widths> tables{};
  for (int width = 0; width < widths; ++width) {
    RowTable& t = tables[static_cast<std::size_t>(width)];
    for (int i = 0; i < 8; ++i) {
      const int bit = i * width;
      for (int k = 0; k < 4; ++k) {
        const bool there = bit / 8 + k < width;  // a row has as many bytes as bits in a pixel
        t.bytes[4 * i + k] = there ? static_cast<std::uint8_t>(bit / 8 + k) : std::uint8_t{0x80};
      }
      t.left[i] = width == 0 ? 0 : 32 - width - bit % 8;
      t.right[i] = width == 0 ? 0 : 32 - width;
    }
  }
  return tables;
}

inline constexpr std::array<RowTable, widths> row_tables = make_row_tables();

}  // namespace sightline::raster::tile_layout
#endif

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

HWY_INLINE void decode_as(TileMode, const PackedTile& packed, DepthTile& tile) { decode_tile_scalar(packed, tile); }

#else

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<std::int32_t, 8>;
using V = hn::Vec<D>;
constexpr std::size_t lanes = HWY_MIN(HWY_MAX_BYTES / 4, 8), parts = 8 / lanes;  // a row takes one or two vectors

HWY_INLINE V set(std::int32_t v) { return hn::Set(D(), v); }

/// Calls f(y, k, residuals) for the parts k of all rows y.
template <class F>
HWY_INLINE void each_row(const std::uint8_t* bytes, std::size_t used, F&& f) {
  const D d;
  const hn::Repartition<std::uint8_t, D> d8;
  std::uint32_t header = 0;
  std::memcpy(&header, bytes, sizeof header);
  const std::uint8_t* row = bytes + tile_layout::header + used;
  for (int y = 0; y < 8; ++y, header >>= 4) {
    const std::size_t width = header & 15;
    const tile_layout::RowTable& t = tile_layout::row_tables[width];
    for (std::size_t k = 0; k < parts; ++k) {
      const auto spread = hn::TableLookupBytesOr0(hn::LoadDup128(d8, row), hn::Load(d8, t.bytes + 4 * lanes * k));
      const V words = hn::BitCast(d, spread);
      f(y, k, hn::Shr(hn::Shl(words, hn::Load(d, t.left + lanes * k)), hn::Load(d, t.right + lanes * k)));
    }
    row += width;
  }
}

/// A plane, row by row.
struct PlaneRows {
  V at[parts];
  V down;
  HWY_INLINE explicit PlaneRows(const tile_layout::Plane& p) : down(set(p.dy)) {
    for (std::size_t k = 0; k < parts; ++k)
      at[k] = hn::Add(set(static_cast<std::int32_t>(p.z)),
                      hn::Mul(hn::Iota(D(), static_cast<std::int32_t>(lanes * k)), set(p.dx)));
  }
  HWY_INLINE V next(std::size_t k) {
    const D d;
    const hn::RebindToUnsigned<D> du;
    const V z = hn::BitCast(d, hn::ShiftRight<tile_layout::fraction_bits>(hn::BitCast(du, at[k])));
    at[k] = hn::Add(at[k], down);
    return z;
  }
};

HWY_INLINE void store(std::uint32_t* tile, int y, std::size_t k, V v) {
  hn::StoreU(v, D(), reinterpret_cast<std::int32_t*>(tile) + 8 * static_cast<std::size_t>(y) + lanes * k);
}

HWY_INLINE void decode_plane(const std::uint8_t* bytes, std::uint32_t* tile) {
  PlaneRows plane(tile_layout::read_plane(bytes + tile_layout::header));
  each_row(bytes, tile_layout::predictor,
           [&](int y, std::size_t k, V v) HWY_ATTR { store(tile, y, k, hn::Add(v, plane.next(k))); });
}

HWY_INLINE void decode_two_planes(const std::uint8_t* bytes, std::uint32_t* tile) {
  const D d;
  const std::uint8_t* p = bytes + tile_layout::header;
  const std::uint8_t* mask = p + tile_layout::predictor;
  PlaneRows first(tile_layout::read_plane(p)), second(tile_layout::read_plane(mask + tile_layout::mask));
  V bit[parts];
  for (std::size_t k = 0; k < parts; ++k) bit[k] = hn::Shl(set(1), hn::Iota(d, static_cast<std::int32_t>(lanes * k)));
  each_row(bytes, 2 * tile_layout::predictor + tile_layout::mask, [&](int y, std::size_t k, V v) HWY_ATTR {
    const V one = first.next(k), two = second.next(k);
    store(tile, y, k, hn::Add(v, hn::IfThenElse(hn::TestBit(set(mask[y]), bit[k]), two, one)));
  });
}

/// Calls out(y, k, depths).
template <class F>
HWY_INLINE void decode_second_order(const std::uint8_t* bytes, F&& out) {
  const tile_layout::SecondOrder order = tile_layout::read_second_order(bytes + tile_layout::header);
  V at[parts], step[parts];
  each_row(bytes, tile_layout::second_order, [&](int y, std::size_t k, V v) HWY_ATTR {
    const V i = hn::Iota(D(), static_cast<std::int32_t>(lanes * k));
    const auto along = [&](std::int32_t slope)
                           HWY_ATTR { return hn::ShiftRight<tile_layout::slope_bits>(hn::Mul(i, set(slope))); };
    if (y == 0) {
      at[k] = hn::Add(v, hn::Add(set(order.z), along(order.slope)));
    } else {
      step[k] = y == 1 ? hn::Add(v, hn::Add(set(order.step), along(order.step_slope))) : hn::Add(step[k], v);
      at[k] = hn::Add(at[k], step[k]);
    }
    out(y, k, at[k]);
  });
}

/// Exchanges rows and columns of the 4 x 4 blocks in four rows of vectors.
HWY_INLINE void turn_blocks(const V* in, std::size_t stride, V* out) {
  const D d;
  const hn::RepartitionToWide<D> pairs;
  const V a = in[0], b = in[stride], c = in[2 * stride], e = in[3 * stride];
  const auto ab = hn::BitCast(pairs, hn::InterleaveLower(d, a, b)),
             ce = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
  const auto ab2 = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b)),
             ce2 = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
  out[0] = hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce));
  out[2] = hn::BitCast(d, hn::InterleaveLower(pairs, ab2, ce2));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, ab2, ce2));
}

/// Calls out(i, k, depths) for the parts k of all columns i of a tile.
template <class F>
HWY_INLINE void each_column(const V* rows, F&& out) {
  if constexpr (parts == 1) {
    V upper[4], lower[4];  // of columns i and i + 4: from rows 0 to 3, and from rows 4 to 7
    turn_blocks(rows, 1, upper);
    turn_blocks(rows + 4, 1, lower);
    for (int i = 0; i < 4; ++i) out(i, 0, hn::ConcatLowerLower(D(), lower[i], upper[i]));
    for (int i = 0; i < 4; ++i) out(i + 4, 0, hn::ConcatUpperUpper(D(), lower[i], upper[i]));
  } else {
    for (std::size_t half = 0; half < 2; ++half) {
      V column[2][4];
      for (std::size_t k = 0; k < 2; ++k) turn_blocks(rows + 8 * k + half, 2, column[k]);
      for (int i = 0; i < 4; ++i)
        for (std::size_t k = 0; k < 2; ++k) out(static_cast<int>(4 * half) + i, k, column[k][i]);
    }
  }
}

HWY_INLINE void decode_second_order_turned(const std::uint8_t* bytes, std::uint32_t* tile) {
  V rows[8 * parts];
  decode_second_order(bytes,
                      [&](int y, std::size_t k, V v) HWY_ATTR { rows[static_cast<std::size_t>(y) * parts + k] = v; });
  each_column(rows, [&](int i, std::size_t k, V v) HWY_ATTR { store(tile, i, k, v); });
}

/// Sums the mixed differences down the rows, turns them, and sums them the other way.
HWY_INLINE void decode_mixed(const std::uint8_t* bytes, std::uint32_t* tile) {
  const D d;
  const tile_layout::Mixed m = tile_layout::read_mixed(bytes + tile_layout::header);
  V sum[parts], next[parts], bend[parts];  // next: what is predicted of the differences in the next row
  for (std::size_t k = 0; k < parts; ++k) {
    const V i = hn::Iota(d, static_cast<std::int32_t>(lanes * k));
    const auto first = hn::Eq(i, hn::Zero(d));
    const V right = hn::Add(set(m.right), hn::Mul(hn::Sub(i, set(1)), set(m.bend_x)));
    sum[k] = hn::IfThenElse(first, set(m.z), right);
    next[k] = hn::IfThenElse(first, set(m.down), set(m.twist));
    bend[k] = hn::IfThenElseZero(first, set(m.bend_y));
  }
  V rows[8 * parts];
  each_row(bytes, tile_layout::mixed, [&](int y, std::size_t k, V v) HWY_ATTR {
    sum[k] = hn::Add(sum[k], v);
    if (y > 0) {
      sum[k] = hn::Add(sum[k], next[k]);
      next[k] = hn::Add(next[k], bend[k]);
    }
    rows[static_cast<std::size_t>(y) * parts + k] = sum[k];
  });
  for (std::size_t k = 0; k < parts; ++k) sum[k] = hn::Zero(d);
  each_column(rows, [&](int i, std::size_t k, V v) HWY_ATTR {
    sum[k] = hn::Add(sum[k], v);
    store(tile, i, k, sum[k]);
  });
}

/// 24 bits each: four pixels from twelve bytes.
HWY_INLINE void decode_raw(const std::uint8_t* bytes, std::uint32_t* tile) {
  const hn::FixedTag<std::uint8_t, 16> d;
  alignas(16) static constexpr std::uint8_t spread[16] = {0, 1, 2, 0x80, 3, 4, 5, 0x80, 6, 7, 8, 0x80, 9, 10, 11, 0x80};
  for (std::size_t i = 0; i < 64; i += 4)
    hn::StoreU(hn::TableLookupBytesOr0(hn::LoadU(d, bytes + 3 * i), hn::Load(d, spread)), d,
               reinterpret_cast<std::uint8_t*>(tile + i));
}

HWY_INLINE void decode_as(TileMode mode, const PackedTile& packed, DepthTile& tile) {
  const std::uint8_t* bytes = packed.bytes.data();
  switch (mode) {
    case TileMode::plane:
      return decode_plane(bytes, tile.data());
    case TileMode::two_planes:
      return decode_two_planes(bytes, tile.data());
    case TileMode::second_order:
      return decode_second_order(bytes, [&](int y, std::size_t k, V v) HWY_ATTR { store(tile.data(), y, k, v); });
    case TileMode::second_order_turned:
      return decode_second_order_turned(bytes, tile.data());
    case TileMode::mixed:
      return decode_mixed(bytes, tile.data());
    case TileMode::raw:
      return decode_raw(bytes, tile.data());
  }
}

#endif

inline void decode_one(const PackedTile& packed, DepthTile& tile) { decode_as(packed.mode, packed, tile); }

inline void decode_by_mode(const PackedTile* packed, std::size_t count, DepthTile* tiles) {
  constexpr std::size_t at_once = 64;
  for (std::size_t begin = 0; begin < count; begin += at_once) {
    std::uint8_t of_mode[tile_modes][at_once];
    std::size_t number[tile_modes] = {};
    for (std::size_t i = 0; i < std::min(at_once, count - begin); ++i) {
      const auto mode = static_cast<std::size_t>(packed[begin + i].mode);
      of_mode[mode][number[mode]++] = static_cast<std::uint8_t>(i);
    }
    const auto all_of = [&](TileMode mode) HWY_ATTR {
      const auto m = static_cast<std::size_t>(mode);
      for (std::size_t i = 0; i < number[m]; ++i) {
        const std::size_t at = begin + of_mode[m][i];
        decode_as(mode, packed[at], tiles[at]);
      }
    };
    all_of(TileMode::plane);
    all_of(TileMode::two_planes);
    all_of(TileMode::second_order);
    all_of(TileMode::second_order_turned);
    all_of(TileMode::mixed);
    all_of(TileMode::raw);
  }
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::raster {

HWY_EXPORT(decode_one);
void decode_tile(const PackedTile& packed, DepthTile& tile) { HWY_DYNAMIC_DISPATCH(decode_one)(packed, tile); }
HWY_EXPORT(decode_by_mode);
void decode_tiles(const PackedTile* packed, std::size_t count, DepthTile* tiles) {
  HWY_DYNAMIC_DISPATCH(decode_by_mode)(packed, count, tiles);
}

}  // namespace sightline::raster
#endif
