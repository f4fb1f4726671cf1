// The questions to the buffer: boxes to rectangles of pixels, a box per lane, with the rounding of floats bounded; and
// whether all that a rectangle or a convex outline touches is hidden. Once per SIMD target.

#if defined(SIGHTLINE_RASTER_OCCLUSION_QUERY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_QUERY_INL
#undef SIGHTLINE_RASTER_OCCLUSION_QUERY_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_QUERY_INL
#endif

#include "sightline/raster/occlusion_kernels.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

/// True if one of the pixels [x0, x1) x [y0, y1) of a tile does not hide what is of nearness `near`.
HWY_INLINE bool open_pixels(const Tiles& tiles, std::size_t tile, int column, int row, int x0, int y0, int x1, int y1,
                            float near) {
  const Float d;
  const auto first_x = hn::Set(d, static_cast<float>(column * tile_size)),
             first_y = hn::Set(d, static_cast<float>(row * tile_size));
  for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
    const auto px = hn::Add(first_x, hn::Load(d, lane_x + l)), py = hn::Add(first_y, hn::Load(d, lane_y + l));
    auto open = hn::Le(hn::Load(d, tiles.hidden[tile].lane + l), hn::Set(d, near));
    open = hn::And(
        open, hn::And(hn::Ge(px, hn::Set(d, static_cast<float>(x0))), hn::Lt(px, hn::Set(d, static_cast<float>(x1)))));
    open = hn::And(
        open, hn::And(hn::Ge(py, hn::Set(d, static_cast<float>(y0))), hn::Lt(py, hn::Set(d, static_cast<float>(y1)))));
    if (!hn::AllFalse(d, open)) return true;
  }
  return false;
}

inline bool hides(const Tiles& tiles, int x0, int y0, int x1, int y1, float near) {
  const Float d;
  const auto limit = hn::Set(d, near);
  const auto first = static_cast<std::size_t>(x0 / tile_size),
             last = static_cast<std::size_t>((x1 - 1) / tile_size) + 1;
  for (int row = y0 / tile_size; row <= (y1 - 1) / tile_size; ++row) {
    const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across);
    for (std::size_t i = first; i < last; i += float_lanes()) {
      auto open = hn::Le(load_some(tiles.farthest.data() + base + i, last - i), limit);
      open = hn::And(open, hn::FirstN(d, std::min(float_lanes(), last - i)));
      if (hn::AllFalse(d, open)) continue;
      std::uint32_t bits = bits_of(d, open);
      for (std::size_t k = i; bits != 0; ++k, bits >>= 1) {
        if ((bits & 1u) == 0) continue;
        const int column = static_cast<int>(k);
        if (open_pixels(tiles, base + k, column, row, x0, y0, x1, y1, near)) return false;
      }
    }
  }
  return true;
}

inline bool hides_hull(const Tiles& tiles, const Hull& hull) {
  const Float d;
  const auto left = hn::Set(d, static_cast<float>(hull.x0)), right = hn::Set(d, static_cast<float>(hull.x1));
  const auto top = hn::Set(d, static_cast<float>(hull.y0)), bottom = hn::Set(d, static_cast<float>(hull.y1));
  const auto affine = [&](float a, float b, float c, auto x, auto y) SIGHTLINE_INLINE_LAMBDA {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, a), x), hn::Mul(hn::Set(d, b), y)), hn::Set(d, c));
  };
  for (int row = hull.y0 / tile_size; row <= (hull.y1 - 1) / tile_size; ++row)
    for (int column = hull.x0 / tile_size; column <= (hull.x1 - 1) / tile_size; ++column) {
      const std::size_t tile =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles.across) + static_cast<std::size_t>(column);
      if (tiles.farthest[tile] > hull.near) continue;
      const auto tile_x = hn::Set(d, static_cast<float>(column * tile_size)),
                 tile_y = hn::Set(d, static_cast<float>(row * tile_size));
      for (std::size_t l = 0; l < tile_pixels; l += float_lanes()) {
        const auto px = hn::Add(tile_x, hn::Load(d, lane_x + l)), py = hn::Add(tile_y, hn::Load(d, lane_y + l));
        auto near = hn::Set(d, hull.near);
        for (int i = 0; i < hull.planes; ++i)
          near = hn::Min(near, affine(hull.plane_a[i], hull.plane_b[i], hull.plane_c[i], px, py));
        auto open = hn::Le(hn::Load(d, tiles.hidden[tile].lane + l), near);
        if (hn::AllFalse(d, open)) continue;
        open = hn::And(open, hn::And(hn::Ge(px, left), hn::Lt(px, right)));
        open = hn::And(open, hn::And(hn::Ge(py, top), hn::Lt(py, bottom)));
        for (int i = 0; i < hull.edges; ++i)
          open =
              hn::And(open, hn::Ge(affine(hull.edge_a[i], hull.edge_b[i], hull.edge_c[i], px, py), hn::Set(d, -1.0f)));
        if (!hn::AllFalse(d, open)) return false;
      }
    }
  return true;
}

