// The loops of occlusion_kernels.hpp, compiled once per SIMD target. The idea
// (../../../docs/algorithms/occlusion_masked.md): a pixel square that no contour edge of an occluder's projection
// touches is covered wholly or not at all, and its centre tells which. A pixel that one triangle covers wholly is
// written at once; pixels that several triangles of the occluder share gather in a layer and are written at its end,
// unless a contour edge touched them. More than 400 lines because what is compiled once per target must be one file.

#if defined(SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#undef SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
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

/// Pixel offsets of the lanes of a tile, from the centre of its first pixel.
HWY_ALIGN inline constexpr float lane_x[tile_pixels] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
HWY_ALIGN inline constexpr float lane_y[tile_pixels] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

template <class Mask>
HWY_INLINE std::uint32_t bits_of(Float d, Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | (static_cast<std::uint32_t>(bytes[1]) << 8);
}

HWY_INLINE void touch(Tiles& tiles, std::size_t tile) {
  if (tiles.listed[tile] != 0) return;
  tiles.listed[tile] = 1;
  tiles.touched.push_back(static_cast<std::uint32_t>(tile));
}

/// Columns or rows of tiles; empty if first > last.
struct TileRange {
  int first, last;
};

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

/// The pixels of a row of tiles that can lie inside an edge form an interval: cuts [left, right] down to it, widened.
HWY_INLINE void cut_row(const Edge& e, float y_low, float y_high, float& left, float& right) {
  if (e.a == 0.0f) return;
  // e(x, y) >= -1  <=>  x >= x0 + (-1 - b (y - y0)) / a for a > 0; the best y is the one with the largest b y.
  const float y = e.b > 0.0f ? y_high : y_low;
  const float rise = e.b * (y - e.y0);
  const float x = e.x0 + (-1.0f - rise) / e.a;
  const float slack = 1.0f + (1.0f + std::abs(rise)) * 1e-6f / std::abs(e.a);
  if (e.a > 0.0f)
    left = std::max(left, x - slack);
  else
    right = std::min(right, x + slack);
}

/// Calls body(tile, x, y) for the tiles of a range that can lie inside all edges; x, y: centre of the tile's first
/// pixel.
template <int edge_count, class Body>
HWY_INLINE void for_tiles(const Tiles& tiles, TileRange columns, TileRange rows, const Edge* edges, Body&& body) {
  const bool cut = columns.last - columns.first > 2;
  for (int row = rows.first; row <= rows.last; ++row) {
    TileRange range = columns;
    const float y = static_cast<float>(row * tile_size) + 0.5f;
    if (cut) {
      float left = 0.0f, right = static_cast<float>(tiles.width - 1);
      for (int i = 0; i < edge_count; ++i) cut_row(edges[i], y, y + static_cast<float>(tile_size - 1), left, right);
      const TileRange inner = tile_range(left, right, tiles.width);
      if (inner.first > inner.last) continue;
      range = {std::max(range.first, inner.first), std::min(range.last, inner.last)};
    }
    const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across);
    for (int column = range.first; column <= range.last; ++column)
      body(base + static_cast<std::size_t>(column), static_cast<float>(column * tile_size) + 0.5f, y);
  }
}

/// A centre this little outside of a triangle (by its edges, scaled as above, and by its box, pixels) still counts as
/// covered, so that rounding opens no seam between two triangles. Safe because it is less than the margin by which
/// contour edges are widened; the box cuts off what the widened edges of a sliver would claim beyond its tips.
inline constexpr float edge_slack = 0.01f;
inline constexpr float box_slack = 0.004f;

/// Corners of up to 16 triangles, corner by corner.
struct Corners {
  HWY_ALIGN float x[3][tile_pixels], y[3][tile_pixels], near[3][tile_pixels];
};

/// What those triangles need in the tile loop.
struct Setups {
  HWY_ALIGN float a[3][tile_pixels], b[3][tile_pixels];              // edges, see Edge; they start at the corners
  HWY_ALIGN float gradient_x[tile_pixels], gradient_y[tile_pixels];  // nearness per pixel
  HWY_ALIGN float base[tile_pixels];   // nearness at the first corner, lowered to the least over a pixel square
  HWY_ALIGN float least[tile_pixels];  // nearness of the farthest corner, lowered
  HWY_ALIGN float low_x[tile_pixels], low_y[tile_pixels], high_x[tile_pixels],
      high_y[tile_pixels];  // box of the corners
  HWY_ALIGN std::int32_t first_column[tile_pixels], last_column[tile_pixels], first_row[tile_pixels],
      last_row[tile_pixels];
  std::uint32_t valid;  // bit per triangle: it has an area and may touch the image
};

