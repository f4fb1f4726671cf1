// Ranges of tiles, and edges of triangles as functions over the image, cut to the rows of tiles that they cross. Once
// per SIMD target.

#if defined(SIGHTLINE_RASTER_OCCLUSION_EDGES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_RASTER_OCCLUSION_EDGES_INL
#undef SIGHTLINE_RASTER_OCCLUSION_EDGES_INL
#else
#define SIGHTLINE_RASTER_OCCLUSION_EDGES_INL
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

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
