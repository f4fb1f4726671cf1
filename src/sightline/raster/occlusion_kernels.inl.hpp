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
    const bool wide = all_columns.last - all_columns.first > 2;  // whatever the strip, so that the same tiles count
    RowSpans spans;
    for (int row = rows.first; row <= rows.last; ++row) {
      TileRange range = columns, inner{columns.last + 1, columns.last};
      if (wide) {
        const auto at = static_cast<std::size_t>(row - rows.first) % tile_pixels;
        if (at == 0) {
          const Crossing crossings[3] = {Crossing(edges_[0]), Crossing(edges_[1]), Crossing(edges_[2])};
          cut_rows(edges_, crossings, columns, tiles_.width, row, rows.last - row + 1, spans);
        }
        range = {spans.first[at], spans.last[at]};
        inner = {spans.inner_first[at], spans.inner_last[at]};
      }
      for (int column = range.first; column <= range.last; ++column) {
        if (column == inner.first)
          for (; column <= inner.last; ++column) whole_tile(row, column);
        if (column <= range.last) any_tile(row, column);
      }
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
    hn::Vec<Float> inside[tile_vectors];  // of all edges, least
    auto most_inside = hn::Set(d, nothing_near);
    for (std::size_t v = 0; v < tile_vectors; ++v) {
      const std::size_t l = v * float_lanes();
      inside[v] = min3(hn::Add(at0, hn::Load(d, edge_step_[0] + l)), hn::Add(at1, hn::Load(d, edge_step_[1] + l)),
                       hn::Add(at2, hn::Load(d, edge_step_[2] + l)));
      most_inside = hn::Max(most_inside, inside[v]);
    }
    const auto outside = hn::Set(d, -1.0f);
    if (hn::AllFalse(d, hn::Ge(most_inside, outside))) return;
    ++strip_.tiles_filled;
    const std::size_t place = strip_.place(row, column);
    Place& state = strip_.places[place];
    touch(strip_, state, tile, place);
    if (state.rim != no_piece)
      contour_tile(inside, near0, x, y, tiles_.hidden[tile].lane, state);
    else if (tiles_.farthest[tile] >= std::max(std::min(near0 + largest_step_, most_), least_))
      spoil_tile(inside, near0, strip_.layer[place].lane);
    else
      inner_tile(inside, near0, x, y, tiles_.hidden[tile].lane, strip_.layer[place].lane, state);
  }

  /// What a tile loop knows of the lanes from l on. Pixels are covered wholly or shared with others.
  struct Lanes {
    hn::Vec<Float> plane, low;
    hn::Mask<Float> whole, shared;
  };
  HWY_INLINE Lanes lanes(hn::Vec<Float> inside, float near0, std::size_t l) const {
    const Float d;
    const auto plane = hn::Add(hn::Set(d, near0), hn::Load(d, near_step_ + l));
    const auto whole = hn::Ge(inside, hn::Set(d, 1.0f));
    return {plane, hn::Max(plane, hn::Set(d, least_)), whole, hn::AndNot(whole, hn::Ge(inside, hn::Set(d, -1.0f)))};
  }
  /// Lanes whose centre counts as covered; x, y: the centre of the tile's first pixel.
  HWY_INLINE hn::Mask<Float> centres(hn::Vec<Float> inside, float x, float y, std::size_t l) const {
    const Float d;
    const auto px = hn::Load(d, lane_x + l), py = hn::Load(d, lane_y + l);
    const auto in_x = hn::And(hn::Ge(px, hn::Set(d, box_low_x_ - x)), hn::Le(px, hn::Set(d, box_high_x_ - x)));
    const auto in_y = hn::And(hn::Ge(py, hn::Set(d, box_low_y_ - y)), hn::Le(py, hn::Set(d, box_high_y_ - y)));
    return hn::And(hn::Ge(inside, hn::Set(d, -edge_slack)), hn::And(in_x, in_y));
  }
  static HWY_INLINE void raise(float* hidden, const Lanes& here) {
    const Float d;
    const auto old = hn::Load(d, hidden);
    hn::Store(hn::IfThenElse(here.whole, hn::Max(old, here.low), old), d, hidden);
  }
  static HWY_INLINE void lower(float* layer, const Lanes& here) {
    const Float d;
    const auto old = hn::Load(d, layer);
    hn::Store(hn::IfThenElse(here.shared, hn::Min(old, here.low), old), d, layer);
  }

  /// A tile without a contour, all of which hides the triangle: pixels that it shares prove nothing any more.
  HWY_INLINE void spoil_tile(const hn::Vec<Float>* inside, float near0, float* layer) const {
    for (std::size_t v = 0; v < tile_vectors; ++v)
      lower(layer + v * float_lanes(), lanes(inside[v], near0, v * float_lanes()));
  }

  /// A tile without a contour.
  HWY_INLINE void inner_tile(const hn::Vec<Float>* inside, float near0, float x, float y, float* hidden, float* layer,
                             Place& state) const {
    std::uint32_t covered = 0;
    for (std::size_t v = 0; v < tile_vectors; ++v) {
      const std::size_t l = v * float_lanes();
      const Lanes here = lanes(inside[v], near0, l);
      raise(hidden + l, here);
      lower(layer + l, here);
      covered |= bits_of(Float(), hn::And(here.shared, centres(inside[v], x, y, l))) << l;
    }
    state.covered = static_cast<std::uint16_t>(state.covered | covered);
  }

  /// A tile with a contour: what the triangle is there is kept as a piece.
  HWY_INLINE void contour_tile(const hn::Vec<Float>* inside, float near0, float x, float y, float* hidden,
                               Place& state) const {
    const Float d;
    Piece& piece = add_piece(strip_, state.piece);
    piece.least = least_;
    piece.rise = rise_;
    piece.most = most_;
    std::uint32_t covered = 0, promising = 0;
    for (std::size_t v = 0; v < tile_vectors; ++v) {
      const std::size_t l = v * float_lanes();
      const Lanes here = lanes(inside[v], near0, l);
      raise(hidden + l, here);
      hn::Store(hn::IfThenElse(here.shared, here.plane, hn::Set(d, std::numeric_limits<float>::infinity())), d,
                piece.plane + l);
      const auto centre = hn::And(here.shared, centres(inside[v], x, y, l));
      covered |= bits_of(d, centre) << l;
      promising |= bits_of(d, hn::And(centre, hn::Gt(here.low, hn::Load(d, hidden + l)))) << l;
    }
    piece.covered = covered;
    state.covered = static_cast<std::uint16_t>(state.covered | promising);
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
      auto open = hn::Lt(load_some(farthest + i, last - i), limit);
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
