// What the tile loops need before they fill: vertices to pixels, and as many triangles as there are lanes made into
// edges and depths. Once per SIMD target.

#if defined(SIGHTLINE_RASTER_TILE_SETUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_TILE_SETUP_INL
#undef SIGHTLINE_RASTER_TILE_SETUP_INL
#else
#define SIGHTLINE_RASTER_TILE_SETUP_INL
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

}  // namespace sightline::raster::HWY_NAMESPACE::tile_loops
HWY_AFTER_NAMESPACE();

#endif
