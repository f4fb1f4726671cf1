// Contours of a surface, and what its triangles prove in the pixels that they share. Between the nearnesses of the
// contour edges and those of the triangles in a pixel there may be a level that none of them reaches across: then the
// triangles before it are a sheet without a contour, and cover the pixel wholly or not at all; so are those behind the
// last such level. Once per SIMD target.

#if defined(SIGHTLINE_RASTER_OCCLUSION_CONTOUR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_CONTOUR_INL
#undef SIGHTLINE_RASTER_OCCLUSION_CONTOUR_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_CONTOUR_INL
#endif

#include "sightline/raster/occlusion_edges.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

/// Appends to a tile's list, of which `first` is the head.
HWY_INLINE void add_piece(Strip& strip, std::uint32_t& first, Piece piece) {
  piece.next = first;
  first = static_cast<std::uint32_t>(strip.pieces.size());
  strip.pieces.push_back(piece);
}

/// In pixels, with nearness.
struct Segment {
  float x[2], y[2], near[2];
};

/// Calls visit(tile, place, x, y, bits) for every tile with pixels whose squares, widened by the margin, the segment
/// touches (separating axes: x, y, its normal); x, y: the centre of the tile's first pixel.
template <class Visit>
HWY_INLINE void for_touched(const Segment& s, const Run& run, const Tiles& tiles, const Strip& strip,
                            const Visit& visit) {
  const Float d;
  const float margin = run.margins.pixels, square = run.margins.square;
  const float px = s.x[0], py = s.y[0], qx = s.x[1], qy = s.y[1];
  const float low_x = std::min(px, qx) - margin, high_x = std::max(px, qx) + margin;
  const float low_y = std::min(py, qy) - margin, high_y = std::max(py, qy) + margin;
  const TileRange columns = within(tile_range(low_x, high_x, tiles.width), strip);
  const TileRange rows = tile_range(low_y, high_y, tiles.height);
  if (columns.first > columns.last || rows.first > rows.last) return;
  const float a = py - qy, b = qx - px, length = std::abs(a) + std::abs(b);
  const float scale =
      length > 1e-20f ? 1.0f / (length * (run.margins.square + margin)) : 0.0f;  // a point: its box decides
  const Edge side{a * scale, b * scale, px, py}, other{-a * scale, -b * scale, px, py};
  const Crossing crossing(side), other_crossing(other);
  const bool cut = columns.last - columns.first > 2;
  for (int row = rows.first; row <= rows.last; ++row) {
    const float y = static_cast<float>(row * tile_size) + 0.5f;
    TileRange range = columns;
    if (cut) {
      RowCut row_cut{0.0f, static_cast<float>(tiles.width - 1), 0.0f, 0.0f};
      row_cut.add(side, crossing, y, y + static_cast<float>(tile_size - 1));
      row_cut.add(other, other_crossing, y, y + static_cast<float>(tile_size - 1));
      const TileRange narrow = tile_range(row_cut.left, row_cut.right, tiles.width);
      range = {std::max(narrow.first, columns.first), std::min(narrow.last, columns.last)};
    }
    for (int column = range.first; column <= range.last; ++column) {
      const std::size_t tile =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across) + static_cast<std::size_t>(column);
      if (tiles.farthest[tile] >= run.nearest) continue;
      const float x = static_cast<float>(column * tile_size) + 0.5f;
      const auto middle = hn::Set(d, at(side, x, y));
      std::uint32_t bits = 0;
      for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
        const auto lx = hn::Load(d, lane_x + l), ly = hn::Load(d, lane_y + l);
        const auto step = hn::Add(hn::Mul(hn::Set(d, side.a), lx), hn::Mul(hn::Set(d, side.b), ly));
        const auto cx = hn::Add(hn::Set(d, x), lx), cy = hn::Add(hn::Set(d, y), ly);
        auto hit = hn::Le(hn::Abs(hn::Add(middle, step)), hn::Set(d, 1.0f));
        hit = hn::And(hit, hn::And(hn::Ge(cx, hn::Set(d, low_x - square)), hn::Le(cx, hn::Set(d, high_x + square))));
        hit = hn::And(hit, hn::And(hn::Ge(cy, hn::Set(d, low_y - square)), hn::Le(cy, hn::Set(d, high_y + square))));
        bits |= bits_of(d, hit) << l;
      }
      if (bits != 0) visit(tile, strip.place(row, column), x, y, static_cast<std::uint16_t>(bits));
    }
  }
}

