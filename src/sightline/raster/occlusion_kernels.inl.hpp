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

/// Tiles that pixels from low to high (real coordinates) fall in, clamped to the image; empty if first > last.
struct TileRange {
  int first, last;
};
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
HWY_INLINE Edge make_edge(float x0, float y0, float x1, float y1, float sign, float margin) {
  const float a = (y0 - y1) * sign, b = (x1 - x0) * sign;
  const float scale = 1.0f / ((std::abs(a) + std::abs(b)) * (0.5f + margin));
  return {a * scale, b * scale, x0, y0};
}
HWY_INLINE float at(const Edge& e, float x, float y) { return e.a * (x - e.x0) + e.b * (y - e.y0); }

/// A centre this little outside of a triangle (by its edges, scaled as above, and by its box, pixels) still counts as
/// covered, so that rounding opens no seam between two triangles. Safe because it is less than the margin by which
/// contour edges are widened; the box cuts off what the widened edges of a sliver would claim beyond its tips.
inline constexpr float edge_slack = 0.01f;
inline constexpr float box_slack = 0.004f;

/// What a triangle needs in the tile loop.
struct Setup {
  Edge edges[3];
  float gradient_x, gradient_y;        // nearness per pixel
  float x0, y0, base;                  // nearness at (x0, y0), lowered to the least over a pixel square
  float least;                         // nearness of the farthest corner, lowered
  float low_x, low_y, high_x, high_y;  // box of the corners
};

/// False for a triangle without area.
HWY_INLINE bool make_setup(const ScreenPoint* p, const Margins& margins, Setup& s) {
  const float ux = p[1].x - p[0].x, uy = p[1].y - p[0].y, vx = p[2].x - p[0].x, vy = p[2].y - p[0].y;
  const float area = ux * vy - vx * uy;
  if (!(std::abs(area) > 0.0f)) return false;
  const float sign = area > 0.0f ? 1.0f : -1.0f;
  for (int i = 0; i < 3; ++i) {
    const ScreenPoint &from = p[i], &to = p[(i + 1) % 3];
    s.edges[i] = make_edge(from.x, from.y, to.x, to.y, sign, margins.pixels);
    if (!(std::abs(s.edges[i].a) + std::abs(s.edges[i].b) < 1e30f)) return false;  // two corners coincide
  }
  const float lowest = std::min(std::min(p[0].near, p[1].near), p[2].near);
  s.least = lowest - (std::abs(lowest) * margins.nearness_share + margins.nearness);
  const float du = p[1].near - p[0].near, dv = p[2].near - p[0].near;
  const float longest = std::max(std::max(std::abs(ux) + std::abs(uy), std::abs(vx) + std::abs(vy)),
                                 std::abs(vx - ux) + std::abs(vy - uy));
  s.x0 = p[0].x;
  s.y0 = p[0].y;
  s.low_x = std::min(std::min(p[0].x, p[1].x), p[2].x);
  s.low_y = std::min(std::min(p[0].y, p[1].y), p[2].y);
  s.high_x = std::max(std::max(p[0].x, p[1].x), p[2].x);
  s.high_y = std::max(std::max(p[0].y, p[1].y), p[2].y);
  if (std::abs(area) < 0.25f * longest) {  // a sliver: its gradient is noise, so take its farthest corner for all of it
    s.gradient_x = s.gradient_y = 0.0f;
    s.base = s.least;
    return true;
  }
  s.gradient_x = (du * vy - dv * uy) / area;
  s.gradient_y = (dv * ux - du * vx) / area;
  const float reach = (std::abs(s.gradient_x) + std::abs(s.gradient_y)) * (0.5f + margins.pixels);
  const float highest = std::max(std::max(std::abs(p[0].near), std::abs(p[1].near)), std::abs(p[2].near));
  s.base = p[0].near - reach - (highest * margins.nearness_share + margins.nearness);
  return true;
}

