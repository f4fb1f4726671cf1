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

/// Appends one to a list that keeps its memory, and sets `at` to its place. Valid until the next is appended.
template <class T>
HWY_INLINE T& append(std::vector<T>& list, std::size_t& used, std::uint32_t& at) {
  if (used == list.size()) list.resize(std::max<std::size_t>(256, 2 * used));
  at = static_cast<std::uint32_t>(used++);
  return list[at];
}

HWY_INLINE Piece& add_piece(Strip& strip, std::uint32_t& first) {
  const std::uint32_t next = first;
  Piece& piece = append(strip.pieces, strip.used_pieces, first);
  piece.next = next;
  return piece;
}

/// In pixels, with the box that the margin widens and the tiles of the strip that this meets.
struct Segment {
  float x[2], y[2];
  float low_x, high_x, low_y, high_y;
  TileRange columns, rows;

  HWY_INLINE Segment(float px, float py, float qx, float qy, float margin, const Tiles& tiles, const Strip& strip)
      : x{px, qx},
        y{py, qy},
        low_x(std::min(px, qx) - margin),
        high_x(std::max(px, qx) + margin),
        low_y(std::min(py, qy) - margin),
        high_y(std::max(py, qy) + margin),
        columns(within(tile_range(low_x, high_x, tiles.width), strip)),
        rows(tile_range(low_y, high_y, tiles.height)) {}
  [[nodiscard]] HWY_INLINE bool outside() const { return columns.first > columns.last || rows.first > rows.last; }
};

/// Calls visit(tile, place, x, y, bits) for every tile with pixels whose squares, widened by the margin, the segment
/// touches (separating axes: x, y, its normal); x, y: the centre of the tile's first pixel. The segment is not outside.
template <class Visit>
HWY_INLINE void for_touched(const Segment& s, const Run& run, const Tiles& tiles, const Strip& strip,
                            const Visit& visit) {
  const Float d;
  const float margin = run.margins.pixels, square = run.margins.square;
  const float px = s.x[0], py = s.y[0], qx = s.x[1], qy = s.y[1];
  const auto left = hn::Set(d, s.low_x - square), right = hn::Set(d, s.high_x + square);
  const auto top = hn::Set(d, s.low_y - square), bottom = hn::Set(d, s.high_y + square);
  const TileRange columns = s.columns, rows = s.rows;
  const float a = py - qy, b = qx - px, length = std::abs(a) + std::abs(b);
  const float scale =
      length > 1e-20f ? 1.0f / (length * (run.margins.square + margin)) : 0.0f;  // a point: its box decides
  const Edge sides[2] = {{a * scale, b * scale, px, py}, {-a * scale, -b * scale, px, py}};
  const Edge& side = sides[0];
  const bool cut = columns.last - columns.first > 2;
  RowSpans spans;
  for (int row = rows.first; row <= rows.last; ++row) {
    const float y = static_cast<float>(row * tile_size) + 0.5f;
    TileRange range = columns;
    if (cut) {
      const auto lane = static_cast<std::size_t>(row - rows.first) % tile_pixels;
      if (lane == 0) {
        const Crossing crossings[2] = {Crossing(sides[0]), Crossing(sides[1])};
        cut_rows(sides, crossings, columns, tiles.width, row, rows.last - row + 1, spans);
      }
      range = {spans.first[lane], spans.last[lane]};
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
        hit = hn::And(hit, hn::And(hn::Ge(cx, left), hn::Le(cx, right)));
        hit = hn::And(hit, hn::And(hn::Ge(cy, top), hn::Le(cy, bottom)));
        bits |= bits_of(d, hit) << l;
      }
      if (bits != 0) visit(tile, strip.place(row, column), x, y, bits);
    }
  }
}

/// Enters the contour edges into the tiles' lists.
HWY_INLINE void mark_contour(const DrawList& list, const Run& run, Tiles& tiles, Strip& strip) {
  const Float d;
  const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
  const float reach = run.margins.square + run.margins.pixels;
  for (std::size_t e = run.first_edge; e < run.last_edge; ++e) {
    const Segment s(list.edge_x[0][e], list.edge_y[0][e], list.edge_x[1][e], list.edge_y[1][e], run.margins.pixels,
                    tiles, strip);
    if (s.outside()) continue;
    const float n0 = list.edge_near[0][e], n1 = list.edge_near[1][e];
    const float margin = std::max(std::abs(n0), std::abs(n1)) * run.margins.nearness_share + run.margins.nearness;
    const float least = std::min(n0, n1) - margin, most = std::max(n0, n1) + margin;
    const float ux = s.x[1] - s.x[0], uy = s.y[1] - s.y[0], squared = ux * ux + uy * uy;
    const bool dot = !(squared > 1.0f);  // its slope is noise
    const float slope = dot ? 0.0f : (n1 - n0) / squared;
    const float gx = ux * slope, gy = uy * slope;
    const float drop = reach * (std::abs(gx) + std::abs(gy)) + margin;
    const float start = dot ? least : n0 - drop, rise = dot ? most - least : 2.0f * drop;
    const auto enter = [&](std::size_t tile, std::size_t place, float x, float y,
                           std::uint32_t bits) SIGHTLINE_INLINE_LAMBDA {
      const auto near = hn::Set(d, start + (gx * (x - s.x[0]) + gy * (y - s.y[0])));
      Place& state = strip.places[place];
      const bool first = state.rim == no_piece;
      if (first) touch(strip, state, tile, place);
      Rim& rim = first ? append(strip.rims, strip.used_rims, state.rim) : strip.rims[state.rim];
      for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
        const auto hit = lanes_of(bits, l);
        const auto line = hn::Add(near, hn::Add(hn::Mul(hn::Set(d, gx), hn::Load(d, lane_x + l)),
                                                hn::Mul(hn::Set(d, gy), hn::Load(d, lane_y + l))));
        auto low = hn::IfThenElse(hit, hn::Max(line, hn::Set(d, least)), infinite);
        auto high = hn::IfThenElse(hit, hn::Min(hn::Add(line, hn::Set(d, rise)), hn::Set(d, most)), hn::Neg(infinite));
        if (!first) {
          low = hn::Min(low, hn::Load(d, rim.low + l));
          high = hn::Max(high, hn::Load(d, rim.high + l));
        }
        hn::Store(low, d, rim.low + l);
        hn::Store(high, d, rim.high + l);
      }
    };
    for_touched(s, run, tiles, strip, enter);
  }
}