template <class V>
HWY_INLINE V min3(V a, V b, V c) {
  return hn::Min(hn::Min(a, b), c);
}
template <class V>
HWY_INLINE V max3(V a, V b, V c) {
  return hn::Max(hn::Max(a, b), c);
}

/// Lanes [l, l + N) of the setups.
HWY_INLINE void set_up(const Corners& c, const Margins& margins, const Tiles& tiles, std::size_t l, Setups& out) {
  const Float d;
  const Int di;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f), margin = hn::Set(d, margins.pixels);
  const auto half = hn::Set(d, 0.5f + margins.pixels);
  const auto x0 = hn::Load(d, c.x[0] + l), x1 = hn::Load(d, c.x[1] + l), x2 = hn::Load(d, c.x[2] + l);
  const auto y0 = hn::Load(d, c.y[0] + l), y1 = hn::Load(d, c.y[1] + l), y2 = hn::Load(d, c.y[2] + l);
  const auto n0 = hn::Load(d, c.near[0] + l), n1 = hn::Load(d, c.near[1] + l), n2 = hn::Load(d, c.near[2] + l);
  const auto ux = hn::Sub(x1, x0), uy = hn::Sub(y1, y0), vx = hn::Sub(x2, x0), vy = hn::Sub(y2, y0);
  const auto area = hn::Sub(hn::Mul(ux, vy), hn::Mul(vx, uy));
  auto valid = hn::Gt(hn::Abs(area), zero);

  const auto sign = hn::IfThenElse(hn::Gt(area, zero), one, hn::Neg(one));
  const auto edge = [&](int i, auto from_x, auto from_y, auto to_x, auto to_y) {
    const auto a = hn::Mul(hn::Sub(from_y, to_y), sign), b = hn::Mul(hn::Sub(to_x, from_x), sign);
    const auto scale = hn::Div(one, hn::Mul(hn::Add(hn::Abs(a), hn::Abs(b)), half));
    valid = hn::And(valid, hn::Lt(scale, hn::Set(d, 1e20f)));  // else two corners coincide
    hn::Store(hn::Mul(a, scale), d, out.a[i] + l);
    hn::Store(hn::Mul(b, scale), d, out.b[i] + l);
  };
  edge(0, x0, y0, x1, y1);
  edge(1, x1, y1, x2, y2);
  edge(2, x2, y2, x0, y0);

  const auto lowered = [&](auto near, auto size) {
    return hn::Sub(near, hn::Add(hn::Mul(size, hn::Set(d, margins.nearness_share)), hn::Set(d, margins.nearness)));
  };
  const auto lowest = min3(n0, n1, n2);
  const auto least = lowered(lowest, hn::Abs(lowest));
  const auto length = [](auto x, auto y) { return hn::Add(hn::Abs(x), hn::Abs(y)); };
  const auto longest = max3(length(ux, uy), length(vx, vy), length(hn::Sub(vx, ux), hn::Sub(vy, uy)));
  // A sliver's gradient is noise: take its farthest corner for all of it.
  const auto sliver = hn::Lt(hn::Abs(area), hn::Mul(hn::Set(d, 0.25f), longest));
  const auto du = hn::Sub(n1, n0), dv = hn::Sub(n2, n0);
  const auto gx = hn::Div(hn::Sub(hn::Mul(du, vy), hn::Mul(dv, uy)), area);
  const auto gy = hn::Div(hn::Sub(hn::Mul(dv, ux), hn::Mul(du, vx)), area);
  const auto drop = hn::Mul(length(gx, gy), half);
  const auto base = lowered(hn::Sub(n0, drop), max3(hn::Abs(n0), hn::Abs(n1), hn::Abs(n2)));
  hn::Store(hn::IfThenElse(sliver, zero, gx), d, out.gradient_x + l);
  hn::Store(hn::IfThenElse(sliver, zero, gy), d, out.gradient_y + l);
  hn::Store(hn::IfThenElse(sliver, least, base), d, out.base + l);
  hn::Store(least, d, out.least + l);

  const auto range = [&](auto low, auto high, int pixels, float* low_out, float* high_out, std::int32_t* first,
                         std::int32_t* last) {
    hn::Store(low, d, low_out + l);
    hn::Store(high, d, high_out + l);
    const auto end = hn::Set(d, static_cast<float>(pixels));
    low = hn::Sub(low, margin);
    high = hn::Add(high, margin);
    valid = hn::And(valid, hn::And(hn::Lt(low, end), hn::Ge(high, zero)));
    const auto to_tile = [&](auto v) {
      return hn::ShiftRight<2>(hn::ConvertTo(di, hn::Min(hn::Max(v, zero), hn::Sub(end, one))));
    };
    hn::Store(to_tile(low), di, first + l);
    hn::Store(to_tile(high), di, last + l);
  };
  range(min3(x0, x1, x2), max3(x0, x1, x2), tiles.width, out.low_x, out.high_x, out.first_column, out.last_column);
  range(min3(y0, y1, y2), max3(y0, y1, y2), tiles.height, out.low_y, out.high_y, out.first_row, out.last_row);
  out.valid |= bits_of(d, valid) << l;
}

