// The loops of tile_kernels.hpp, compiled once per SIMD target. Coverage is a comparison of two rounded products that
// depend on the row and on the column alone: r(y) = dx (y - ay) against c(x) = dy (x - ax), with (ax, ay) the lower end
// of the edge. Rounding keeps order, so corners decide exactly for whole tiles, and both neighbours of an edge compare
// the same two numbers with opposite signs: no pixel is lost or doubled, without snapping vertices to a grid.
// More than 400 lines because what is compiled once per target must be one file.

#if defined(SIGHTLINE_RASTER_TILE_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_TILE_KERNELS_INL
#undef SIGHTLINE_RASTER_TILE_KERNELS_INL
#else
#define SIGHTLINE_RASTER_TILE_KERNELS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "sightline/raster/tile_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE::tile_loops {

namespace hn = hwy::HWY_NAMESPACE;

using TF = hn::CappedTag<float, 8>;
using TI = hn::RebindToSigned<TF>;
using TU8 = hn::Rebind<std::uint8_t, TF>;
using VF = hn::Vec<TF>;
using VI = hn::Vec<TI>;

HWY_INLINE std::size_t lanes() { return hn::Lanes(TF()); }

HWY_INLINE VF dot3(const float* row, VF x, VF y, VF z) {
  const TF d;
  return hn::Add(hn::Add(hn::Mul(hn::Set(d, row[0]), x), hn::Mul(hn::Set(d, row[1]), y)),
                 hn::Mul(hn::Set(d, row[2]), z));
}

/// Where `open` (all bits set or none), the least float above v: r >= that says r > v. Elsewhere v.
HWY_INLINE VF next_above(VF v, VI open) {
  const TF d;
  const TI di;
  const VI bits = hn::BitCast(di, hn::Add(v, hn::Zero(d)));  // -0 becomes +0
  const VI step = hn::Or(hn::ShiftRight<31>(bits), hn::Set(di, 1));
  return hn::BitCast(d, hn::Add(bits, hn::And(step, open)));
}

template <class M>
HWY_INLINE std::uint32_t bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(TF(), mask, bytes);
  return bytes[0];
}

// ---- vertices

inline std::uint32_t transform(const float* x, const float* y, const float* z, std::size_t count,
                               const MeshTransform& t, VertexBuffer& out) {
  const TF d;
  const TI di;
  const std::size_t n = lanes();
  VI all = hn::Zero(di);
  const float* m = t.to_world;
  for (std::size_t i = 0; i < count; i += n) {
    const VF px = hn::LoadU(d, x + i), py = hn::LoadU(d, y + i), pz = hn::LoadU(d, z + i);
    VF from_eye[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const float row[3] = {m[k], m[3 + k], m[6 + k]};
      const VF world = hn::Add(dot3(row, px, py, pz), hn::Set(d, m[9 + k]));
      from_eye[k] = hn::Sub(hn::Sub(world, hn::Set(d, t.eye_high[k])), hn::Set(d, t.eye_low[k]));
    }
    const VF vx = dot3(t.to_x, from_eye[0], from_eye[1], from_eye[2]);
    const VF vy = dot3(t.to_y, from_eye[0], from_eye[1], from_eye[2]);
    const VF w = dot3(t.to_w, from_eye[0], from_eye[1], from_eye[2]);
    const VF nearness = t.perspective ? hn::Div(hn::Set(d, 1.0f), w) : hn::Neg(w);
    const VF off_x = t.perspective ? hn::Mul(vx, nearness) : vx, off_y = t.perspective ? hn::Mul(vy, nearness) : vy;
    VI code = hn::IfThenElseZero(hn::RebindMask(di, hn::Lt(w, hn::Set(d, t.near))), hn::Set(di, before_near));
    code = hn::Or(code, hn::IfThenElseZero(hn::RebindMask(di, hn::Gt(w, hn::Set(d, t.far))), hn::Set(di, beyond_far)));
    const auto in_guard = hn::And(hn::Le(hn::Abs(off_x), hn::Set(d, t.guard)),
                                  hn::Le(hn::Abs(off_y), hn::Set(d, t.guard)));  // false for what is no number
    code = hn::Or(code, hn::IfThenZeroElse(hn::RebindMask(di, in_guard), hn::Set(di, outside_guard)));
    all = hn::Or(all, code);
    hn::StoreInterleaved4(hn::Add(hn::Set(d, t.centre_x), off_x), hn::Add(hn::Set(d, t.centre_y), off_y), nearness, w,
                          d, &out.point[i].x);
    hn::Store(vx, d, out.view_x + i);
    hn::Store(vy, d, out.view_y + i);
    hn::Store(code, di, reinterpret_cast<std::int32_t*>(out.code) + i);
  }
  return static_cast<std::uint32_t>(hn::GetLane(hn::MaxOfLanes(di, hn::And(all, hn::Set(di, 1)))) |
                                    hn::GetLane(hn::MaxOfLanes(di, hn::And(all, hn::Set(di, 2)))) |
                                    hn::GetLane(hn::MaxOfLanes(di, hn::And(all, hn::Set(di, 4)))));
}

