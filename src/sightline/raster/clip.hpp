// Second stage: clipping in homogeneous space at the near and far plane and at a guard band far outside of the image
// (Sutherland and Hodgman 1974; Blinn and Newell 1978). Between near and far w is positive, so division is safe.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sightline/raster/vertex.hpp"

namespace sightline::raster {

/// Largest window coordinate, pixels, that setup takes: keeps all edge functions within 63 bits.
inline constexpr float guard_pixels = 32768.0f;

/// Signed distances to the clip planes; inside where all are >= 0. `guard_x`, `guard_y`: guard band in units of w.
inline std::array<float, 6> clip_distances(const glm::vec4& p, float guard_x, float guard_y) {
  return {p.w + p.z, p.w - p.z, guard_x * p.w + p.x, guard_x * p.w - p.x, guard_y * p.w + p.y, guard_y * p.w - p.y};
}

/// Clips the convex polygon in place; `scratch` is reused. New vertices are computed from the inner end of the crossing
/// edge on, so that both triangles at an edge get the same one. An empty polygon remains where nothing is inside.
template <std::size_t N>
void clip_polygon(std::vector<ClipVertex<N>>& polygon, std::vector<ClipVertex<N>>& scratch, int width, int height) {
  const float guard_x = guard_pixels / (0.5f * static_cast<float>(std::max(width, 1))) - 1.0f;
  const float guard_y = guard_pixels / (0.5f * static_cast<float>(std::max(height, 1))) - 1.0f;
  for (std::size_t plane = 0; plane < 6 && !polygon.empty(); ++plane) {
    const auto distance = [&](const ClipVertex<N>& v) { return clip_distances(v.position, guard_x, guard_y)[plane]; };
    if (std::all_of(polygon.begin(), polygon.end(), [&](const auto& v) { return distance(v) >= 0.0f; })) continue;
    scratch.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const ClipVertex<N>& a = polygon[i];
      const ClipVertex<N>& b = polygon[(i + 1) % polygon.size()];
      const float da = distance(a), db = distance(b);
      if (da >= 0.0f) scratch.push_back(a);
      if ((da >= 0.0f) == (db >= 0.0f)) continue;
      const ClipVertex<N>&in = da >= 0.0f ? a : b, &out = da >= 0.0f ? b : a;
      const float t = std::max(da, db) / std::abs(da - db);
      ClipVertex<N> crossing;
      crossing.position = in.position + t * (out.position - in.position);
      for (std::size_t k = 0; k < N; ++k) crossing.varying[k] = in.varying[k] + t * (out.varying[k] - in.varying[k]);
      scratch.push_back(crossing);
    }
    polygon.swap(scratch);
  }
  // A vertex with w = 0 survives only where the whole volume shrinks to the eye.
  if (std::any_of(polygon.begin(), polygon.end(), [](const auto& v) { return !(v.position.w > 0.0f); }))
    polygon.clear();
}

}  // namespace sightline::raster
