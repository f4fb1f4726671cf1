// The loops of occlusion_kernels.hpp, compiled once per SIMD target. The idea
// (../../../docs/algorithms/occlusion_masked.md): a pixel square that no contour edge of an occluder's projection
// touches is covered wholly or not at all, and its centre tells which. A pixel that one triangle covers wholly is
// written at once; pixels that several triangles of the occluder share gather in a layer and are written at its end,
// unless a contour edge touched them. Here is the drawing; occlusion_setup, occlusion_prepare and occlusion_query are
// the rest.

#if defined(SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#undef SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#endif

#include "sightline/raster/occlusion_setup.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

HWY_INLINE void touch(Strip& strip, std::size_t tile, std::size_t place) {
  if (strip.listed[place] != 0) return;
  strip.listed[place] = 1;
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

/// The pixels of a row of tiles (centres from y_low to y_high) that can lie inside an edge form an interval: cuts
/// [left, right] down to it, widened by a pixel; and those that certainly lie wholly inside: cuts [in_left, in_right].
struct RowCut {
  float left, right, in_left, in_right;
  HWY_INLINE void add(const Edge& e, const Crossing& c, float y_low, float y_high) {
    const float low = e.b * (y_low - e.y0), high = e.b * (y_high - e.y0);
    const float best = std::max(low, high), worst = std::min(low, high);
    if (!(std::abs(e.a) > flat_edge)) {
      if (!(worst > 1.001f)) in_right = -1.0f;
      return;
    }
    const float slack = (2.0f + std::abs(best) + std::abs(worst)) * c.slack_per_a;
    const float outer = e.x0 + (-1.0f - best) * c.per_a, inner = e.x0 + (1.0f - worst) * c.per_a;
    if (e.a > 0.0f) {
      left = std::max(left, outer - (1.0f + slack));
      in_left = std::max(in_left, inner + (0.01f + slack));
    } else {
      right = std::min(right, outer + (1.0f + slack));
      in_right = std::min(in_right, inner - (0.01f + slack));
    }
  }
};

/// A centre this little outside of a triangle (by its edges, scaled as above, and by its box, pixels) still counts as
/// covered, so that rounding opens no seam between two triangles. Safe because it is less than the margin by which
/// contour edges are widened (1/64 pixel at least); the box cuts off what the widened edges of a sliver would claim
/// beyond its tips.
inline constexpr float edge_slack = 0.01f;
inline constexpr float box_slack = 0.004f;

/// One triangle in the tile loops.
class TriangleFill {
 public:
  HWY_INLINE TriangleFill(const Setups& s, std::size_t t, const Run& run, Tiles& tiles, Strip& strip)
      : edges_{{s.a[0][t], s.b[0][t], s.x[0][t], s.y[0][t]},
               {s.a[1][t], s.b[1][t], s.x[1][t], s.y[1][t]},
               {s.a[2][t], s.b[2][t], s.x[2][t], s.y[2][t]}},
        gradient_x_(s.gradient_x[t]),
        gradient_y_(s.gradient_y[t]),
        base_(s.base[t]),
        least_(s.least[t]),
        box_low_x_(s.low_x[t] - box_slack),
        box_high_x_(s.high_x[t] + box_slack),
        box_low_y_(s.low_y[t] - box_slack),
        box_high_y_(s.high_y[t] + box_slack),
        nearest_(run.nearest),
        tiles_(tiles),
        strip_(strip) {
    const Float d;
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      const auto lx = hn::Load(d, lane_x + l), ly = hn::Load(d, lane_y + l);
      for (int i = 0; i < 3; ++i) hn::Store(step(edges_[i].a, edges_[i].b, lx, ly), d, edge_step_[i] + l);
      hn::Store(step(gradient_x_, gradient_y_, lx, ly), d, near_step_ + l);
    }
    // Rounding is monotonic: the extremes over the lanes are those of the corner lanes.
    const float* n = near_step_;
    least_step_ = std::min(std::min(n[0], n[3]), std::min(n[12], n[15]));
    largest_step_ = std::max(std::max(n[0], n[3]), std::max(n[12], n[15]));
  }

  HWY_INLINE void rows(TileRange all_columns, TileRange rows) {
    const TileRange columns = within(all_columns, strip_);
    if (all_columns.last - all_columns.first <= 2) {  // whatever the strip, so that the same tiles count as filled
      for (int row = rows.first; row <= rows.last; ++row)
        for (int column = columns.first; column <= columns.last; ++column) any_tile(row, column);
      return;
    }
    const Crossing crossings[3] = {Crossing(edges_[0]), Crossing(edges_[1]), Crossing(edges_[2])};
    const auto width = static_cast<float>(tiles_.width);
    for (int row = rows.first; row <= rows.last; ++row) {
      const float y = static_cast<float>(row * tile_size) + 0.5f;
      RowCut cut{0.0f, width - 1.0f, 0.0f, width};
      for (int i = 0; i < 3; ++i) cut.add(edges_[i], crossings[i], y, y + static_cast<float>(tile_size - 1));
      TileRange range = tile_range(cut.left, cut.right, tiles_.width);
      range = {std::max(range.first, columns.first), std::min(range.last, columns.last)};
      if (range.first > range.last) continue;
      // Tiles whose centres from the first to the last column lie within [in_left, in_right].
      TileRange inner{range.last + 1, range.last};
      if (cut.in_left <= cut.in_right) {
        inner.first = std::max(range.first, static_cast<int>(cut.in_left + 3.5f) / tile_size);
        inner.last = std::min(range.last, cut.in_right < 3.5f ? -1 : static_cast<int>(cut.in_right - 3.5f) / tile_size);
        if (inner.first > inner.last) inner = {range.last + 1, range.last};
      }
      for (int column = range.first; column < inner.first; ++column) any_tile(row, column);
      for (int column = inner.first; column <= inner.last; ++column) whole_tile(row, column);
      for (int column = inner.last + 1; column <= range.last; ++column) any_tile(row, column);
    }
  }

 private:
  static HWY_INLINE hn::Vec<Float> step(float a, float b, hn::Vec<Float> lx, hn::Vec<Float> ly) {
    const Float d;
    return hn::Add(hn::Mul(hn::Set(d, a), lx), hn::Mul(hn::Set(d, b), ly));
  }
  [[nodiscard]] HWY_INLINE std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles_.across) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] HWY_INLINE float near_at(float x, float y) const {
    return base_ + (gradient_x_ * (x - edges_[0].x0) + gradient_y_ * (y - edges_[0].y0));
  }

  /// A tile that lies wholly inside.
  HWY_INLINE void whole_tile(int row, int column) {
    const std::size_t tile = index(row, column);
    const float near0 =
        near_at(static_cast<float>(column * tile_size) + 0.5f, static_cast<float>(row * tile_size) + 0.5f);
    float& farthest = tiles_.farthest[tile];
    if (farthest >= std::max(near0 + largest_step_, least_)) return;
    ++strip_.tiles_filled;
    const Float d;
    const auto near = hn::Set(d, near0), least = hn::Set(d, least_);
    float* hidden = tiles_.hidden[tile].lane;
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      const auto here = hn::Max(hn::Add(near, hn::Load(d, near_step_ + l)), least);
      hn::Store(hn::Max(hn::Load(d, hidden + l), here), d, hidden + l);
    }
    farthest = std::max(farthest, std::max(near0 + least_step_, least_));
  }

  HWY_INLINE void any_tile(int row, int column) {
    const std::size_t tile = index(row, column);
    if (tiles_.farthest[tile] >= nearest_) return;  // nothing of this surface can change the tile
    const Float d;
    const float x = static_cast<float>(column * tile_size) + 0.5f, y = static_cast<float>(row * tile_size) + 0.5f;
    const float near0 = near_at(x, y);
    const auto at0 = hn::Set(d, at(edges_[0], x, y)), at1 = hn::Set(d, at(edges_[1], x, y)),
               at2 = hn::Set(d, at(edges_[2], x, y));
    HWY_ALIGN float inside[tile_pixels];  // of all edges, least
    auto least_inside = hn::Set(d, std::numeric_limits<float>::infinity()), most_inside = hn::Neg(least_inside);
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      const auto here = min3(hn::Add(at0, hn::Load(d, edge_step_[0] + l)), hn::Add(at1, hn::Load(d, edge_step_[1] + l)),
                             hn::Add(at2, hn::Load(d, edge_step_[2] + l)));
      hn::Store(here, d, inside + l);
      least_inside = hn::Min(least_inside, here);
      most_inside = hn::Max(most_inside, here);
    }
    const auto all_inside = hn::Set(d, 1.0f), outside = hn::Set(d, -1.0f);
    if (hn::AllFalse(d, hn::Ge(most_inside, outside))) return;
    ++strip_.tiles_filled;
    const auto near_here = hn::Set(d, near0), least = hn::Set(d, least_);
    const auto near_of = [&](std::size_t l) SIGHTLINE_INLINE_LAMBDA {
      return hn::Max(hn::Add(near_here, hn::Load(d, near_step_ + l)), least);
    };
    if (!hn::AllFalse(d, hn::Ge(most_inside, all_inside))) {  // some pixels are covered wholly
      float* hidden = tiles_.hidden[tile].lane;
      for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
        const auto old = hn::Load(d, hidden + l);
        const auto whole = hn::Ge(hn::Load(d, inside + l), all_inside);
        hn::Store(hn::IfThenElse(whole, hn::Max(old, near_of(l)), old), d, hidden + l);
      }
      if (hn::AllTrue(d, hn::Ge(least_inside, all_inside))) {
        tiles_.farthest[tile] = std::max(tiles_.farthest[tile], std::max(near0 + least_step_, least_));
        return;
      }
    }
    // Pixels that this triangle covers in part.
    const std::size_t place = strip_.place(row, column);
    float* layer = strip_.layer[place].lane;
    std::uint32_t covered = 0;
    const auto limit = [&](float value) SIGHTLINE_INLINE_LAMBDA { return hn::Set(d, value); };
    const auto left = limit(box_low_x_ - x), right = limit(box_high_x_ - x), top = limit(box_low_y_ - y),
               bottom = limit(box_high_y_ - y);
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      const auto here = hn::Load(d, inside + l);
      const auto shared = hn::AndNot(hn::Ge(here, all_inside), hn::Ge(here, outside));
      const auto gathered = hn::Load(d, layer + l);
      hn::Store(hn::IfThenElse(shared, hn::Min(gathered, near_of(l)), gathered), d, layer + l);
      const auto px = hn::Load(d, lane_x + l), py = hn::Load(d, lane_y + l);
      const auto in_box =
          hn::And(hn::And(hn::Ge(px, left), hn::Le(px, right)), hn::And(hn::Ge(py, top), hn::Le(py, bottom)));
      const auto centre = hn::And(hn::And(shared, hn::Ge(here, hn::Set(d, -edge_slack))), in_box);
      covered |= bits_of(d, centre) << l;
    }
    strip_.covered[place] = static_cast<std::uint16_t>(strip_.covered[place] | covered);
    touch(strip_, tile, place);
  }

  Edge edges_[3];
  float gradient_x_, gradient_y_, base_, least_;
  float box_low_x_, box_high_x_, box_low_y_, box_high_y_;
  float nearest_;
  float least_step_, largest_step_;
  Tiles& tiles_;
  Strip& strip_;
  HWY_ALIGN float edge_step_[3][tile_pixels];
  HWY_ALIGN float near_step_[tile_pixels];
};

