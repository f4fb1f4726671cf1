// What 16 triangles need in the tile loops of the occlusion buffer: edges, gradients and ranges of tiles, a triangle
// per lane. Once per SIMD target.

#if defined(SIGHTLINE_RASTER_OCCLUSION_SETUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_SETUP_INL
#undef SIGHTLINE_RASTER_OCCLUSION_SETUP_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_SETUP_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "sightline/raster/occlusion_kernels.hpp"

// A lambda that is called in a loop must be part of it, else its vectors go through memory.
#undef SIGHTLINE_INLINE_LAMBDA
#define SIGHTLINE_INLINE_LAMBDA __attribute__((always_inline))

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes: one tile is 16 / N vectors.
using Float = hn::CappedTag<float, tile_pixels>;
using Int = hn::RebindToSigned<Float>;

HWY_INLINE std::size_t float_lanes() { return hn::Lanes(Float()); }
inline constexpr std::size_t tile_vectors = tile_pixels / hn::MaxLanes(Float());

/// Pixel offsets of the lanes of a tile, from the centre of its first pixel.
HWY_ALIGN inline constexpr float lane_x[tile_pixels] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
HWY_ALIGN inline constexpr float lane_y[tile_pixels] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

template <class Mask>
HWY_INLINE std::uint32_t bits_of(Float d, Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | (static_cast<std::uint32_t>(bytes[1]) << 8);
}

/// The first of `count` numbers, as many as there are lanes. Those from `count` on are read too and may be anything:
/// they belong to tiles of another strip, in which another thread writes meanwhile. The thread sanitizer sees none of
/// them.
HWY_INLINE hn::Vec<Float> load_some(const float* from, [[maybe_unused]] std::size_t count) {
  const Float d;
#ifdef __SANITIZE_THREAD__
  HWY_ALIGN float lanes[tile_pixels] = {};
  std::copy_n(from, std::min(count, float_lanes()), lanes);
  return hn::Load(d, lanes);
#else
  return hn::LoadU(d, from);
#endif
}

HWY_ALIGN inline constexpr std::int32_t lane_bit[tile_pixels] = {1 << 0,  1 << 1,  1 << 2,  1 << 3, 1 << 4,  1 << 5,
                                                                 1 << 6,  1 << 7,  1 << 8,  1 << 9, 1 << 10, 1 << 11,
                                                                 1 << 12, 1 << 13, 1 << 14, 1 << 15};

/// The lanes whose bits from bit l on are set.
HWY_INLINE hn::Mask<Float> lanes_of(std::uint32_t bits, std::size_t l) {
  const Int di;
  return hn::RebindMask(Float(), hn::TestBit(hn::Set(di, static_cast<std::int32_t>(bits)), hn::Load(di, lane_bit + l)));
}

/// What 16 triangles need in the tile loop.
struct Setups {
  HWY_ALIGN float x[3][tile_pixels], y[3][tile_pixels];              // corners
  HWY_ALIGN float a[3][tile_pixels], b[3][tile_pixels];              // edges, see Edge; they start at the corners
  HWY_ALIGN float gradient_x[tile_pixels], gradient_y[tile_pixels];  // nearness per pixel
  HWY_ALIGN float base[tile_pixels];   // nearness at the first corner, lowered to the least over a pixel square
  HWY_ALIGN float least[tile_pixels];  // nearness of the farthest corner, lowered
  HWY_ALIGN float rise[tile_pixels];   // from there to the most over a pixel square, raised
  HWY_ALIGN float most[tile_pixels];   // nearness of the nearest corner, raised
  HWY_ALIGN float low_x[tile_pixels], low_y[tile_pixels], high_x[tile_pixels],
      high_y[tile_pixels];  // box of the corners
  HWY_ALIGN std::int32_t first_column[tile_pixels], last_column[tile_pixels], first_row[tile_pixels],
      last_row[tile_pixels];
  std::uint32_t valid;  // bit per triangle: it has an area and may touch the strip
  std::uint32_t flat;   // bit per triangle: it has no area that floats can tell
};

template <class V>
HWY_INLINE V min3(V a, V b, V c) {
  return hn::Min(hn::Min(a, b), c);
}
template <class V>
HWY_INLINE V max3(V a, V b, V c) {
  return hn::Max(hn::Max(a, b), c);
}