// ---- triangles

/// As many triangles as there are lanes, set up. Edge e runs from corner e to corner e + 1, turned so that the inside
/// is where r >= c.
struct alignas(64) Batch {
  float x[3][8], y[3][8], near[3][8];
  float dx[3][8], dy[3][8], ax[3][8], ay[3][8];
  float grad_x[8], grad_y[8], low[8], high[8];
  std::int32_t x0[8], y0[8], x1[8], y1[8];  // pixels, inclusive
  std::int32_t open[3][8];                  // all bits set: centres on the edge do not belong to the triangle
  std::uint32_t valid, large;
};

/// Twice the area with its right sign; used where floats cannot tell.
HWY_INLINE double exact_area(const Batch& b, std::size_t k) {
  const double x0 = static_cast<double>(b.x[0][k]), y0 = static_cast<double>(b.y[0][k]);
  return (static_cast<double>(b.x[1][k]) - x0) * (static_cast<double>(b.y[2][k]) - y0) -
         (static_cast<double>(b.x[2][k]) - x0) * (static_cast<double>(b.y[1][k]) - y0);
}

/// A corner of as many triangles as there are lanes.
#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE
HWY_INLINE void load_corners(const ScreenPoint* points, const std::uint8_t* index, VF& x, VF& y, VF& near) {
  const TF d;
  const VI at = hn::ShiftLeft<2>(hn::PromoteTo(TI(), hn::LoadU(TU8(), index)));  // in floats
  x = hn::GatherIndex(d, &points->x, at);
  y = hn::GatherIndex(d, &points->y, at);
  near = hn::GatherIndex(d, &points->near, at);
}
#else
/// Point index[k] and, in vectors of two blocks, point index[k + 4].
template <class D>
HWY_INLINE hn::Vec<D> load_points(D d, const ScreenPoint* points, const std::uint8_t* index, std::size_t k) {
  const hn::FixedTag<float, 4> block;
  const auto low = hn::Load(block, &points[index[k]].x);
  if constexpr (hn::MaxLanes(D()) == 8)
    return hn::Combine(d, hn::Load(block, &points[index[k + 4]].x), low);
  else
    return low;
}

/// Points are read as they lie and turned into columns, which is much faster than gathers.
HWY_INLINE void load_corners(const ScreenPoint* points, const std::uint8_t* index, VF& x, VF& y, VF& near) {
  const TF d;
  const hn::RepartitionToWide<TF> pairs;
  const VF p0 = load_points(d, points, index, 0), p1 = load_points(d, points, index, 1);
  const VF p2 = load_points(d, points, index, 2), p3 = load_points(d, points, index, 3);
  const auto xy01 = hn::BitCast(pairs, hn::InterleaveLower(d, p0, p1));
  const auto xy23 = hn::BitCast(pairs, hn::InterleaveLower(d, p2, p3));
  const auto near01 = hn::BitCast(pairs, hn::InterleaveUpper(d, p0, p1));
  const auto near23 = hn::BitCast(pairs, hn::InterleaveUpper(d, p2, p3));
  x = hn::BitCast(d, hn::InterleaveLower(pairs, xy01, xy23));
  y = hn::BitCast(d, hn::InterleaveUpper(pairs, xy01, xy23));
  near = hn::BitCast(d, hn::InterleaveLower(pairs, near01, near23));
}
#endif