/// Pixels by which coverage of occludees is rounded outwards, beyond the bound of the floats' rounding.
inline constexpr float query_margin = 1.0f / 64;

HWY_INLINE void project_lanes(const QueryView& q, const float* boxes, std::size_t count, std::size_t at,
                              Rectangles& out) {
  const Float d;
  const Int di;
  const ScreenTransform& t = q.screen;
  HWY_ALIGN float corner[6][tile_pixels];
  const std::size_t here = std::min(float_lanes(), count - at);
  for (std::size_t k = 0; k < float_lanes(); ++k) {
    const float* box = boxes + 6 * (at + std::min(k, here - 1));
    for (std::size_t i = 0; i < 6; ++i) corner[i][k] = box[i];
  }
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  // Corners relative to the eye, and their three terms of every row.
  hn::Vec<Float> x_terms[2][3], y_terms[2][3], w_terms[2][3];
  auto length = hn::Set(d, q.eye_low_sum);
  auto empty = hn::Lt(one, zero);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto lo = hn::Load(d, corner[axis]), hi = hn::Load(d, corner[axis + 3]);
    empty = hn::Or(empty, hn::Gt(lo, hi));
    auto longest = zero;
    for (std::size_t end = 0; end < 2; ++end) {
      const auto p = end == 0 ? lo : hi;
      const auto r = hn::Sub(hn::Sub(p, hn::Set(d, t.eye_high[axis])), hn::Set(d, t.eye_low[axis]));
      longest = hn::Max(longest, hn::Abs(r));
      x_terms[end][axis] = hn::Mul(hn::Set(d, t.to_x[axis]), r);
      y_terms[end][axis] = hn::Mul(hn::Set(d, t.to_y[axis]), r);
      w_terms[end][axis] = hn::Mul(hn::Set(d, t.to_w[axis]), r);
    }
    length = hn::Add(length, longest);
  }
  // Every row's value is wrong by at most this times the row's length: eight roundings of terms no longer than
  // `length`, doubled for what is of second order.
  const auto error = hn::Mul(length, hn::Set(d, 0x1p-20f));
  const auto infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  auto x0 = infinity, y0 = infinity, x1 = hn::Neg(infinity), y1 = x1, nearest = infinity, farthest = x1;
  const auto scale = hn::Set(d, q.pixels_per_unit);
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t a = i & 1, b = (i >> 1) & 1, c = i >> 2;
    auto x = hn::Add(hn::Add(x_terms[a][0], x_terms[b][1]), x_terms[c][2]);
    auto y = hn::Add(hn::Add(y_terms[a][0], y_terms[b][1]), y_terms[c][2]);
    const auto w = hn::Add(hn::Add(w_terms[a][0], w_terms[b][1]), w_terms[c][2]);
    nearest = hn::Min(nearest, w);
    farthest = hn::Max(farthest, w);
    auto slack_x = hn::Mul(error, scale), slack_y = slack_x;
    if (t.perspective) {
      const auto per_w = hn::Div(one, w);
      const auto share = hn::Abs(hn::Mul(error, per_w));
      x = hn::Mul(x, per_w);
      y = hn::Mul(y, per_w);
      slack_x = hn::Mul(share, hn::Add(scale, hn::Abs(x)));
      slack_y = hn::Mul(share, hn::Add(scale, hn::Abs(y)));
    }
    x0 = hn::Min(x0, hn::Sub(x, slack_x));
    x1 = hn::Max(x1, hn::Add(x, slack_x));
    y0 = hn::Min(y0, hn::Sub(y, slack_y));
    y1 = hn::Max(y1, hn::Add(y, slack_y));
  }
  const auto pixel = [&](auto v, float centre, float margin, int pixels) SIGHTLINE_INLINE_LAMBDA {
    const auto moved = hn::Add(hn::Add(v, hn::Set(d, centre)), hn::Set(d, margin));
    return hn::Floor(hn::Min(hn::Max(moved, hn::Set(d, -1.0f)), hn::Set(d, static_cast<float>(pixels))));
  };
  // Pixel i counts if its part [i + 0.5 - square, i + 0.5 + square], widened, meets the box.
  const float margin = q.square - 0.5f + query_margin;
  const auto left = hn::Max(pixel(x0, t.centre_x, -margin, q.width), zero);
  const auto top = hn::Max(pixel(y0, t.centre_y, -margin, q.height), zero);
  const auto right =
      hn::Min(hn::Add(pixel(x1, t.centre_x, margin, q.width), one), hn::Set(d, static_cast<float>(q.width)));
  const auto bottom =
      hn::Min(hn::Add(pixel(y1, t.centre_y, margin, q.height), one), hn::Set(d, static_cast<float>(q.height)));
  auto distance = hn::Sub(nearest, error);
  auto hidden = hn::Or(hn::Ge(left, right), hn::Ge(top, bottom));
  auto seen = hn::Lt(one, zero);
  auto near = hn::Neg(distance);
  if (t.perspective) {
    near = hn::Div(one, distance);
    const auto near_plane = hn::Set(d, q.near_plane);
    // Not (distance > near plane), so that what is no number is seen.
    seen = hn::Not(hn::And(hn::Gt(distance, near_plane), hn::Gt(distance, hn::Mul(error, hn::Set(d, 8.0f)))));
    hidden = hn::AndNot(seen, hidden);
    const auto behind = hn::Lt(hn::Add(farthest, error), hn::Mul(near_plane, hn::Set(d, 1.0f - 0x1p-19f)));
    hidden = hn::Or(hidden, behind);
  }
  hidden = hn::Or(hidden, empty);
  near = hn::Add(near, hn::Mul(hn::Abs(near), hn::Set(d, 0x1p-20f)));
  hn::StoreU(hn::ConvertTo(di, left), di, out.x0 + at);
  hn::StoreU(hn::ConvertTo(di, top), di, out.y0 + at);
  hn::StoreU(hn::ConvertTo(di, right), di, out.x1 + at);
  hn::StoreU(hn::ConvertTo(di, bottom), di, out.y1 + at);
  hn::StoreU(near, d, out.near + at);
  // The box's centre: inside its outline.
  const auto half = hn::Set(d, 0.5f);
  const auto middle = [&](const auto& terms) SIGHTLINE_INLINE_LAMBDA {
    auto sum = hn::Add(terms[0][0], terms[1][0]);
    for (std::size_t axis = 1; axis < 3; ++axis) sum = hn::Add(sum, hn::Add(terms[0][axis], terms[1][axis]));
    return hn::Mul(sum, half);
  };
  auto centre_x = middle(x_terms), centre_y = middle(y_terms);
  auto far = hn::Neg(hn::Add(farthest, error));
  if (t.perspective) {
    const auto per_w = hn::Div(one, middle(w_terms));
    centre_x = hn::Mul(centre_x, per_w);
    centre_y = hn::Mul(centre_y, per_w);
    far = hn::Div(one, hn::Add(farthest, error));
  }
  far = hn::Sub(far, hn::Mul(hn::Abs(far), hn::Set(d, 0x1p-20f)));
  const auto centre_pixel = [&](auto v, float centre, auto low, auto high) SIGHTLINE_INLINE_LAMBDA {
    const auto place = hn::Floor(hn::Add(v, hn::Set(d, centre)));
    const auto within = hn::And(hn::Ge(place, low), hn::Lt(place, high));
    return hn::ConvertTo(di, hn::IfThenElse(within, place, hn::Set(d, -1.0f)));
  };
  hn::StoreU(centre_pixel(centre_x, t.centre_x, left, right), di, out.centre_x + at);
  hn::StoreU(centre_pixel(centre_y, t.centre_y, top, bottom), di, out.centre_y + at);
  hn::StoreU(far, d, out.far + at);
  const std::uint32_t hidden_bits = bits_of(d, hidden), seen_bits = bits_of(d, seen);
  for (std::size_t k = 0; k < here; ++k)
    out.verdict[at + k] = ((hidden_bits >> k) & 1u) != 0 ? Verdict::hidden
                          : ((seen_bits >> k) & 1u) != 0 ? Verdict::seen
                                                         : Verdict::ask;
}

inline void project_boxes(const QueryView& q, const float* boxes, std::size_t count, Rectangles& out) {
  for (std::size_t at = 0; at < count; at += float_lanes()) project_lanes(q, boxes, count, at, out);
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