/// Enters the contour edges into the tiles' lists.
HWY_INLINE void mark_contour(const DrawList& list, const Run& run, Tiles& tiles, Strip& strip) {
  const float reach = run.margins.square + run.margins.pixels;
  for (std::size_t e = run.first_edge; e < run.last_edge; ++e) {
    const Segment s{{list.edge_x[0][e], list.edge_x[1][e]},
                    {list.edge_y[0][e], list.edge_y[1][e]},
                    {list.edge_near[0][e], list.edge_near[1][e]}};
    const float size = std::max(std::abs(s.near[0]), std::abs(s.near[1]));
    const float margin = size * run.margins.nearness_share + run.margins.nearness;
    const float least = std::min(s.near[0], s.near[1]) - margin, most = std::max(s.near[0], s.near[1]) + margin;
    const float ux = s.x[1] - s.x[0], uy = s.y[1] - s.y[0], squared = ux * ux + uy * uy;
    const bool dot = !(squared > 1.0f);  // its gradient is noise
    const float slope = dot ? 0.0f : (s.near[1] - s.near[0]) / squared;
    const float gx = ux * slope, gy = uy * slope;
    const float drop = reach * (std::abs(gx) + std::abs(gy)) + margin;
    for_touched(s, run, tiles, strip,
                [&](std::size_t tile, std::size_t place, float x, float y, std::uint16_t bits) SIGHTLINE_INLINE_LAMBDA {
                  const float near = dot ? least : s.near[0] + (gx * (x - s.x[0]) + gy * (y - s.y[0])) - drop;
                  add_piece(strip, strip.edges[place],
                            {near, gx, gy, least, dot ? most - least : 2.0f * drop, most, bits, 0, no_piece});
                  touch(strip, tile, place);
                });
  }
}

/// A triangle seen along its plane covers nothing, but joins nearnesses that no other triangle may join.
HWY_INLINE void mark_flat(const DrawList& list, std::size_t t, float least, float most, const Run& run, Tiles& tiles,
                          Strip& strip) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    const Segment s{{list.x[i][t], list.x[k][t]}, {list.y[i][t], list.y[k][t]}, {least, most}};
    for_touched(s, run, tiles, strip,
                [&](std::size_t, std::size_t place, float, float, std::uint16_t bits) SIGHTLINE_INLINE_LAMBDA {
                  if (strip.edges[place] != no_piece)
                    add_piece(strip, strip.triangles[place],
                              {least, 0.0f, 0.0f, least, most - least, most, bits, 0, no_piece});
                });
  }
}

/// Lanes from l on of a piece: where it is, and from which nearness to which.
struct PieceLanes {
  hn::Mask<Float> touched;
  hn::Vec<Float> low, high;
  HWY_INLINE PieceLanes(const Piece& p, std::size_t l) {
    const Float d;
    const auto step = hn::Add(hn::Mul(hn::Set(d, p.gradient_x), hn::Load(d, lane_x + l)),
                              hn::Mul(hn::Set(d, p.gradient_y), hn::Load(d, lane_y + l)));
    const auto at = hn::Add(hn::Set(d, p.near), step);
    touched = lanes_of(p.touched, l);
    low = hn::Max(at, hn::Set(d, p.least));
    high = hn::Min(hn::Add(at, hn::Set(d, p.rise)), hn::Set(d, p.most));
  }
};