/// One tile of one triangle. x, y: centre of the tile's first pixel.
HWY_INLINE void fill_tile(const Setup& s, std::size_t tile, float x, float y, Tiles& tiles) {
  const Float d;
  const auto e0 = hn::Set(d, at(s.edges[0], x, y));
  const auto e1 = hn::Set(d, at(s.edges[1], x, y));
  const auto e2 = hn::Set(d, at(s.edges[2], x, y));
  const auto n0 = hn::Set(d, s.base + (s.gradient_x * (x - s.x0) + s.gradient_y * (y - s.y0)));
  std::uint32_t covered = 0, partial = 0;
  for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
    const auto lx = hn::Load(d, lane_x + l), ly = hn::Load(d, lane_y + l);
    const auto step = [&](float a, float b) { return hn::Add(hn::Mul(hn::Set(d, a), lx), hn::Mul(hn::Set(d, b), ly)); };
    const auto inside =
        hn::Min(hn::Min(hn::Add(e0, step(s.edges[0].a, s.edges[0].b)), hn::Add(e1, step(s.edges[1].a, s.edges[1].b))),
                hn::Add(e2, step(s.edges[2].a, s.edges[2].b)));
    const auto touches = hn::Ge(inside, hn::Set(d, -1.0f));
    if (hn::AllFalse(d, touches)) continue;
    const auto whole = hn::Ge(inside, hn::Set(d, 1.0f));
    const auto near = hn::Max(hn::Add(n0, step(s.gradient_x, s.gradient_y)), hn::Set(d, s.least));
    float* hidden = tiles.hidden.data() + tile * tile_pixels + l;
    const auto old = hn::LoadU(d, hidden);
    hn::StoreU(hn::IfThenElse(whole, hn::Max(old, near), old), d, hidden);
    const auto in_box = [&](float slack) {
      const auto px = hn::Add(hn::Set(d, x), lx), py = hn::Add(hn::Set(d, y), ly);
      return hn::And(hn::And(hn::Ge(px, hn::Set(d, s.low_x - slack)), hn::Le(px, hn::Set(d, s.high_x + slack))),
                     hn::And(hn::Ge(py, hn::Set(d, s.low_y - slack)), hn::Le(py, hn::Set(d, s.high_y + slack))));
    };
    const auto shared = hn::And(hn::AndNot(whole, touches), in_box(0.5f + box_slack));
    const std::uint32_t shared_bits = bits_of(d, shared);
    if (shared_bits == 0) continue;
    float* layer = tiles.layer.data() + tile * tile_pixels + l;
    const auto gathered = hn::LoadU(d, layer);
    hn::StoreU(hn::IfThenElse(shared, hn::Min(gathered, near), gathered), d, layer);
    partial |= shared_bits << l;
    const auto centre = hn::And(hn::Ge(inside, hn::Set(d, -edge_slack)), in_box(box_slack));
    covered |= bits_of(d, hn::And(shared, centre)) << l;
  }
  if (partial == 0) return;
  tiles.covered[tile] = static_cast<std::uint16_t>(tiles.covered[tile] | covered);
  touch(tiles, tile);
}

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

