// Fourth stage: which 8 x 8 tiles a triangle touches, from its edge functions at two corners of the tile each (Pineda
// 1988; Greene 1996). Fifth stage (fine): which pixel centres of a tile it covers, as 64 bits. Checklist 5.02.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sightline/raster/setup.hpp"

namespace sightline::raster {

inline constexpr int coarse_size = 8;  // pixels across and down a tile

enum class TileCover : std::uint8_t { none, part, full };

/// How the triangle covers the pixel centres [x, x + width) x [y, y + height). `none` and `full` are exact answers for
/// one edge; `part` may turn out empty.
inline TileCover classify_tile(const TriangleSetup& t, int x, int y, int width, int height) {
  TileCover cover = TileCover::full;
  for (const Edge& e : t.edges) {
    const std::int64_t corner = e.at(x, y), across = e.dx * (width - 1), down = e.dy * (height - 1);
    const std::int64_t most = corner + std::max<std::int64_t>(across, 0) + std::max<std::int64_t>(down, 0);
    if (most < 0) return TileCover::none;
    const std::int64_t least = corner + std::min<std::int64_t>(across, 0) + std::min<std::int64_t>(down, 0);
    if (least < 0) cover = TileCover::part;
  }
  return cover;
}

/// Calls tile(x, y, width, height, cover) for all tiles that may be touched, cut to the bounding box; row by row.
template <class F>
void each_tile(const TriangleSetup& t, F&& tile) {
  for (int y = t.y0; y < t.y1; y = (y | (coarse_size - 1)) + 1)
    for (int x = t.x0; x < t.x1; x = (x | (coarse_size - 1)) + 1) {
      const int width = std::min(t.x1, (x | (coarse_size - 1)) + 1) - x;
      const int height = std::min(t.y1, (y | (coarse_size - 1)) + 1) - y;
      const TileCover cover = classify_tile(t, x, y, width, height);
      if (cover != TileCover::none) tile(x, y, width, height, cover);
    }
}

/// Fine pass: calls pixel(x, y) for each covered centre of the tile, row by row; one addition per edge and pixel.
template <class F>
void each_pixel(const TriangleSetup& t, int x, int y, int width, int height, TileCover cover, F&& pixel) {
  if (cover == TileCover::full) {
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i) pixel(x + i, y + j);
    return;
  }
  for (int j = 0; j < height; ++j) {
    std::int64_t e0 = t.edges[0].at(x, y + j), e1 = t.edges[1].at(x, y + j), e2 = t.edges[2].at(x, y + j);
    for (int i = 0; i < width; ++i) {
      if ((e0 | e1 | e2) >= 0) pixel(x + i, y + j);
      e0 += t.edges[0].dx;
      e1 += t.edges[1].dx;
      e2 += t.edges[2].dx;
    }
  }
}

}  // namespace sightline::raster