/// Triangle t of the setups, in the pixels of lanes [l, l + N) of all tiles that it may touch.
HWY_INLINE void fill_lanes(const Corners& c, const Setups& s, std::size_t t, const Margins& margins, std::size_t l,
                           Tiles& tiles, FillCounts& counts) {
  const Float d;
  const Edge edges[3] = {{s.a[0][t], s.b[0][t], c.x[0][t], c.y[0][t]},
                         {s.a[1][t], s.b[1][t], c.x[1][t], c.y[1][t]},
                         {s.a[2][t], s.b[2][t], c.x[2][t], c.y[2][t]}};
  const auto lx = hn::Load(d, lane_x + l), ly = hn::Load(d, lane_y + l);
  const auto step = [&](float a, float b) { return hn::Add(hn::Mul(hn::Set(d, a), lx), hn::Mul(hn::Set(d, b), ly)); };
  const auto step0 = step(edges[0].a, edges[0].b), step1 = step(edges[1].a, edges[1].b),
             step2 = step(edges[2].a, edges[2].b), step_near = step(s.gradient_x[t], s.gradient_y[t]);
  const auto least = hn::Set(d, s.least[t]);
  const float first_x = c.x[0][t], first_y = c.y[0][t];
  const auto body = [&](std::size_t tile, float x, float y) SIGHTLINE_INLINE_LAMBDA {
    const auto inside =
        min3(hn::Add(hn::Set(d, at(edges[0], x, y)), step0), hn::Add(hn::Set(d, at(edges[1], x, y)), step1),
             hn::Add(hn::Set(d, at(edges[2], x, y)), step2));
    const auto touches = hn::Ge(inside, hn::Set(d, -1.0f));
    if (hn::AllFalse(d, touches)) return;
    ++counts.tiles;
    const auto whole = hn::Ge(inside, hn::Set(d, 1.0f));
    const float near0 = s.base[t] + (s.gradient_x[t] * (x - first_x) + s.gradient_y[t] * (y - first_y));
    const auto near = hn::Max(hn::Add(hn::Set(d, near0), step_near), least);
    float* hidden = tiles.hidden.data() + tile * tile_pixels + l;
    const auto old = hn::LoadU(d, hidden);
    hn::StoreU(hn::IfThenElse(whole, hn::Max(old, near), old), d, hidden);
    auto shared = hn::AndNot(whole, touches);
    if (hn::AllFalse(d, shared)) return;
    const auto px = hn::Add(hn::Set(d, x), lx), py = hn::Add(hn::Set(d, y), ly);
    const auto in_box = [&](float slack) {
      return hn::And(hn::And(hn::Ge(px, hn::Set(d, s.low_x[t] - slack)), hn::Le(px, hn::Set(d, s.high_x[t] + slack))),
                     hn::And(hn::Ge(py, hn::Set(d, s.low_y[t] - slack)), hn::Le(py, hn::Set(d, s.high_y[t] + slack))));
    };
    shared = hn::And(shared, in_box(0.5f + margins.pixels));
    float* layer = tiles.layer.data() + tile * tile_pixels + l;
    const auto gathered = hn::LoadU(d, layer);
    hn::StoreU(hn::IfThenElse(shared, hn::Min(gathered, near), gathered), d, layer);
    const auto centre = hn::And(hn::Ge(inside, hn::Set(d, -edge_slack)), in_box(box_slack));
    const std::uint32_t covered = bits_of(d, hn::And(shared, centre)) << l;
    tiles.covered[tile] = static_cast<std::uint16_t>(tiles.covered[tile] | covered);
    touch(tiles, tile);
  };
  for_tiles<3>(tiles, {s.first_column[t], s.last_column[t]}, {s.first_row[t], s.last_row[t]}, edges, body);
}