HWY_INLINE void set_up_batch(const VertexBuffer& v, const std::uint8_t* const corner[3], std::size_t i, int cull,
                             const ScreenTile& tile, Batch& b) {
  const TF d;
  const TI di;
  VF x[3], y[3], n[3];
  for (std::size_t k = 0; k < 3; ++k) load_corners(v.point, corner[k] + i, x[k], y[k], n[k]);
  const VF min_x = hn::Min(hn::Min(x[0], x[1]), x[2]), max_x = hn::Max(hn::Max(x[0], x[1]), x[2]);
  const VF min_y = hn::Min(hn::Min(y[0], y[1]), y[2]), max_y = hn::Max(hn::Max(y[0], y[1]), y[2]);
  const VF half = hn::Set(d, 0.5f);
  const auto edge = [&](int pixel) { return hn::Set(d, static_cast<float>(pixel)); };
  const VF x0 = hn::Max(hn::Ceil(hn::Sub(min_x, half)), edge(tile.x0));
  const VF y0 = hn::Max(hn::Ceil(hn::Sub(min_y, half)), edge(tile.y0));
  const VF x1 = hn::Min(hn::Floor(hn::Sub(max_x, half)), edge(tile.x0 + tile.width - 1));
  const VF y1 = hn::Min(hn::Floor(hn::Sub(max_y, half)), edge(tile.y0 + tile.height - 1));
  b.valid = bits_of(hn::And(hn::Le(x0, x1), hn::Le(y0, y1)));
  if (b.valid == 0) return;
  const VF e1x = hn::Sub(x[1], x[0]), e1y = hn::Sub(y[1], y[0]), e2x = hn::Sub(x[2], x[0]), e2y = hn::Sub(y[2], y[0]);
  const VF p = hn::Mul(e1x, e2y), q = hn::Mul(e2x, e1y);
  VF area = hn::Sub(p, q);
  for (std::size_t k = 0; k < 3; ++k) {
    hn::Store(x[k], d, b.x[k]);
    hn::Store(y[k], d, b.y[k]);
    hn::Store(n[k], d, b.near[k]);
  }
  const std::uint32_t unsure =
      b.valid & bits_of(hn::Le(hn::Abs(area), hn::Mul(hn::Set(d, 1e-6f), hn::Add(hn::Abs(p), hn::Abs(q)))));
  if (unsure != 0) {
    alignas(64) float areas[8];
    hn::Store(area, d, areas);
    for (std::uint32_t bits = unsure; bits != 0; bits &= bits - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(bits));
      areas[k] = static_cast<float>(exact_area(b, k));
    }
    area = hn::Load(d, areas);
  }
  b.valid &= ~bits_of(hn::Eq(area, hn::Zero(d)));
  const auto clockwise = hn::Gt(area, hn::Zero(d));  // on the screen, y down
  if (cull != 0) b.valid &= cull > 0 ? ~bits_of(clockwise) : bits_of(clockwise);
  if (b.valid == 0) return;
  const VF size_x = hn::Sub(max_x, min_x), size_y = hn::Sub(max_y, min_y), small = hn::Set(d, 15.0f);
  b.large = bits_of(hn::Or(hn::Gt(size_x, small), hn::Gt(size_y, small)));
  hn::Store(hn::ConvertTo(di, x0), di, b.x0);
  hn::Store(hn::ConvertTo(di, y0), di, b.y0);
  hn::Store(hn::ConvertTo(di, x1), di, b.x1);
  hn::Store(hn::ConvertTo(di, y1), di, b.y1);
  const VF n1 = hn::Sub(n[1], n[0]), n2 = hn::Sub(n[2], n[0]);
  hn::Store(hn::Div(hn::Sub(hn::Mul(n1, e2y), hn::Mul(n2, e1y)), area), d, b.grad_x);
  hn::Store(hn::Div(hn::Sub(hn::Mul(n2, e1x), hn::Mul(n1, e2x)), area), d, b.grad_y);
  hn::Store(hn::Min(hn::Min(n[0], n[1]), n[2]), d, b.low);
  hn::Store(hn::Max(hn::Max(n[0], n[1]), n[2]), d, b.high);
  const VF sign = hn::And(area, hn::Set(d, -0.0f));
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t to = (k + 1) % 3;
    const VF dx = hn::Xor(hn::Sub(x[to], x[k]), sign), dy = hn::Xor(hn::Sub(y[to], y[k]), sign);
    const auto lower = hn::Or(hn::Lt(x[to], x[k]), hn::And(hn::Eq(x[to], x[k]), hn::Lt(y[to], y[k])));
    hn::Store(dx, d, b.dx[k]);
    hn::Store(dy, d, b.dy[k]);
    hn::Store(hn::IfThenElse(lower, x[to], x[k]), d, b.ax[k]);
    hn::Store(hn::IfThenElse(lower, y[to], y[k]), d, b.ay[k]);
    // Top-left rule: left edges run up, top edges to the right.
    const auto owns = hn::Or(hn::Lt(dy, hn::Zero(d)), hn::And(hn::Eq(dy, hn::Zero(d)), hn::Gt(dx, hn::Zero(d))));
    hn::Store(hn::IfThenZeroElse(hn::RebindMask(di, owns), hn::Set(di, -1)), di, b.open[k]);
  }
}

struct Writer {
  const DrawFlags& flags;
  ScreenTile& tile;
  TileCounts& counts;
  std::uint32_t id;
};