HWY_INLINE void fill(const ScreenPoint* p, const Margins& margins, Tiles& tiles, FillCounts& counts) {
  const float low_x = std::min(std::min(p[0].x, p[1].x), p[2].x) - margins.pixels;
  const float high_x = std::max(std::max(p[0].x, p[1].x), p[2].x) + margins.pixels;
  const float low_y = std::min(std::min(p[0].y, p[1].y), p[2].y) - margins.pixels;
  const float high_y = std::max(std::max(p[0].y, p[1].y), p[2].y) + margins.pixels;
  const TileRange columns = tile_range(low_x, high_x, tiles.width), rows = tile_range(low_y, high_y, tiles.height);
  if (columns.first > columns.last || rows.first > rows.last) return;
  Setup s;
  if (!make_setup(p, margins, s)) return;
  ++counts.triangles;
  const bool cut = columns.last - columns.first > 2;
  for (int row = rows.first; row <= rows.last; ++row) {
    TileRange range = columns;
    const float y = static_cast<float>(row * tile_size) + 0.5f;
    if (cut) {
      float left = 0.0f, right = static_cast<float>(tiles.width - 1);
      for (const Edge& e : s.edges) cut_row(e, y, y + static_cast<float>(tile_size - 1), left, right);
      const TileRange inner = tile_range(left, right, tiles.width);
      if (inner.first > inner.last) continue;
      range = {std::max(range.first, inner.first), std::min(range.last, inner.last)};
    }
    const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across);
    for (int column = range.first; column <= range.last; ++column)
      fill_tile(s, base + static_cast<std::size_t>(column), static_cast<float>(column * tile_size) + 0.5f, y, tiles);
    counts.tiles += static_cast<std::uint64_t>(std::max(0, range.last - range.first + 1));
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
  Edge e = make_edge(p.x, p.y, q.x, q.y, 1.0f, margins.pixels);
  if (!(std::abs(e.a) + std::abs(e.b) < 1e30f)) e = {0.0f, 0.0f, p.x, p.y};  // a point: its box decides
  const bool cut = columns.last - columns.first > 2;
  const Edge reverse{-e.a, -e.b, e.x0, e.y0};
  for (int row = rows.first; row <= rows.last; ++row) {
    TileRange range = columns;
    const float y = static_cast<float>(row * tile_size) + 0.5f;
    if (cut) {
      float left = 0.0f, right = static_cast<float>(tiles.width - 1);
      cut_row(e, y, y + static_cast<float>(tile_size - 1), left, right);
      cut_row(reverse, y, y + static_cast<float>(tile_size - 1), left, right);
      const TileRange inner = tile_range(left, right, tiles.width);
      if (inner.first > inner.last) continue;
      range = {std::max(range.first, inner.first), std::min(range.last, inner.last)};
    }
    for (int column = range.first; column <= range.last; ++column) {
      const float x = static_cast<float>(column * tile_size) + 0.5f;
      const std::size_t tile =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across) + static_cast<std::size_t>(column);
      const auto e0 = hn::Set(d, at(e, x, y));
      std::uint32_t bits = 0;
      for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
        const auto lx = hn::Load(d, lane_x + l), ly = hn::Load(d, lane_y + l);
        const auto cx = hn::Add(hn::Set(d, x), lx), cy = hn::Add(hn::Set(d, y), ly);
        const auto value = hn::Add(e0, hn::Add(hn::Mul(hn::Set(d, e.a), lx), hn::Mul(hn::Set(d, e.b), ly)));
        auto hit = hn::Le(hn::Abs(value), hn::Set(d, 1.0f));
        hit = hn::And(hit, hn::And(hn::Ge(cx, hn::Set(d, low_x - 0.5f)), hn::Le(cx, hn::Set(d, high_x + 0.5f))));
        hit = hn::And(hit, hn::And(hn::Ge(cy, hn::Set(d, low_y - 0.5f)), hn::Le(cy, hn::Set(d, high_y + 0.5f))));
        bits |= bits_of(d, hit) << l;
      }
      if (bits == 0) continue;
      tiles.contour[tile] = static_cast<std::uint16_t>(tiles.contour[tile] | bits);
      touch(tiles, tile);
    }
  }
}

/// Vertices to pixels, and facing of every triangle: > 0 front, < 0 back, 0 not drawn.
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

/// Fills `facing`, and `list` with the triangles that face the right way and whose box meets the image. Returns their
/// number.
HWY_INLINE std::size_t classify(const OccluderMesh& mesh, bool mirrored, const Margins& margins, const Tiles& tiles,
                                Scratch& s) {
  const Float d;
  const Int di;
  const auto right = hn::Set(d, static_cast<float>(tiles.width) + margins.pixels);
  const auto bottom = hn::Set(d, static_cast<float>(tiles.height) + margins.pixels);
  const auto before = hn::Set(d, -margins.pixels);
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.triangle_count; i += float_lanes()) {
    const auto c0 = hn::LoadU(di, mesh.corner0.data() + i), c1 = hn::LoadU(di, mesh.corner1.data() + i),
               c2 = hn::LoadU(di, mesh.corner2.data() + i);
    const auto x0 = hn::GatherIndex(d, s.x.data(), c0), x1 = hn::GatherIndex(d, s.x.data(), c1),
               x2 = hn::GatherIndex(d, s.x.data(), c2);
    const auto y0 = hn::GatherIndex(d, s.y.data(), c0), y1 = hn::GatherIndex(d, s.y.data(), c1),
               y2 = hn::GatherIndex(d, s.y.data(), c2);
    auto area = hn::Sub(hn::Mul(hn::Sub(x2, x0), hn::Sub(y1, y0)), hn::Mul(hn::Sub(x1, x0), hn::Sub(y2, y0)));
    if (mirrored) area = hn::Neg(area);
    if (mesh.closed) area = hn::Max(area, hn::Zero(d));
    hn::StoreU(area, d, s.facing.data() + i);
    auto drawn = hn::Ne(area, hn::Zero(d));
    drawn = hn::And(drawn,
                    hn::And(hn::Ge(hn::Max(hn::Max(x0, x1), x2), before), hn::Le(hn::Min(hn::Min(x0, x1), x2), right)));
    drawn = hn::And(
        drawn, hn::And(hn::Ge(hn::Max(hn::Max(y0, y1), y2), before), hn::Le(hn::Min(hn::Min(y0, y1), y2), bottom)));
    drawn = hn::And(drawn, hn::FirstN(d, std::min(float_lanes(), static_cast<std::size_t>(mesh.triangle_count) - i)));
    count += hn::CompressStore(hn::Iota(di, static_cast<std::int32_t>(i)), hn::RebindMask(di, drawn), di,
                               s.list.data() + count);
  }
  s.facing[mesh.triangle_count] = 0.0f;
  s.facing[mesh.triangle_count + 1] = 1.0f;
  return count;
}