/// The nearness that a tile's pieces prove in lanes from l on; -inf where none.
HWY_INLINE hn::Vec<Float> proven_by_pieces(const Strip& strip, std::size_t place, std::size_t l) {
  const Float d;
  const auto none = hn::Set(d, nothing_near), infinite = hn::Neg(none);
  const auto pieces = [&](std::uint32_t first, const auto& visit) SIGHTLINE_INLINE_LAMBDA {
    for (std::uint32_t i = first; i != no_piece; i = strip.pieces[i].next) visit(strip.pieces[i]);
  };
  // Levels before and behind all edges, moved until no triangle reaches across.
  auto before = none, behind = infinite;
  pieces(strip.edges[place], [&](const Piece& p) SIGHTLINE_INLINE_LAMBDA {
    const PieceLanes edge(p, l);
    before = hn::Max(before, hn::IfThenElse(edge.touched, edge.high, none));
    behind = hn::Min(behind, hn::IfThenElse(edge.touched, edge.low, infinite));
  });
  for (bool moved = true; moved;) {
    moved = false;
    pieces(strip.triangles[place], [&](const Piece& p) SIGHTLINE_INLINE_LAMBDA {
      const PieceLanes t(p, l);
      const auto across_before = hn::And(t.touched, hn::And(hn::Le(t.low, before), hn::Gt(t.high, before)));
      const auto across_behind = hn::And(t.touched, hn::And(hn::Ge(t.high, behind), hn::Lt(t.low, behind)));
      before = hn::IfThenElse(across_before, t.high, before);
      behind = hn::IfThenElse(across_behind, t.low, behind);
      moved = moved || !hn::AllFalse(d, hn::Or(across_before, across_behind));
    });
  }
  auto near = infinite, far = infinite;
  std::uint32_t near_covered = 0, far_covered = 0;
  pieces(strip.triangles[place], [&](const Piece& p) SIGHTLINE_INLINE_LAMBDA {
    const PieceLanes t(p, l);
    const auto in_near = hn::And(t.touched, hn::Gt(t.low, before)), in_far = hn::And(t.touched, hn::Lt(t.high, behind));
    near = hn::IfThenElse(in_near, hn::Min(near, t.low), near);
    far = hn::IfThenElse(in_far, hn::Min(far, t.low), far);
    near_covered |= bits_of(d, in_near) & (p.covered >> l);
    far_covered |= bits_of(d, in_far) & (p.covered >> l);
  });
  return hn::Max(hn::IfThenElse(lanes_of(near_covered, 0), near, none),
                 hn::IfThenElse(lanes_of(far_covered, 0), far, none));
}

/// Ends a surface: what its layer and its pieces prove goes into `hidden`.
HWY_INLINE void commit(Tiles& tiles, Strip& strip) {
  const Float d;
  const auto none = hn::Set(d, nothing_near), infinite = hn::Neg(none);
  for (const auto [tile, place] : strip.touched) {
    auto farthest = infinite;
    const bool has_contour = strip.edges[place] != no_piece;
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      float* layer = strip.layer[place].lane + l;
      float* hidden = tiles.hidden[tile].lane + l;
      auto proven = none;
      if (has_contour) {
        proven = proven_by_pieces(strip, place, l);
      } else {
        proven = hn::IfThenElse(lanes_of(strip.covered[place], l), hn::Load(d, layer), none);
        hn::Store(infinite, d, layer);
      }
      const auto now = hn::Max(hn::Load(d, hidden), proven);
      hn::Store(now, d, hidden);
      farthest = hn::Min(farthest, now);
    }
    tiles.farthest[tile] = hn::GetLane(hn::MinOfLanes(d, farthest));
    strip.covered[place] = 0;
    strip.triangles[place] = strip.edges[place] = no_piece;
    strip.listed[place] = 0;
  }
  strip.touched.clear();
  strip.pieces.clear();
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