/// Equal depth goes to the lower object, then the lower triangle: takes from `mask` the lanes that lose.
HWY_INLINE std::uint32_t losers(const Writer& w, std::uint32_t equal, std::size_t at) {
  std::uint32_t lost = 0;
  const DrawnCluster& mine = w.tile.drawn[w.id >> 7];
  for (; equal != 0; equal &= equal - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(equal));
    if (w.tile.depth[at + lane] == nowhere) continue;
    const std::uint32_t other_id = w.tile.id[at + lane];
    const DrawnCluster& other = w.tile.drawn[other_id >> 7];
    const bool wins =
        mine.object < other.object ||
        (mine.object == other.object && mine.first_triangle + (w.id & 127) < other.first_triangle + (other_id & 127));
    if (!wins) lost |= 1u << lane;
  }
  return lost;
}

/// Depth test and write of one row of lanes.
template <bool Ids, class M>
HWY_INLINE void write_row(const Writer& w, M inside, VF z, std::size_t at) {
  const TF d;
  const TI di;
  float* depth = w.tile.depth + at;
  const VF stored = hn::LoadU(d, depth);
  if constexpr (!Ids) {
    hn::StoreU(hn::IfThenElse(inside, hn::Max(z, stored), stored), d, depth);
  } else {
    auto pass = hn::And(inside, hn::Ge(z, stored));
    const auto equal = hn::And(inside, hn::Eq(z, stored));
    std::uint32_t bits = bits_of(pass);
    w.counts.tested += static_cast<std::uint64_t>(std::popcount(bits_of(inside)));
    if (HWY_UNLIKELY(!hn::AllFalse(d, equal))) {
      bits &= ~losers(w, bits_of(equal), at);
      const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
      pass = hn::LoadMaskBits(d, bytes);
    }
    if (bits == 0) return;
    w.counts.written += static_cast<std::uint64_t>(std::popcount(bits));
    hn::StoreU(hn::IfThenElse(pass, z, stored), d, depth);
    auto* ids = reinterpret_cast<std::int32_t*>(w.tile.id + at);
    hn::StoreU(
        hn::IfThenElse(hn::RebindMask(di, pass), hn::Set(di, static_cast<std::int32_t>(w.id)), hn::LoadU(di, ids)), di,
        ids);
    if (w.flags.count_writes) {
      auto* writes = reinterpret_cast<std::int32_t*>(w.tile.writes + at);
      hn::StoreU(hn::Add(hn::LoadU(di, writes), hn::IfThenElseZero(hn::RebindMask(di, pass), hn::Set(di, 1))), di,
                 writes);
    }
  }
}

HWY_INLINE VF clamp_depth(VF z, VF low, VF high) { return hn::Min(hn::Max(z, low), high); }

/// c of one edge at pixel centres in a row.
HWY_INLINE VF column_value(const Batch& b, std::size_t k, std::size_t e, VF px) {
  const TF d;
  const VF c = hn::Mul(hn::Set(d, b.dy[e][k]), hn::Sub(px, hn::Set(d, b.ax[e][k])));
  return next_above(c, hn::Set(TI(), b.open[e][k]));
}

/// A triangle of at most 16 x 16 pixels: all pixels of its box.
template <bool Ids>
HWY_INLINE void fill_small(const Batch& b, std::size_t k, const Writer& w) {
  const TF d;
  const int n = static_cast<int>(lanes());
  const int x0 = b.x0[k], y0 = b.y0[k], x1 = b.x1[k], y1 = b.y1[k];
  alignas(64) float r[3][24], row_z[24];
  const VF iota = hn::Iota(d, 0.5f);
  for (int j = 0; j <= y1 - y0; j += n) {
    const VF py = hn::Add(hn::Set(d, static_cast<float>(y0 + j)), iota);
    for (std::size_t e = 0; e < 3; ++e)
      hn::StoreU(hn::Mul(hn::Set(d, b.dx[e][k]), hn::Sub(py, hn::Set(d, b.ay[e][k]))), d, r[e] + j);
    hn::StoreU(hn::Add(hn::Set(d, b.near[0][k]), hn::Mul(hn::Set(d, b.grad_y[k]), hn::Sub(py, hn::Set(d, b.y[0][k])))),
               d, row_z + j);
  }
  const VF low = hn::Set(d, b.low[k]), high = hn::Set(d, b.high[k]);
  for (int x = x0; x <= x1; x += n) {
    const VF px = hn::Add(hn::Set(d, static_cast<float>(x)), iota);
    VF c[3];
    for (std::size_t e = 0; e < 3; ++e) c[e] = column_value(b, k, e, px);
    const auto beyond = hn::Gt(px, hn::Set(d, static_cast<float>(x1 + 1)));
    c[0] = hn::IfThenElse(beyond, hn::Set(d, std::numeric_limits<float>::infinity()), c[0]);
    const VF zx = hn::Mul(hn::Set(d, b.grad_x[k]), hn::Sub(px, hn::Set(d, b.x[0][k])));
    std::size_t at = static_cast<std::size_t>((y0 - w.tile.y0) * screen_tile_stride + x - w.tile.x0);
    for (int j = 0; j <= y1 - y0; ++j, at += screen_tile_stride) {
      const auto inside = hn::And(hn::And(hn::Ge(hn::Set(d, r[0][j]), c[0]), hn::Ge(hn::Set(d, r[1][j]), c[1])),
                                  hn::Ge(hn::Set(d, r[2][j]), c[2]));
      write_row<Ids>(w, inside, clamp_depth(hn::Add(hn::Set(d, row_z[j]), zx), low, high), at);
    }
  }
}