/// Lanes [l, l + N) of the setups, of the triangles from `first` on.
HWY_INLINE void set_up(const DrawList& list, std::size_t first, const Margins& margins, const Tiles& tiles,
                       const Strip& strip, std::size_t l, Setups& out) {
  const Float d;
  const Int di;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f), margin = hn::Set(d, margins.pixels);
  const auto half = hn::Set(d, margins.square + margins.pixels);
  const auto load = [&](const std::vector<float>& array) { return hn::LoadU(d, array.data() + first + l); };
  const auto x0 = load(list.x[0]), x1 = load(list.x[1]), x2 = load(list.x[2]);
  const auto y0 = load(list.y[0]), y1 = load(list.y[1]), y2 = load(list.y[2]);
  const auto low_y = min3(y0, y1, y2), high_y = max3(y0, y1, y2);
  const auto n0 = load(list.near[0]), n1 = load(list.near[1]), n2 = load(list.near[2]);
  const auto ux = hn::Sub(x1, x0), uy = hn::Sub(y1, y0), vx = hn::Sub(x2, x0), vy = hn::Sub(y2, y0);
  const auto area = hn::Sub(hn::Mul(ux, vy), hn::Mul(vx, uy));
  auto valid = hn::Gt(hn::Abs(area), zero);

  const auto sign = hn::IfThenElse(hn::Gt(area, zero), one, hn::Neg(one));
  const auto edge = [&](int i, auto from_x, auto from_y, auto to_x, auto to_y) SIGHTLINE_INLINE_LAMBDA {
    const auto a = hn::Mul(hn::Sub(from_y, to_y), sign), b = hn::Mul(hn::Sub(to_x, from_x), sign);
    const auto scale = hn::Div(one, hn::Mul(hn::Add(hn::Abs(a), hn::Abs(b)), half));
    valid = hn::And(valid, hn::Lt(scale, hn::Set(d, 1e20f)));  // else two corners coincide
    hn::Store(hn::Mul(a, scale), d, out.a[i] + l);
    hn::Store(hn::Mul(b, scale), d, out.b[i] + l);
    hn::Store(from_x, d, out.x[i] + l);
    hn::Store(from_y, d, out.y[i] + l);
  };
  edge(0, x0, y0, x1, y1);
  edge(1, x1, y1, x2, y2);
  edge(2, x2, y2, x0, y0);
  out.flat |= bits_of(d, hn::Not(valid)) << l;

  const auto lowered = [&](auto near, auto size) SIGHTLINE_INLINE_LAMBDA {
    return hn::Sub(near, hn::Add(hn::Mul(size, hn::Set(d, margins.nearness_share)), hn::Set(d, margins.nearness)));
  };
  const auto lowest = min3(n0, n1, n2);
  const auto least = lowered(lowest, hn::Abs(lowest));
  const auto length = [](auto x, auto y) SIGHTLINE_INLINE_LAMBDA { return hn::Add(hn::Abs(x), hn::Abs(y)); };
  const auto longest = max3(length(ux, uy), length(vx, vy), length(hn::Sub(vx, ux), hn::Sub(vy, uy)));
  // A sliver's gradient is noise: take its farthest corner for all of it.
  const auto sliver = hn::Lt(hn::Abs(area), hn::Mul(hn::Set(d, 0.25f), longest));
  const auto du = hn::Sub(n1, n0), dv = hn::Sub(n2, n0);
  const auto gx = hn::Div(hn::Sub(hn::Mul(du, vy), hn::Mul(dv, uy)), area);
  const auto gy = hn::Div(hn::Sub(hn::Mul(dv, ux), hn::Mul(du, vx)), area);
  const auto drop = hn::Mul(length(gx, gy), half);
  const auto largest = max3(hn::Abs(n0), hn::Abs(n1), hn::Abs(n2));
  const auto base = lowered(hn::Sub(n0, drop), largest);
  const auto highest = max3(n0, n1, n2);
  const auto most = hn::Sub(highest, lowered(zero, hn::Abs(highest)));
  const auto rise = hn::Mul(hn::Set(d, 2.0f), hn::Sub(drop, lowered(zero, largest)));
  hn::Store(hn::IfThenElse(sliver, hn::Sub(most, least), rise), d, out.rise + l);
  hn::Store(most, d, out.most + l);
  hn::Store(hn::IfThenElse(sliver, zero, gx), d, out.gradient_x + l);
  hn::Store(hn::IfThenElse(sliver, zero, gy), d, out.gradient_y + l);
  hn::Store(hn::IfThenElse(sliver, least, base), d, out.base + l);
  hn::Store(least, d, out.least + l);

  const auto range = [&](auto low, auto high, int pixels, float* low_out, float* high_out, std::int32_t* first_out,
                         std::int32_t* last_out) SIGHTLINE_INLINE_LAMBDA {
    hn::Store(low, d, low_out + l);
    hn::Store(high, d, high_out + l);
    const auto end = hn::Set(d, static_cast<float>(pixels));
    low = hn::Sub(low, margin);
    high = hn::Add(high, margin);
    valid = hn::And(valid, hn::And(hn::Lt(low, end), hn::Ge(high, zero)));
    const auto to_tile = [&](auto v) SIGHTLINE_INLINE_LAMBDA {
      return hn::ShiftRight<2>(hn::ConvertTo(di, hn::Min(hn::Max(v, zero), hn::Sub(end, one))));
    };
    hn::Store(to_tile(low), di, first_out + l);
    hn::Store(to_tile(high), di, last_out + l);
  };
  range(min3(x0, x1, x2), max3(x0, x1, x2), tiles.width, out.low_x, out.high_x, out.first_column, out.last_column);
  range(low_y, high_y, tiles.height, out.low_y, out.high_y, out.first_row, out.last_row);
  const auto column = [&](const std::int32_t* columns) SIGHTLINE_INLINE_LAMBDA { return hn::Load(di, columns + l); };
  const auto beside = hn::Or(hn::Gt(column(out.first_column), hn::Set(di, strip.last_column)),
                             hn::Lt(column(out.last_column), hn::Set(di, strip.first_column)));
  out.valid |= bits_of(d, hn::AndNot(hn::RebindMask(d, beside), valid)) << l;
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