/// Fills the first `count` triangles of the corners.
HWY_INLINE void fill(const Corners& c, std::size_t count, const Margins& margins, Tiles& tiles, FillCounts& counts) {
  Setups setups;
  setups.valid = 0;
  for (std::size_t l = 0; l < count; l += float_lanes()) set_up(c, margins, tiles, l, setups);
  for (std::size_t t = 0; t < count; ++t) {
    if (((setups.valid >> t) & 1u) == 0) continue;
    ++counts.triangles;
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) fill_lanes(c, setups, t, margins, l, tiles, counts);
  }
}

/// Marks every pixel whose square, widened by the margin, the segment touches (separating axes: x, y, its normal).
HWY_INLINE void mark(const ScreenPoint& p, const ScreenPoint& q, const Margins& margins, Tiles& tiles,
                     FillCounts& counts) {
  const Float d;
  const float low_x = std::min(p.x, q.x) - margins.pixels, high_x = std::max(p.x, q.x) + margins.pixels;
  const float low_y = std::min(p.y, q.y) - margins.pixels, high_y = std::max(p.y, q.y) + margins.pixels;
  const TileRange columns = tile_range(low_x, high_x, tiles.width), rows = tile_range(low_y, high_y, tiles.height);
  if (columns.first > columns.last || rows.first > rows.last) return;
  ++counts.contour_edges;
  const float a = p.y - q.y, b = q.x - p.x, length = std::abs(a) + std::abs(b);
  const float scale = length > 1e-20f ? 1.0f / (length * (0.5f + margins.pixels)) : 0.0f;  // a point: its box decides
  const Edge sides[2] = {{a * scale, b * scale, p.x, p.y}, {-a * scale, -b * scale, p.x, p.y}};
  for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
    const auto lx = hn::Load(d, lane_x + l), ly = hn::Load(d, lane_y + l);
    const auto step = hn::Add(hn::Mul(hn::Set(d, sides[0].a), lx), hn::Mul(hn::Set(d, sides[0].b), ly));
    for_tiles<2>(tiles, columns, rows, sides, [&](std::size_t tile, float x, float y) SIGHTLINE_INLINE_LAMBDA {
      const auto cx = hn::Add(hn::Set(d, x), lx), cy = hn::Add(hn::Set(d, y), ly);
      auto hit = hn::Le(hn::Abs(hn::Add(hn::Set(d, at(sides[0], x, y)), step)), hn::Set(d, 1.0f));
      hit = hn::And(hit, hn::And(hn::Ge(cx, hn::Set(d, low_x - 0.5f)), hn::Le(cx, hn::Set(d, high_x + 0.5f))));
      hit = hn::And(hit, hn::And(hn::Ge(cy, hn::Set(d, low_y - 0.5f)), hn::Le(cy, hn::Set(d, high_y + 0.5f))));
      const std::uint32_t bits = bits_of(d, hit) << l;
      if (bits == 0) return;
      tiles.contour[tile] = static_cast<std::uint16_t>(tiles.contour[tile] | bits);
      touch(tiles, tile);
    });
  }
}