HWY_INLINE void refresh_tile(ScreenTile& tile, int row, int column) {
  const TF d;
  const float* p = tile.depth + row * depth_tile * screen_tile_stride + column * depth_tile;
  VF least = hn::LoadU(d, p);
  for (int j = 0; j < depth_tile; ++j)
    for (std::size_t i = 0; i < depth_tile; i += lanes())
      least = hn::Min(least, hn::LoadU(d, p + j * screen_tile_stride + i));
  tile.farthest[row * tiles_across + column] = hn::GetLane(hn::MinOfLanes(d, least));
}

/// Brings `farthest` of the tiles [first, last] of a row up to date.
HWY_INLINE void refresh_row(ScreenTile& tile, int row, int first, int last) {
  const std::uint32_t range = (0xFFFFFFFFu >> (31 - last)) & (0xFFFFFFFFu << first);
  for (std::uint32_t bits = tile.dirty[row] & range; bits != 0; bits &= bits - 1)
    refresh_tile(tile, row, std::countr_zero(bits));
  tile.dirty[row] &= ~range;
}

HWY_INLINE void mark_dirty(ScreenTile& tile, int x0, int y0, int x1, int y1) {
  const int first = (x0 - tile.x0) / depth_tile, last = (x1 - tile.x0) / depth_tile;
  const std::uint32_t range = (0xFFFFFFFFu >> (31 - last)) & (0xFFFFFFFFu << first);
  for (int row = (y0 - tile.y0) / depth_tile; row <= (y1 - tile.y0) / depth_tile; ++row) tile.dirty[row] |= range;
}

/// A triangle that is large in the image: tile by tile, coarse first (5.02). Its depth plane is evaluated in double
/// precision at the first pixel of every tile and in steps from there.
struct LargePlane {
  double at_zero, dx, dy;  // at the centre of the screen tile's first pixel
  float step_x, step_y;
};

HWY_INLINE LargePlane large_plane(const Batch& b, std::size_t k, const ScreenTile& tile) {
  const auto real = [&](const float(&v)[3][8], std::size_t corner) { return static_cast<double>(v[corner][k]); };
  const double x1 = real(b.x, 1) - real(b.x, 0), y1 = real(b.y, 1) - real(b.y, 0);
  const double x2 = real(b.x, 2) - real(b.x, 0), y2 = real(b.y, 2) - real(b.y, 0);
  const double n1 = real(b.near, 1) - real(b.near, 0), n2 = real(b.near, 2) - real(b.near, 0);
  const double area = x1 * y2 - x2 * y1;
  LargePlane p{0, (n1 * y2 - n2 * y1) / area, (n2 * x1 - n1 * x2) / area, 0, 0};
  p.at_zero = real(b.near, 0) + p.dx * (tile.x0 + 0.5 - real(b.x, 0)) + p.dy * (tile.y0 + 0.5 - real(b.y, 0));
  p.step_x = static_cast<float>(p.dx);
  p.step_y = static_cast<float>(p.dy);
  return p;
}

