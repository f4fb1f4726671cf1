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

inline void decode_rows(const PackedTile& packed, std::uint32_t* tile) {
  using tile_layout::Predictor;
  const hn::CappedTag<std::int32_t, 8> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const int n = static_cast<int>(hn::Lanes(d));
  const std::uint8_t* bytes = packed.bytes.data();
  const Predictor first = tile_layout::read_predictor(bytes + tile_layout::widths);
  const std::uint8_t* p = bytes + tile_layout::widths + tile_layout::predictor;
  const std::uint8_t* mask = nullptr;
  Predictor second = first;
  std::int32_t base = 0;
  if (packed.mode == TileMode::two_planes) {
    mask = p;
    second = tile_layout::read_predictor(p + tile_layout::mask);
    p += tile_layout::mask + tile_layout::predictor;
  } else if (packed.mode == TileMode::second_order) {
    base = tile_layout::read24(p);
    p += 3;
  }
  auto* out = reinterpret_cast<std::int32_t*>(tile);
  for (int row = 0; row < 8; ++row, out += 8) {
    const int width = tile_layout::width_of(bytes, row);
    // Pixels 0 to 3 lie within the four bytes from 0, pixels 4 to 7 within those from (4 * width) / 8.
    std::uint32_t half[2];
    std::memcpy(&half[0], p, 4);
    std::memcpy(&half[1], p + (width >> 1), 4);
    p += width;
    const std::uint32_t field = (1u << width) - 1;
    for (int i = 0; i < 8; i += n) {
      const auto lane = hn::Iota(d, i);
      const auto high = hn::Gt(lane, hn::Set(d, 3));
      const auto word = hn::IfThenElse(high, hn::Set(d, static_cast<std::int32_t>(half[1])),
                                       hn::Set(d, static_cast<std::int32_t>(half[0])));
      auto shift = hn::Mul(hn::And(lane, hn::Set(d, 3)), hn::Set(d, width));
      shift = hn::Add(shift, hn::IfThenElseZero(high, hn::Set(d, (4 * width) & 7)));
      auto value = hn::BitCast(d, hn::And(hn::Shr(hn::BitCast(du, word), hn::BitCast(du, shift)), hn::Set(du, field)));
      value = hn::Sub(value, hn::Set(d, tile_layout::bias_of(width)));
      const auto plane = [&](const Predictor& q, int dx, int dy) {
        return hn::Add(hn::Set(d, q.z), hn::ShiftRight<tile_layout::fraction_bits>(
                                            hn::Add(hn::Mul(lane, hn::Set(d, dx)), hn::Set(d, row * dy))));
      };
      if (packed.mode == TileMode::plane) {
        value = hn::Add(value, plane(first, first.dx, first.dy));
      } else if (packed.mode == TileMode::two_planes) {
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
