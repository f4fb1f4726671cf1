// Ranges of tiles, and edges of triangles as functions over the image, cut to the rows of tiles that they cross. Once
// per SIMD target.

#if defined(SIGHTLINE_RASTER_OCCLUSION_EDGES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_EDGES_INL
#undef SIGHTLINE_RASTER_OCCLUSION_EDGES_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_EDGES_INL
#endif

#include "sightline/raster/occlusion_setup.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

HWY_INLINE void touch(Strip& strip, Place& state, std::size_t tile, std::size_t place) {
  if (state.listed != 0) return;
  state.listed = 1;
  strip.touched.push_back({static_cast<std::uint32_t>(tile), static_cast<std::uint32_t>(place)});
}

/// Columns or rows of tiles; empty if first > last.
struct TileRange {
  int first, last;
};

HWY_INLINE TileRange within(TileRange range, const Strip& strip) {
  return {std::max(range.first, strip.first_column), std::min(range.last, strip.last_column)};
}

/// Those that pixels from low to high (real coordinates) fall in, clamped to the image.
HWY_INLINE TileRange tile_range(float low, float high, int pixels) {
  if (!(low < static_cast<float>(pixels)) || !(high >= 0.0f)) return {0, -1};
  const int first = static_cast<int>(std::max(low, 0.0f)) / tile_size;
  const int last = static_cast<int>(std::min(high, static_cast<float>(pixels - 1))) / tile_size;
  return {first, last};
}

/// An edge as e(x, y) = a (x - x0) + b (y - y0), scaled so that at a pixel centre e >= 1 means that the whole pixel
/// lies inside and e < -1 that none of it does.
struct Edge {
  float a, b, x0, y0;
};
HWY_INLINE float at(const Edge& e, float x, float y) { return e.a * (x - e.x0) + e.b * (y - e.y0); }

/// Below this an edge runs along the rows, and cuts none of them.
inline constexpr float flat_edge = 1e-9f;

/// An edge crosses the row y at x0 + (level - b (y - y0)) / a for the level e = level. Prepared once per edge.
struct Crossing {
  float per_a, slack_per_a;
  HWY_INLINE explicit Crossing(const Edge& e)
      : per_a(std::abs(e.a) > flat_edge ? 1.0f / e.a : 0.0f), slack_per_a(4e-6f * std::abs(per_a)) {}
};

/// Columns of tiles for up to 16 rows of them: those that a shape can touch, and those that lie wholly inside of it
/// (none if inner_first > inner_last).
struct RowSpans {
  HWY_ALIGN std::int32_t first[tile_pixels], last[tile_pixels], inner_first[tile_pixels], inner_last[tile_pixels];
};

/// The pixels of a row of tiles (centres from y_low to y_high) that can lie inside an edge form an interval: cuts
/// [left, right] down to it, widened by a pixel; and those that certainly lie wholly inside: cuts [in_left, in_right].
/// A row of tiles per lane.
struct RowCut {
  hn::Vec<Float> left, right, in_left, in_right;
  HWY_INLINE void add(const Edge& e, const Crossing& c, hn::Vec<Float> y_low, hn::Vec<Float> y_high) {
    const Float d;
    const auto b = hn::Set(d, e.b), x0 = hn::Set(d, e.x0), y0 = hn::Set(d, e.y0), one = hn::Set(d, 1.0f);
    const auto low = hn::Mul(b, hn::Sub(y_low, y0)), high = hn::Mul(b, hn::Sub(y_high, y0));
    const auto best = hn::Max(low, high), worst = hn::Min(low, high);
    if (!(std::abs(e.a) > flat_edge)) {
      in_right = hn::IfThenElse(hn::Gt(worst, hn::Set(d, 1.001f)), in_right, hn::Neg(one));
      return;
    }
    const auto slack =
        hn::Mul(hn::Add(hn::Add(hn::Set(d, 2.0f), hn::Abs(best)), hn::Abs(worst)), hn::Set(d, c.slack_per_a));
    const auto per_a = hn::Set(d, c.per_a);
    const auto outer = hn::Add(x0, hn::Mul(hn::Sub(hn::Neg(one), best), per_a));
    const auto inner = hn::Add(x0, hn::Mul(hn::Sub(one, worst), per_a));
    const auto widened = hn::Add(one, slack), narrowed = hn::Add(hn::Set(d, 0.01f), slack);
    if (e.a > 0.0f) {
      left = hn::Max(left, hn::Sub(outer, widened));
      in_left = hn::Max(in_left, hn::Add(inner, narrowed));
    } else {
      right = hn::Min(right, hn::Add(outer, widened));
      in_right = hn::Min(in_right, hn::Sub(inner, narrowed));
    }
  }
};

/// The columns, of those given, that a convex shape of so many edges touches in 16 rows from `row` on; only the first
/// `needed` of them count.
template <std::size_t count>
HWY_INLINE void cut_rows(const Edge (&edges)[count], const Crossing (&crossings)[count], TileRange columns, int width,
                         int row, int needed, RowSpans& out) {
  const Float d;
  const Int di;
  const auto zero = hn::Zero(d), end = hn::Set(d, static_cast<float>(width)), one = hn::Set(d, 1.0f);
  const auto to_tile = [&](auto v) SIGHTLINE_INLINE_LAMBDA { return hn::ShiftRight<2>(hn::ConvertTo(di, v)); };
  for (std::size_t l = 0; l < tile_pixels && static_cast<int>(l) < needed; l += float_lanes()) {
    const auto rows = hn::Iota(d, static_cast<float>(row + static_cast<int>(l)));
    const auto y = hn::Add(hn::Mul(rows, hn::Set(d, static_cast<float>(tile_size))), hn::Set(d, 0.5f));
    const auto y_high = hn::Add(y, hn::Set(d, static_cast<float>(tile_size - 1)));
    RowCut cut{zero, hn::Sub(end, one), zero, end};
    for (std::size_t i = 0; i < count; ++i) cut.add(edges[i], crossings[i], y, y_high);
    const auto none = hn::Set(di, -1), first_column = hn::Set(di, columns.first),
               last_column = hn::Set(di, columns.last);
    const auto beyond = hn::Add(end, hn::Set(d, 8.0f));  // in pixels; its tile lies behind the last one
    const auto first = hn::Max(to_tile(hn::Min(cut.left, beyond)), first_column);
    const auto reached = hn::RebindMask(di, hn::Ge(cut.right, zero));
    const auto last = hn::IfThenElse(reached, hn::Min(to_tile(hn::Max(cut.right, zero)), last_column), none);
    hn::Store(first, di, out.first + l);
    hn::Store(last, di, out.last + l);
    // Tiles whose centres from the first to the last column lie within [in_left, in_right].
    const auto edge = hn::Set(d, 3.5f);
    const auto inner_first = hn::Max(first, to_tile(hn::Add(hn::Min(cut.in_left, beyond), edge)));
    const auto full = hn::RebindMask(di, hn::Ge(cut.in_right, edge));
    const auto inner_last = hn::IfThenElse(full, to_tile(hn::Max(hn::Sub(cut.in_right, edge), zero)), none);
    hn::Store(inner_first, di, out.inner_first + l);
    hn::Store(hn::Min(last, inner_last), di, out.inner_last + l);
  }
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