/// Fills an 8 x 8 tile. Hierarchical: true if a fragment was nearer than `farthest` (else reject test 3: no fragment
/// could change that bound).
template <bool Ids, bool Hierarchical>
HWY_INLINE bool fill_tile(const Batch& b, std::size_t k, const Writer& w, const LargePlane& plane, int row, int column,
                          bool full) {
  const TF d;
  const int n = static_cast<int>(lanes());
  const int left = w.tile.x0 + column * depth_tile, top = w.tile.y0 + row * depth_tile;
  const VF base =
      hn::Set(d, static_cast<float>(plane.at_zero + plane.dx * (column * depth_tile) + plane.dy * (row * depth_tile)));
  const VF low = hn::Set(d, b.low[k]), high = hn::Set(d, b.high[k]);
  const int first = full ? 0 : std::max(0, b.y0[k] - top),
            last = full ? depth_tile - 1 : std::min(depth_tile - 1, b.y1[k] - top);
  const VF farthest = hn::Set(d, Hierarchical ? w.tile.farthest[row * tiles_across + column] : 0.0f);
  auto nearer = hn::Lt(farthest, farthest);
  for (int i = 0; i < depth_tile; i += n) {
    const VF zx = hn::Add(base, hn::Mul(hn::Set(d, plane.step_x), hn::Iota(d, static_cast<float>(i))));
    const auto z = [&](int j) HWY_ATTR {
      return clamp_depth(hn::Add(zx, hn::Set(d, plane.step_y * static_cast<float>(j))), low, high);
    };
    const VF px = hn::Iota(d, static_cast<float>(left + i) + 0.5f);
    std::size_t at =
        static_cast<std::size_t>((row * depth_tile + first) * screen_tile_stride + column * depth_tile + i);
    if (full) {
      const auto all = hn::Eq(zx, zx);
      for (int j = first; j <= last; ++j, at += screen_tile_stride) write_row<Ids>(w, all, z(j), at);
      continue;
    }
    VF c[3];
    for (std::size_t e = 0; e < 3; ++e) c[e] = column_value(b, k, e, px);
    const auto beyond = hn::Or(hn::Gt(px, hn::Set(d, static_cast<float>(b.x1[k] + 1))),
                               hn::Lt(px, hn::Set(d, static_cast<float>(b.x0[k]))));
    c[0] = hn::IfThenElse(beyond, hn::Set(d, std::numeric_limits<float>::infinity()), c[0]);
    for (int j = first; j <= last; ++j, at += screen_tile_stride) {
      const float py = static_cast<float>(top + j) + 0.5f;
      const auto r = [&](std::size_t e) HWY_ATTR { return hn::Set(d, b.dx[e][k] * (py - b.ay[e][k])); };
      const auto inside = hn::And(hn::And(hn::Ge(r(0), c[0]), hn::Ge(r(1), c[1])), hn::Ge(r(2), c[2]));
      const VF depth = z(j);
      if constexpr (Hierarchical) nearer = hn::Or(nearer, hn::And(inside, hn::Gt(depth, farthest)));
      write_row<Ids>(w, inside, depth, at);
    }
  }
  return !Hierarchical || full || !hn::AllFalse(d, nearer);
}

template <bool Ids, bool Hierarchical>
HWY_NOINLINE void fill_large(const Batch& b, std::size_t k, const Writer& w) {
  const TF d;
  ScreenTile& tile = w.tile;
  const int n = static_cast<int>(lanes());
  const LargePlane plane = large_plane(b, k, tile);
  const int first = (b.x0[k] - tile.x0) / depth_tile, last = (b.x1[k] - tile.x0) / depth_tile;
  alignas(64) float least[3][tiles_across + 8], most[3][tiles_across + 8];
  for (int column = first; column <= last; column += n) {
    const VF left =
        hn::Add(hn::Mul(hn::Iota(d, static_cast<float>(column)), hn::Set(d, static_cast<float>(depth_tile))),
                hn::Set(d, static_cast<float>(tile.x0) + 0.5f));
    const VF right = hn::Add(left, hn::Set(d, static_cast<float>(depth_tile - 1)));
    for (std::size_t e = 0; e < 3; ++e) {
      const VF one = column_value(b, k, e, left), two = column_value(b, k, e, right);
      hn::StoreU(hn::Min(one, two), d, least[e] + column);
      hn::StoreU(hn::Max(one, two), d, most[e] + column);
    }
  }
  const auto grows = [](float step) { return std::max(step, 0.0f) * static_cast<float>(depth_tile - 1); };
  for (int row = (b.y0[k] - tile.y0) / depth_tile; row <= (b.y1[k] - tile.y0) / depth_tile; ++row) {
    float r_least[3], r_most[3];
    const float top = static_cast<float>(tile.y0 + row * depth_tile) + 0.5f,
                bottom = top + static_cast<float>(depth_tile - 1);
    for (std::size_t e = 0; e < 3; ++e) {
      const float one = b.dx[e][k] * (top - b.ay[e][k]), two = b.dx[e][k] * (bottom - b.ay[e][k]);
      r_least[e] = std::min(one, two);
      r_most[e] = std::max(one, two);
    }
    const bool rows_inside = tile.y0 + row * depth_tile >= b.y0[k] && tile.y0 + (row + 1) * depth_tile - 1 <= b.y1[k];
    if constexpr (Hierarchical) refresh_row(tile, row, first, last);
    // Nearest that the plane gets within a tile, in single precision with room for its rounding (reject test 2).
    const auto row_base = static_cast<float>(plane.at_zero + plane.dy * (row * depth_tile));
    const float slack = 4e-6f * (std::abs(row_base) + std::abs(plane.step_x) * static_cast<float>(screen_tile_width)) +
                        grows(plane.step_x) + grows(plane.step_y);
    std::uint32_t changed = 0;
    for (int column = first; column <= last; column += n) {
      auto touched = hn::Ge(hn::Set(d, r_most[0]), hn::LoadU(d, least[0] + column));
      auto full = hn::Ge(hn::Set(d, r_least[0]), hn::LoadU(d, most[0] + column));
      for (std::size_t e = 1; e < 3; ++e) {
        touched = hn::And(touched, hn::Ge(hn::Set(d, r_most[e]), hn::LoadU(d, least[e] + column)));
        full = hn::And(full, hn::Ge(hn::Set(d, r_least[e]), hn::LoadU(d, most[e] + column)));
      }
      std::uint32_t bits = bits_of(touched);
      const int left_over = last - column + 1;
      if (left_over < n) bits &= (1u << left_over) - 1;
      if constexpr (Hierarchical) {
        const VF bound = hn::Min(hn::Add(hn::Mul(hn::Iota(d, static_cast<float>(column)),
                                                 hn::Set(d, plane.step_x * static_cast<float>(depth_tile))),
                                         hn::Set(d, row_base + slack)),
                                 hn::Set(d, b.high[k]));  // reject test 1 is the second part
        const std::uint32_t hidden =
            bits & bits_of(hn::Lt(bound, hn::LoadU(d, tile.farthest + row * tiles_across + column)));
        w.counts.tiles_rejected += static_cast<std::uint64_t>(std::popcount(hidden));
        bits &= ~hidden;
      }
      w.counts.tiles_filled += static_cast<std::uint64_t>(std::popcount(bits));
      const std::uint32_t whole = rows_inside ? bits_of(full) : 0;
      for (; bits != 0; bits &= bits - 1) {
        const int lane = std::countr_zero(bits);
        const int x = tile.x0 + (column + lane) * depth_tile;
        const bool inside = ((whole >> lane) & 1) != 0 && x >= b.x0[k] && x + depth_tile - 1 <= b.x1[k];
        if (fill_tile<Ids, Hierarchical>(b, k, w, plane, row, column + lane, inside))
          changed |= 1u << (column + lane);
        else
          ++w.counts.tiles_unchanged;
      }
    }
    if constexpr (Hierarchical) tile.dirty[row] |= changed;
  }
}

