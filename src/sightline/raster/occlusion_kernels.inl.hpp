// The loops of occlusion_kernels.hpp, compiled once per SIMD target. The idea
// (../../../docs/algorithms/occlusion_masked.md): a pixel square that no contour edge of an occluder's projection
// touches is covered wholly or not at all, and its centre tells which. A pixel that one triangle covers wholly is
// written at once; pixels that several triangles of the occluder share gather in a layer, or in pieces where a contour
// edge touches the tile, and are written at its end. Here is the drawing; occlusion_contour, occlusion_setup,
// occlusion_prepare and occlusion_query are the rest.

#if defined(SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#undef SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_KERNELS_INL
#endif

#include "sightline/raster/occlusion_contour.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

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
        rise_(s.rise[t]),
        most_(s.most[t]),
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
    const bool has_contour = strip_.rim[place] != no_piece;
    float* layer = strip_.layer[place].lane;
    Piece* piece = has_contour ? &add_piece(strip_, strip_.piece[place]) : nullptr;
    const auto none = hn::Set(d, std::numeric_limits<float>::infinity());
    const float* hidden = tiles_.hidden[tile].lane;
    std::uint32_t covered = 0, promising = 0;
    const auto limit = [&](float value) SIGHTLINE_INLINE_LAMBDA { return hn::Set(d, value); };
    const auto left = limit(box_low_x_ - x), right = limit(box_high_x_ - x), top = limit(box_low_y_ - y),
               bottom = limit(box_high_y_ - y);
    for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
      const auto here = hn::Load(d, inside + l);
      const auto shared = hn::AndNot(hn::Ge(here, all_inside), hn::Ge(here, outside));
      const auto plane = hn::Add(near_here, hn::Load(d, near_step_ + l));
      const auto low = hn::Max(plane, least);
      if (piece != nullptr)
        hn::Store(hn::IfThenElse(shared, plane, none), d, piece->plane + l);
      else
        hn::Store(hn::Min(hn::Load(d, layer + l), hn::IfThenElse(shared, low, none)), d, layer + l);
      const auto px = hn::Load(d, lane_x + l), py = hn::Load(d, lane_y + l);
      const auto in_box =
          hn::And(hn::And(hn::Ge(px, left), hn::Le(px, right)), hn::And(hn::Ge(py, top), hn::Le(py, bottom)));
      const auto centre = hn::And(hn::And(shared, hn::Ge(here, hn::Set(d, -edge_slack))), in_box);
      covered |= bits_of(d, centre) << l;
      if (piece != nullptr) promising |= bits_of(d, hn::And(centre, hn::Gt(low, hn::Load(d, hidden + l)))) << l;
    }
    if (piece != nullptr) {
      piece->least = least_;
      piece->rise = rise_;
      piece->most = most_;
      piece->covered = covered;
      covered = promising;
    }
    strip_.covered[place] = static_cast<std::uint16_t>(strip_.covered[place] | covered);
    touch(strip_, tile, place);
  }

  Edge edges_[3];
  float gradient_x_, gradient_y_, base_, least_, rise_, most_;
  float box_low_x_, box_high_x_, box_low_y_, box_high_y_;
  float nearest_;
  float least_step_, largest_step_;
  Tiles& tiles_;
  Strip& strip_;
  HWY_ALIGN float edge_step_[3][tile_pixels];
  HWY_ALIGN float near_step_[tile_pixels];
};

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

HWY_INLINE void fill_run(const DrawList& list, const Run& run, Tiles& tiles, Strip& strip) {
  Setups setups;
  for (std::size_t first = run.first_triangle; first < run.last_triangle; first += tile_pixels) {
    const std::size_t count = std::min<std::size_t>(tile_pixels, run.last_triangle - first);
    const std::uint32_t here = 0xFFFFu >> (tile_pixels - count);
    setups.valid = setups.flat = 0;
    for (std::size_t l = 0; l < count; l += float_lanes()) set_up(list, first, run.margins, tiles, strip, l, setups);
    std::uint32_t valid = setups.valid & here;
    for (std::size_t t = 0; valid != 0; ++t, valid >>= 1) {
      if ((valid & 1u) == 0) continue;
      TriangleFill(setups, t, run, tiles, strip)
          .rows({setups.first_column[t], setups.last_column[t]}, {setups.first_row[t], setups.last_row[t]});
    }
    std::uint32_t flat = setups.flat & here;
    for (std::size_t t = 0; flat != 0; ++t, flat >>= 1)
      if ((flat & 1u) != 0) mark_flat(list, first + t, setups.least[t], setups.most[t], run, tiles, strip);
  }
}

/// Draws the strip's list, the near surfaces first: they spare the work for the others.
HWY_INLINE void draw_list(Tiles& tiles, Strip& strip) {
  DrawList& list = strip.list;
  std::sort(list.surfaces.begin(), list.surfaces.end(), [](const Surface& a, const Surface& b) {
    return a.nearest != b.nearest ? a.nearest > b.nearest : a.first < b.first;
  });
  for (const Surface& surface : list.surfaces) {
    // What was drawn since it was prepared may hide it by now; a surface with clipped parts is near without bound.
    const Run& all = list.runs[surface.first];  // the runs of a surface have its ranges and its nearness
    if (hides_tiles(tiles, {all.first_column, all.last_column}, {all.first_row, all.last_row}, all.nearest)) continue;
    for (std::size_t r = surface.first; r < surface.last; ++r) mark_contour(list, list.runs[r], tiles, strip);
    for (std::size_t r = surface.first; r < surface.last; ++r) fill_run(list, list.runs[r], tiles, strip);
    commit(tiles, strip);
  }
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