/// Marks every pixel whose square, widened by the margin, the segment touches (separating axes: x, y, its normal).
HWY_INLINE void mark(const DrawList& list, std::size_t e, const Run& run, Tiles& tiles, Strip& strip) {
  const Float d;
  const float margin = run.margins.pixels, square = run.margins.square;
  const float px = list.edge_x[0][e], py = list.edge_y[0][e], qx = list.edge_x[1][e], qy = list.edge_y[1][e];
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
      if (bits == 0) continue;
      const std::size_t place = strip.place(row, column);
      strip.contour[place] = static_cast<std::uint16_t>(strip.contour[place] | bits);
      touch(strip, tile, place);
    }
  }
}

/// Ends a surface: what its layer proves goes into `hidden`.
HWY_INLINE void commit(Tiles& tiles, Strip& strip) {
  const Float d;
  const auto empty = hn::Set(d, std::numeric_limits<float>::infinity());
  for (const auto [tile, place] : strip.touched) {
    const auto proven = static_cast<std::uint32_t>(strip.covered[place] & ~strip.contour[place]);
    auto farthest = empty;
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      float* layer = strip.layer[place].lane + l;
      float* hidden = tiles.hidden[tile].lane + l;
      std::uint8_t bytes[8] = {static_cast<std::uint8_t>(proven >> l), static_cast<std::uint8_t>(proven >> l >> 8)};
      const auto mask = hn::LoadMaskBits(d, bytes);
      auto now = hn::Load(d, hidden);
      now = hn::IfThenElse(mask, hn::Max(now, hn::Load(d, layer)), now);
      hn::Store(now, d, hidden);
      hn::Store(empty, d, layer);
      farthest = hn::Min(farthest, now);
    }
    tiles.farthest[tile] = hn::GetLane(hn::MinOfLanes(d, farthest));
    strip.covered[place] = strip.contour[place] = 0;
    strip.listed[place] = 0;
  }
  strip.touched.clear();
}