template <bool Ids, bool Hierarchical>
inline void draw_all(const VertexBuffer& v, const std::uint8_t* const corner[3], std::size_t count, std::uint32_t id,
                     std::uint32_t id_step, const DrawFlags& flags, ScreenTile& tile, TileCounts& counts) {
  Batch b;
  const std::size_t n = lanes();
  for (std::size_t i = 0; i < count; i += n) {
    set_up_batch(v, corner, i, flags.cull, tile, b);
    if (count - i < n) b.valid &= (1u << (count - i)) - 1;
    counts.triangles += static_cast<std::uint64_t>(std::popcount(b.valid));
    for (std::uint32_t bits = b.valid; bits != 0; bits &= bits - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(bits));
      const Writer w{flags, tile, counts, id + static_cast<std::uint32_t>(i + k) * id_step};
      if (((b.large >> k) & 1) != 0) {
        fill_large<Ids, Hierarchical>(b, k, w);
      } else {
        fill_small<Ids>(b, k, w);
        if constexpr (Hierarchical) mark_dirty(tile, b.x0[k], b.y0[k], b.x1[k], b.y1[k]);
      }
    }
  }
}

inline void draw(const VertexBuffer& v, const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                 std::size_t count, std::uint32_t id, std::uint32_t id_step, const DrawFlags& flags, ScreenTile& tile,
                 TileCounts& counts) {
  const std::uint8_t* const corner[3] = {a, b, c};
  if (flags.ids && flags.hierarchical) return draw_all<true, true>(v, corner, count, id, id_step, flags, tile, counts);
  if (flags.ids) return draw_all<true, false>(v, corner, count, id, id_step, flags, tile, counts);
  if (flags.hierarchical) return draw_all<false, true>(v, corner, count, id, id_step, flags, tile, counts);
  draw_all<false, false>(v, corner, count, id, id_step, flags, tile, counts);
}

// ---- bounds