/// Vertices to pixels.
HWY_INLINE void project(const OccluderMesh& mesh, const ScreenTransform& t, Scratch& out) {
  const Float d;
  const auto row = [&](const float* m, auto dx, auto dy, auto dz) {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0]), dx), hn::Mul(hn::Set(d, m[1]), dy)),
                   hn::Mul(hn::Set(d, m[2]), dz));
  };
  const auto relative = [&](const std::vector<float>& p, std::size_t i, int axis) {
    return hn::Sub(hn::Sub(hn::LoadU(d, p.data() + i), hn::Set(d, t.eye_high[axis])), hn::Set(d, t.eye_low[axis]));
  };
  for (std::size_t i = 0; i < mesh.vertex_count; i += float_lanes()) {
    const auto dx = relative(mesh.x, i, 0), dy = relative(mesh.y, i, 1), dz = relative(mesh.z, i, 2);
    auto x = row(t.to_x, dx, dy, dz), y = row(t.to_y, dx, dy, dz);
    const auto w = row(t.to_w, dx, dy, dz);
    auto near = hn::Neg(w);
    if (t.perspective) {
      near = hn::Div(hn::Set(d, 1.0f), w);
      x = hn::Mul(x, near);
      y = hn::Mul(y, near);
    }
    hn::StoreU(hn::Add(x, hn::Set(d, t.centre_x)), d, out.x.data() + i);
    hn::StoreU(hn::Add(y, hn::Set(d, t.centre_y)), d, out.y.data() + i);
    hn::StoreU(near, d, out.near.data() + i);
  }
}

/// Fills `facing` of every triangle: > 0 front, < 0 back, 0 without area; and the two slots that are no triangle.
HWY_INLINE void face(const OccluderMesh& mesh, bool mirrored, Scratch& s) {
  const Float d;
  const Int di;
  for (std::size_t i = 0; i < mesh.triangle_count; i += float_lanes()) {
    const auto c0 = hn::LoadU(di, mesh.corner0.data() + i), c1 = hn::LoadU(di, mesh.corner1.data() + i),
               c2 = hn::LoadU(di, mesh.corner2.data() + i);
    const auto x0 = hn::GatherIndex(d, s.x.data(), c0), y0 = hn::GatherIndex(d, s.y.data(), c0);
    const auto ux = hn::Sub(hn::GatherIndex(d, s.x.data(), c1), x0),
               uy = hn::Sub(hn::GatherIndex(d, s.y.data(), c1), y0);
    const auto vx = hn::Sub(hn::GatherIndex(d, s.x.data(), c2), x0),
               vy = hn::Sub(hn::GatherIndex(d, s.y.data(), c2), y0);
    const auto area = hn::Sub(hn::Mul(vx, uy), hn::Mul(ux, vy));
    hn::StoreU(mirrored ? hn::Neg(area) : area, d, s.facing.data() + i);
  }
  s.facing[mesh.triangle_count] = 0.0f;
}

/// Fills `list` with the triangles whose facing has this sign and whose box meets the image. Returns their number.
HWY_INLINE std::size_t find_triangles(const OccluderMesh& mesh, float sign, const Margins& margins, const Tiles& tiles,
                                      Scratch& s) {
  const Float d;
  const Int di;
  const auto right = hn::Set(d, static_cast<float>(tiles.width) + margins.pixels);
  const auto bottom = hn::Set(d, static_cast<float>(tiles.height) + margins.pixels);
  const auto before = hn::Set(d, -margins.pixels);
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.triangle_count; i += float_lanes()) {
    auto drawn = hn::Gt(hn::Mul(hn::LoadU(d, s.facing.data() + i), hn::Set(d, sign)), hn::Zero(d));
    drawn = hn::And(drawn, hn::FirstN(d, std::min(float_lanes(), static_cast<std::size_t>(mesh.triangle_count) - i)));
    if (hn::AllFalse(d, drawn)) continue;
    const auto c0 = hn::LoadU(di, mesh.corner0.data() + i), c1 = hn::LoadU(di, mesh.corner1.data() + i),
               c2 = hn::LoadU(di, mesh.corner2.data() + i);
    const auto meets = [&](const std::vector<float>& p, auto low, auto high) {
      const auto p0 = hn::GatherIndex(d, p.data(), c0), p1 = hn::GatherIndex(d, p.data(), c1),
                 p2 = hn::GatherIndex(d, p.data(), c2);
      return hn::And(hn::Ge(hn::Max(hn::Max(p0, p1), p2), low), hn::Le(hn::Min(hn::Min(p0, p1), p2), high));
    };
    drawn = hn::And(drawn, hn::And(meets(s.x, before, right), meets(s.y, before, bottom)));
    const auto ids = hn::Iota(di, static_cast<std::int32_t>(i));
    count += hn::CompressStore(ids, hn::RebindMask(di, drawn), di, s.list.data() + count);
  }
  return count;
}