/// A triangle seen along its plane covers nothing, but joins nearnesses that no other triangle may join.
HWY_INLINE void mark_flat(const DrawList& list, std::size_t t, float least, float most, const Run& run, Tiles& tiles,
                          Strip& strip) {
  const Float d;
  const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
  const auto enter = [&](std::size_t, std::size_t place, float, float, std::uint32_t bits) SIGHTLINE_INLINE_LAMBDA {
    Place& state = strip.places[place];
    if (state.rim == no_piece) return;
    Piece& piece = add_piece(strip, state.piece);
    piece.least = least;
    piece.rise = most - least;
    piece.most = most;
    piece.covered = 0;
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes())
      hn::Store(hn::IfThenElse(lanes_of(bits, l), hn::Set(d, least), infinite), d, piece.plane + l);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    const Segment s(list.x[i][t], list.y[i][t], list.x[k][t], list.y[k][t], run.margins.pixels, tiles, strip);
    if (!s.outside()) for_touched(s, run, tiles, strip, enter);
  }
}

/// The nearness that a tile's pieces prove in lanes from l on, where asked; -inf where none.
HWY_INLINE hn::Vec<Float> proven_by_pieces(const Strip& strip, const Place& place, std::size_t l,
                                           hn::Mask<Float> asked) {
  const Float d;
  const auto none = hn::Set(d, nothing_near), infinite = hn::Neg(none);
  const Piece* pieces = strip.pieces.data();
  // Levels before and behind all edges.
  const Rim& rim = strip.rims[place.rim];
  auto before = hn::Load(d, rim.high + l), behind = hn::Load(d, rim.low + l);
  // What the triangles before and behind them prove; all again if one reaches across, for it moves the level.
  for (;;) {
    auto near = infinite, far = infinite, near_covered = none, far_covered = none;
    auto moved = hn::Lt(none, none);
    for (std::uint32_t i = place.piece; i != no_piece; i = pieces[i].next) {
      const auto plane = hn::Load(d, pieces[i].plane + l);
      const auto low = hn::Max(plane, hn::Set(d, pieces[i].least));
      const auto high = hn::Min(hn::Add(plane, hn::Set(d, pieces[i].rise)), hn::Set(d, pieces[i].most));
      const auto covered = lanes_of(pieces[i].covered, l);
      const auto in_near = hn::Gt(low, before), in_far = hn::Lt(high, behind);
      const auto across_before = hn::AndNot(in_near, hn::Gt(high, before));
      const auto across_behind = hn::AndNot(in_far, hn::Lt(low, behind));
      before = hn::IfThenElse(across_before, high, before);
      behind = hn::IfThenElse(across_behind, low, behind);
      moved = hn::Or(moved, hn::Or(across_before, across_behind));
      near = hn::IfThenElse(in_near, hn::Min(near, low), near);
      far = hn::IfThenElse(in_far, hn::Min(far, low), far);
      near_covered = hn::IfThenElse(hn::And(in_near, covered), infinite, near_covered);
      far_covered = hn::IfThenElse(hn::And(in_far, covered), infinite, far_covered);
    }
    // Levels only move apart: a centre that is covered neither before nor behind them never will be.
    asked = hn::And(asked, hn::Gt(hn::Max(near_covered, far_covered), none));
    if (hn::AllFalse(d, hn::And(moved, asked)))
      return hn::IfThenElse(asked, hn::Max(hn::Min(near, near_covered), hn::Min(far, far_covered)), none);
  }
}

/// Ends a surface: what its layer and its pieces prove goes into `hidden`.
HWY_INLINE void commit(Tiles& tiles, Strip& strip) {
  const Float d;
  const auto none = hn::Set(d, nothing_near), infinite = hn::Neg(none);
  for (const auto [tile, place] : strip.touched) {
    Place& state = strip.places[place];
    const bool has_contour = state.rim != no_piece;
    auto farthest = infinite;
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      float* hidden = tiles.hidden[tile].lane + l;
      auto now = hn::Load(d, hidden);
      const auto asked = lanes_of(state.covered, l);
      if (!has_contour) {
        float* layer = strip.layer[place].lane + l;
        now = hn::Max(now, hn::IfThenElse(asked, hn::Load(d, layer), none));
        hn::Store(infinite, d, layer);
        hn::Store(now, d, hidden);
      } else if (!hn::AllFalse(d, asked)) {
        now = hn::Max(now, proven_by_pieces(strip, state, l, asked));
        hn::Store(now, d, hidden);
      }
      farthest = hn::Min(farthest, now);
    }
    tiles.farthest[tile] = hn::GetLane(hn::MinOfLanes(d, farthest));
    state = {};
  }
  strip.touched.clear();
  strip.used_pieces = strip.used_rims = 0;
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