/// Fills `list` with the edges that are contours in this view. Returns their number.
HWY_INLINE std::size_t find_contours(const OccluderMesh& mesh, Scratch& s) {
  const Float d;
  const Int di;
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.edge_count; i += float_lanes()) {
    const auto f0 = hn::GatherIndex(d, s.facing.data(), hn::LoadU(di, mesh.edge_first.data() + i));
    const auto f1 = hn::Mul(hn::GatherIndex(d, s.facing.data(), hn::LoadU(di, mesh.edge_second.data() + i)),
                            hn::LoadU(d, mesh.edge_winding.data() + i));
    const auto zero = hn::Zero(d);
    const auto inner = hn::Or(hn::And(hn::Gt(f0, zero), hn::Gt(f1, zero)), hn::And(hn::Lt(f0, zero), hn::Lt(f1, zero)));
    const auto drawn = hn::Or(hn::Ne(f0, zero), hn::Ne(f1, zero));
    auto contour = hn::AndNot(inner, drawn);
    contour = hn::And(contour, hn::FirstN(d, std::min(float_lanes(), static_cast<std::size_t>(mesh.edge_count) - i)));
    count += hn::CompressStore(hn::Iota(di, static_cast<std::int32_t>(i)), hn::RebindMask(di, contour), di,
                               s.list.data() + count);
  }
  return count;
}

HWY_INLINE ScreenPoint point(const Scratch& s, std::int32_t vertex) {
  const auto v = static_cast<std::size_t>(vertex);
  return {s.x[v], s.y[v], s.near[v]};
}

inline void draw_mesh(const OccluderMesh& mesh, const ScreenTransform& transform, bool mirrored, const Margins& margins,
                      Tiles& tiles, Scratch& s, FillCounts& counts) {
  constexpr std::size_t padding = 2 * tile_pixels;
  if (s.x.size() < mesh.vertex_count + padding)
    for (auto* array : {&s.x, &s.y, &s.near}) array->resize(mesh.vertex_count + padding);
  if (s.facing.size() < mesh.triangle_count + padding) s.facing.resize(mesh.triangle_count + padding);
  const std::size_t most = std::max(mesh.triangle_count, mesh.edge_count) + padding;
  if (s.list.size() < most) s.list.resize(most);

  project(mesh, transform, s);
  const std::size_t triangles = classify(mesh, mirrored, margins, tiles, s);
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto t = static_cast<std::size_t>(s.list[i]);
    const ScreenPoint corners[3] = {point(s, mesh.corner0[t]), point(s, mesh.corner1[t]), point(s, mesh.corner2[t])};
    fill(corners, margins, tiles, counts);
  }
  if (triangles == 0) return;
  const std::size_t contours = find_contours(mesh, s);
  for (std::size_t i = 0; i < contours; ++i) {
    const auto e = static_cast<std::size_t>(s.list[i]);
    mark(point(s, mesh.edge_from[e]), point(s, mesh.edge_to[e]), margins, tiles, counts);
  }
}

inline void fill_triangle(const ScreenPoint* corners, const Margins& margins, Tiles& tiles, FillCounts& counts) {
  fill(corners, margins, tiles, counts);
}
inline void mark_contour(const ScreenPoint& p, const ScreenPoint& q, const Margins& margins, Tiles& tiles,
                         FillCounts& counts) {
  mark(p, q, margins, tiles, counts);
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