/// Fills `edge_list` with the contours of the triangles whose facing has this sign: edges that do not join two of them.
/// Returns their number.
HWY_INLINE std::size_t find_contours(const OccluderMesh& mesh, float sign, Scratch& s) {
  const Float d;
  const Int di;
  const auto zero = hn::Zero(d), direction = hn::Set(d, sign);
  s.facing[mesh.triangle_count + 1] = sign;
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.edge_count; i += float_lanes()) {
    const auto drawn = [&](const std::vector<std::int32_t>& triangles) {
      const auto facing = hn::GatherIndex(d, s.facing.data(), hn::LoadU(di, triangles.data() + i));
      return hn::Gt(hn::Mul(facing, direction), zero);
    };
    const auto first = drawn(mesh.edge_first), second = drawn(mesh.edge_second);
    const auto inner = hn::And(hn::And(first, second), hn::Gt(hn::LoadU(d, mesh.edge_winding.data() + i), zero));
    auto contour = hn::AndNot(inner, hn::Or(first, second));
    contour = hn::And(contour, hn::FirstN(d, std::min(float_lanes(), static_cast<std::size_t>(mesh.edge_count) - i)));
    const auto ids = hn::Iota(di, static_cast<std::int32_t>(i));
    count += hn::CompressStore(ids, hn::RebindMask(di, contour), di, s.edge_list.data() + count);
  }
  return count;
}

HWY_INLINE ScreenPoint point(const Scratch& s, std::int32_t vertex) {
  const auto v = static_cast<std::size_t>(vertex);
  return {s.x[v], s.y[v], s.near[v]};
}

HWY_INLINE void take_triangle(const OccluderMesh& mesh, const Scratch& s, std::size_t t, Corners& corners,
                              std::size_t at) {
  const std::int32_t vertices[3] = {mesh.corner0[t], mesh.corner1[t], mesh.corner2[t]};
  for (int i = 0; i < 3; ++i) {
    const auto v = static_cast<std::size_t>(vertices[i]);
    corners.x[i][at] = s.x[v];
    corners.y[i][at] = s.y[v];
    corners.near[i][at] = s.near[v];
  }
}

inline void commit(Tiles& tiles) {
  const Float d;
  const auto empty = hn::Set(d, std::numeric_limits<float>::infinity());
  for (const std::uint32_t tile : tiles.touched) {
    const auto proven = static_cast<std::uint32_t>(tiles.covered[tile] & ~tiles.contour[tile]);
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      float* layer = tiles.layer.data() + tile * tile_pixels + l;
      float* hidden = tiles.hidden.data() + tile * tile_pixels + l;
      std::uint8_t bytes[8] = {static_cast<std::uint8_t>(proven >> l), static_cast<std::uint8_t>(proven >> l >> 8)};
      const auto mask = hn::LoadMaskBits(d, bytes);
      const auto old = hn::LoadU(d, hidden);
      hn::StoreU(hn::IfThenElse(mask, hn::Max(old, hn::LoadU(d, layer)), old), d, hidden);
      hn::StoreU(empty, d, layer);
    }
    tiles.covered[tile] = tiles.contour[tile] = 0;
    tiles.listed[tile] = 0;
  }
  tiles.touched.clear();
}

/// Draws the triangles whose facing has this sign, component by component.
HWY_INLINE void draw_side(const OccluderMesh& mesh, float sign, const Margins& margins, Tiles& tiles, Scratch& s,
                          FillCounts& counts) {
  const std::size_t triangles = find_triangles(mesh, sign, margins, tiles, s);
  if (triangles == 0) return;
  const std::size_t contours = find_contours(mesh, sign, s);
  std::size_t triangle = 0, contour = 0;
  for (std::size_t c = 0; triangle < triangles; ++c) {
    const auto last = static_cast<std::int32_t>(mesh.triangle_begin[c + 1]);
    if (s.list[triangle] >= last) continue;
    while (triangle < triangles && s.list[triangle] < last) {
      Corners corners;
      std::size_t count = 0;
      for (; count < tile_pixels && triangle < triangles && s.list[triangle] < last; ++count, ++triangle)
        take_triangle(mesh, s, static_cast<std::size_t>(s.list[triangle]), corners, count);
      fill(corners, count, margins, tiles, counts);
    }
    const auto first_edge = static_cast<std::int32_t>(mesh.edge_begin[c]);
    const auto last_edge = static_cast<std::int32_t>(mesh.edge_begin[c + 1]);
    for (; contour < contours && s.edge_list[contour] < last_edge; ++contour) {
      const auto e = static_cast<std::size_t>(s.edge_list[contour]);
      if (s.edge_list[contour] >= first_edge)
        mark(point(s, mesh.edge_from[e]), point(s, mesh.edge_to[e]), margins, tiles, counts);
    }
    commit(tiles);
  }
}