inline std::size_t cull(const ClusterMesh& mesh, const MeshPlane* planes, std::size_t plane_count, std::uint32_t* out) {
  const TF d;
  std::size_t kept = 0;
  const std::size_t count = mesh.clusters.size();
  for (std::size_t i = 0; i < count; i += lanes()) {
    auto outside = hn::Lt(hn::Zero(d), hn::Zero(d));
    for (std::size_t p = 0; p < plane_count; ++p) {
      const MeshPlane& plane = planes[p];
      const VF x = hn::LoadU(d, (plane.nx >= 0 ? mesh.high_x : mesh.low_x).data() + i);
      const VF y = hn::LoadU(d, (plane.ny >= 0 ? mesh.high_y : mesh.low_y).data() + i);
      const VF z = hn::LoadU(d, (plane.nz >= 0 ? mesh.high_z : mesh.low_z).data() + i);
      const float normal[3] = {plane.nx, plane.ny, plane.nz};
      outside = hn::Or(outside, hn::Lt(hn::Add(dot3(normal, x, y, z), hn::Set(d, plane.d)), hn::Zero(d)));
    }
    std::uint32_t bits = ~bits_of(outside) & ((1u << lanes()) - 1);
    if (count - i < lanes()) bits &= (1u << (count - i)) - 1;
    for (; bits != 0; bits &= bits - 1)
      out[kept++] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(std::countr_zero(bits));
  }
  return kept;
}

inline BoxImage project(const float* low, const float* high, const BoxTransform& t) {
  const TF d;
  alignas(64) float corner[3][8];
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t k = 0; k < 3; ++k) corner[k][i] = ((i >> k) & 1) != 0 ? high[k] : low[k];
  VF min_x = hn::Set(d, 3e38f), max_x = hn::Set(d, -3e38f), min_y = min_x, max_y = max_x, min_w = min_x;
  for (std::size_t i = 0; i < 8; i += lanes()) {
    const VF x = hn::Load(d, corner[0] + i), y = hn::Load(d, corner[1] + i), z = hn::Load(d, corner[2] + i);
    const VF w = hn::Add(dot3(t.w, x, y, z), hn::Set(d, t.w[3]));
    VF px = hn::Add(dot3(t.x, x, y, z), hn::Set(d, t.x[3])), py = hn::Add(dot3(t.y, x, y, z), hn::Set(d, t.y[3]));
    if (t.perspective) {
      px = hn::Div(px, w);
      py = hn::Div(py, w);
    }
    min_x = hn::Min(min_x, px);
    max_x = hn::Max(max_x, px);
    min_y = hn::Min(min_y, py);
    max_y = hn::Max(max_y, py);
    min_w = hn::Min(min_w, w);
  }
  const auto least = [&](VF v) { return hn::GetLane(hn::MinOfLanes(d, v)); };
  const auto most = [&](VF v) { return hn::GetLane(hn::MaxOfLanes(d, v)); };
  const float w = least(min_w) - t.slack_w;
  BoxImage image{0, 0, 0, 0, 0, false};
  image.whole = t.perspective && !(w > 0.5f * t.near);
  const float scale = t.perspective ? 1.0f / std::max(w, 1e-30f) : 1.0f;
  // A rounding of w moves x by x / w of it; positions far outside of the image do not matter.
  const float x0 = least(min_x), x1 = most(max_x), y0 = least(min_y), y1 = most(max_y);
  const auto reach = [](float a, float b) { return std::min(std::max(std::abs(a), std::abs(b)), 65536.0f); };
  const float tilt = t.perspective ? t.slack_w * scale : 0.0f;
  const float slack_x = t.slack_x * scale + reach(x0, x1) * tilt + 1.0f;
  const float slack_y = t.slack_y * scale + reach(y0, y1) * tilt + 1.0f;
  image.x0 = t.centre_x + x0 - slack_x;
  image.x1 = t.centre_x + x1 + slack_x;
  image.y0 = t.centre_y + y0 - slack_y;
  image.y1 = t.centre_y + y1 + slack_y;
  image.near = t.perspective ? scale * (1.0f + 4e-6f) : -w;
  return image;
}

inline bool hidden(ScreenTile& tile, const BoxImage& box) {
  if (box.whole) return false;
  const auto cut = [](float v, int low, int high) {
    return static_cast<int>(std::clamp(v, static_cast<float>(low), static_cast<float>(high)));
  };
  const int x0 = cut(box.x0, tile.x0, tile.x0 + tile.width - 1) - tile.x0;
  const int x1 = cut(box.x1, tile.x0, tile.x0 + tile.width - 1) - tile.x0;
  const int y0 = cut(box.y0, tile.y0, tile.y0 + tile.height - 1) - tile.y0;
  const int y1 = cut(box.y1, tile.y0, tile.y0 + tile.height - 1) - tile.y0;
  for (int row = y0 / depth_tile; row <= y1 / depth_tile; ++row) {
    refresh_row(tile, row, x0 / depth_tile, x1 / depth_tile);
    for (int column = x0 / depth_tile; column <= x1 / depth_tile; ++column)
      if (!(tile.farthest[row * tiles_across + column] > box.near)) return false;
  }
  return true;
}

}  // namespace sightline::raster::HWY_NAMESPACE::tile_loops
HWY_AFTER_NAMESPACE();

#endif