/// True if every tile of the ranges hides what is of nearness `near`.
HWY_INLINE bool hides_tiles(const Tiles& tiles, TileRange columns, TileRange rows, float near) {
  const Float d;
  const auto limit = hn::Set(d, near);
  for (int row = rows.first; row <= rows.last; ++row) {
    const float* farthest =
        tiles.farthest.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across);
    const auto last = static_cast<std::size_t>(columns.last) + 1;
    for (auto i = static_cast<std::size_t>(columns.first); i < last; i += float_lanes()) {
      auto open = hn::Lt(hn::LoadU(d, farthest + i), limit);
      open = hn::And(open, hn::FirstN(d, std::min(float_lanes(), last - i)));
      if (!hn::AllFalse(d, open)) return false;
    }
  }
  return true;
}

HWY_INLINE void draw_run(const DrawList& list, const Run& run, Tiles& tiles, Strip& strip) {
  Setups setups;
  for (std::size_t first = run.first_triangle; first < run.last_triangle; first += tile_pixels) {
    const std::size_t count = std::min<std::size_t>(tile_pixels, run.last_triangle - first);
    setups.valid = 0;
    for (std::size_t l = 0; l < count; l += float_lanes()) set_up(list, first, run.margins, tiles, strip, l, setups);
    std::uint32_t valid = setups.valid & (0xFFFFu >> (tile_pixels - count));
    for (std::size_t t = 0; valid != 0; ++t, valid >>= 1) {
      if ((valid & 1u) == 0) continue;
      TriangleFill(setups, t, run, tiles, strip)
          .rows({setups.first_column[t], setups.last_column[t]}, {setups.first_row[t], setups.last_row[t]});
    }
  }
  for (std::size_t e = run.first_edge; e < run.last_edge; ++e) mark(list, e, run, tiles, strip);
}

/// Draws the strip's list, the near surfaces first: they spare the work for the others.
HWY_INLINE void draw_list(Tiles& tiles, Strip& strip) {
  DrawList& list = strip.list;
  std::sort(list.surfaces.begin(), list.surfaces.end(), [](const Surface& a, const Surface& b) {
    return a.nearest != b.nearest ? a.nearest > b.nearest : a.first < b.first;
  });
  for (const Surface& surface : list.surfaces) {
    for (std::size_t r = surface.first; r < surface.last; ++r) {
      const Run& run = list.runs[r];
      // What was drawn since it was prepared may hide it by now; a surface with clipped parts is near without bound.
      if (!hides_tiles(tiles, {run.first_column, run.last_column}, {run.first_row, run.last_row}, run.nearest))
        draw_run(list, run, tiles, strip);
    }
    commit(tiles, strip);
  }
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