inline void draw_mesh(const OccluderMesh& mesh, const ScreenTransform& transform, bool mirrored, const Margins& margins,
                      Tiles& tiles, Scratch& s, FillCounts& counts) {
  constexpr std::size_t padding = 2 * tile_pixels;
  if (s.x.size() < mesh.vertex_count + padding)
    for (auto* array : {&s.x, &s.y, &s.near}) array->resize(mesh.vertex_count + padding);
  if (s.facing.size() < mesh.triangle_count + padding) s.facing.resize(mesh.triangle_count + padding);
  if (s.list.size() < mesh.triangle_count + padding) s.list.resize(mesh.triangle_count + padding);
  if (s.edge_list.size() < mesh.edge_count + padding) s.edge_list.resize(mesh.edge_count + padding);
  project(mesh, transform, s);
  face(mesh, mirrored, s);
  draw_side(mesh, 1.0f, margins, tiles, s, counts);
  if (!mesh.closed) draw_side(mesh, -1.0f, margins, tiles, s, counts);
}

inline void fill_triangle(const ScreenPoint* points, const Margins& margins, Tiles& tiles, FillCounts& counts) {
  Corners corners{};
  for (int i = 0; i < 3; ++i) {
    corners.x[i][0] = points[i].x;
    corners.y[i][0] = points[i].y;
    corners.near[i][0] = points[i].near;
  }
  fill(corners, 1, margins, tiles, counts);
}
inline void mark_contour(const ScreenPoint& p, const ScreenPoint& q, const Margins& margins, Tiles& tiles,
                         FillCounts& counts) {
  mark(p, q, margins, tiles, counts);
}

inline void reduce(Tiles& tiles) {
  const Float d;
  const std::size_t count = tiles.farthest.size();
  for (std::size_t tile = 0; tile < count; ++tile) {
    auto least = hn::Set(d, std::numeric_limits<float>::infinity());
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes())
      least = hn::Min(least, hn::LoadU(d, tiles.hidden.data() + tile * tile_pixels + l));
    tiles.farthest[tile] = hn::GetLane(hn::MinOfLanes(d, least));
  }
}

inline bool hides(const Tiles& tiles, int x0, int y0, int x1, int y1, float near) {
  const Float d;
  const auto limit = hn::Set(d, near);
  const auto left = hn::Set(d, static_cast<float>(x0)), right = hn::Set(d, static_cast<float>(x1));
  const auto top = hn::Set(d, static_cast<float>(y0)), bottom = hn::Set(d, static_cast<float>(y1));
  for (int row = y0 / tile_size; row <= (y1 - 1) / tile_size; ++row)
    for (int column = x0 / tile_size; column <= (x1 - 1) / tile_size; ++column) {
      const std::size_t tile =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across) + static_cast<std::size_t>(column);
      if (tiles.farthest[tile] > near) continue;
      const auto first_x = hn::Set(d, static_cast<float>(column * tile_size));
      const auto first_y = hn::Set(d, static_cast<float>(row * tile_size));
      for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
        const auto px = hn::Add(first_x, hn::Load(d, lane_x + l)), py = hn::Add(first_y, hn::Load(d, lane_y + l));
        auto open = hn::Le(hn::LoadU(d, tiles.hidden.data() + tile * tile_pixels + l), limit);
        open = hn::And(open, hn::And(hn::Ge(px, left), hn::Lt(px, right)));
        open = hn::And(open, hn::And(hn::Ge(py, top), hn::Lt(py, bottom)));
        if (!hn::AllFalse(d, open)) return false;
      }
    }
  return true;
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
