// The loops of tile_kernels.hpp, compiled once per SIMD target. Coverage is a comparison of two rounded products that
// depend on the row and on the column alone: r(y) = dx (y - ay) against c(x) = dy (x - ax), with (ax, ay) the lower end
// of the edge. Rounding keeps order, so corners decide exactly for whole tiles, and both neighbours of an edge compare
// the same two numbers with opposite signs: no pixel is lost or doubled, without snapping vertices to a grid. Here is
// the filling; tile_setup is what comes before.

#if defined(SIGHTLINE_RASTER_TILE_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_TILE_KERNELS_INL
#undef SIGHTLINE_RASTER_TILE_KERNELS_INL
#else
#define SIGHTLINE_RASTER_TILE_KERNELS_INL
#endif

#include "sightline/raster/tile_setup.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE::tile_loops {

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
