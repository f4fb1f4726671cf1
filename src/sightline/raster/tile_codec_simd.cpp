// decode_tile for every SIMD target that the compiler can make, chosen at run time (Highway).
#include "sightline/raster/tile_codec.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/raster/tile_codec_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/raster/tile_codec_layout.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// One loop for each mode: its branches are gone before the rows begin.
template <TileMode mode>
HWY_INLINE void decode_mode(const std::uint8_t* bytes, std::int32_t* out) {
  using tile_layout::Predictor;
  const hn::CappedTag<std::int32_t, 8> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  constexpr bool second_order = mode == TileMode::second_order;
  const int n = static_cast<int>(hn::Lanes(d));
  const Predictor first = tile_layout::read_predictor(bytes + tile_layout::widths);
  const std::uint8_t* p = bytes + tile_layout::widths + tile_layout::predictor;
  const std::uint8_t* mask = p;
  Predictor second = first;
  std::int32_t base = 0;
  if constexpr (mode == TileMode::two_planes) {
    second = tile_layout::read_predictor(p + tile_layout::mask);
    p += tile_layout::mask + tile_layout::predictor;
  } else if constexpr (second_order) {
    base = tile_layout::read24(p);
    p += 3;
  }
  for (int row = 0; row < 8; ++row, out += 8) {
    const int width = tile_layout::width_of(bytes, row);
    const std::int32_t bias = tile_layout::bias_of(width);
    alignas(32) std::int32_t wide[8] = {};
    std::uint32_t half[2] = {0, 0};
    if (HWY_LIKELY(width <= 8)) {
      // Pixels 0 to 3 lie within the four bytes from 0, pixels 4 to 7 within those from (4 * width) / 8.
      std::memcpy(&half[0], p, 4);
      std::memcpy(&half[1], p + (width >> 1), 4);
    } else {
      for (int i = 0; i < 8; ++i)
        wide[i] = static_cast<std::int32_t>((tile_layout::half_row(p, width, i / 4) >> (i % 4 * width)) &
                                            ((std::uint64_t{1} << width) - 1));
    }
    p += width;
    for (int i = 0; i < 8; i += n) {
      const auto lane = hn::Iota(d, i);
      auto value = hn::Zero(d);
      if (HWY_LIKELY(width <= 8)) {
        const auto high = hn::Gt(lane, hn::Set(d, 3));
        const auto word = hn::IfThenElse(high, hn::Set(d, static_cast<std::int32_t>(half[1])),
                                         hn::Set(d, static_cast<std::int32_t>(half[0])));
        auto shift = hn::Mul(hn::And(lane, hn::Set(d, 3)), hn::Set(d, width));
        shift = hn::Add(shift, hn::IfThenElseZero(high, hn::Set(d, (4 * width) & 7)));
        value = hn::BitCast(
            d, hn::And(hn::Shr(hn::BitCast(du, word), hn::BitCast(du, shift)), hn::Set(du, (1u << width) - 1)));
      } else {
        value = hn::LoadU(d, wide + i);
      }
      const auto plane = [&](const Predictor& q, int dx, int dy) HWY_ATTR {
        return hn::Add(hn::Set(d, q.z), hn::ShiftRight<tile_layout::fraction_bits>(
                                            hn::Add(hn::Mul(lane, hn::Set(d, dx)), hn::Set(d, row * dy))));
      };
      value = hn::Sub(value, hn::Set(d, bias));
      if constexpr (mode == TileMode::plane) {
        value = hn::Add(value, plane(first, first.dx, first.dy));
      } else if constexpr (mode == TileMode::two_planes) {
        const auto bit = hn::Shl(hn::Set(du, 1u), hn::BitCast(du, lane));
        const auto far = hn::Ne(hn::And(hn::Set(du, mask[row]), bit), hn::Zero(du));
        value = hn::Add(value, hn::IfThenElse(hn::RebindMask(d, far), plane(second, second.dx, second.dy),
                                              plane(first, first.dx, first.dy)));
      } else if (row == 0) {
        value = hn::Add(value, plane(first, first.dx, 0));
      } else if (row == 1) {
        const auto line = hn::ShiftRight<tile_layout::fraction_bits>(hn::Mul(lane, hn::Set(d, first.dy)));
        value = hn::Add(hn::Add(value, line), hn::Add(hn::LoadU(d, out - 8 + i), hn::Set(d, base)));
      } else {
        const auto above = hn::LoadU(d, out - 8 + i);
        value = hn::Add(value, hn::Sub(hn::Add(above, above), hn::LoadU(d, out - 16 + i)));
      }
      hn::StoreU(value, d, out + i);
    }
  }
}

inline void decode_rows(const PackedTile& packed, std::uint32_t* tile) {
  const std::uint8_t* bytes = packed.bytes.data();
  auto* out = reinterpret_cast<std::int32_t*>(tile);
  if (packed.mode == TileMode::plane) return decode_mode<TileMode::plane>(bytes, out);
  if (packed.mode == TileMode::two_planes) return decode_mode<TileMode::two_planes>(bytes, out);
  if (packed.mode == TileMode::second_order) return decode_mode<TileMode::second_order>(bytes, out);
  alignas(32) std::int32_t turned[64];
  decode_mode<TileMode::second_order>(bytes, turned);
  for (std::size_t row = 0; row < 8; ++row)
    for (std::size_t i = 0; i < 8; ++i) out[8 * row + i] = turned[8 * i + row];
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::raster {

HWY_EXPORT(decode_rows);
void decode_tile(const PackedTile& packed, DepthTile& tile) {
  if (packed.mode == TileMode::raw) return decode_tile_scalar(packed, tile);
  HWY_DYNAMIC_DISPATCH(decode_rows)(packed, tile.data());
}

}  // namespace sightline::raster
#endif
