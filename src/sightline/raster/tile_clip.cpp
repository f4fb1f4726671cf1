#include "sightline/raster/tile_clip.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline::raster {
namespace {

/// A corner in view space; `from` is the index of the vertex that it is, or -1 where an edge was cut.
struct Corner {
  double x, y, w;
  int from;
};

/// Six planes: near, far, and the guard band left, right, above, below.
double distance(const Corner& p, int plane, const MeshTransform& t) {
  const double guard = static_cast<double>(t.guard) * (t.perspective ? p.w : 1.0);
  switch (plane) {
    case 0:
      return p.w - static_cast<double>(t.near);
    case 1:
      return static_cast<double>(t.far) - p.w;
    case 2:
      return guard + p.x;
    case 3:
      return guard - p.x;
    case 4:
      return guard + p.y;
    default:
      return guard - p.y;
  }
}

using Polygon = std::array<Corner, 10>;

std::size_t clip(const Polygon& in, std::size_t count, int plane, const MeshTransform& t, Polygon& out) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Corner &a = in[i], &b = in[(i + 1) % count];
    const double da = distance(a, plane, t), db = distance(b, plane, t);
    if (da >= 0) out[kept++] = a;
    if ((da >= 0) == (db >= 0)) continue;
    const Corner &inner = da >= 0 ? a : b, &outer = da >= 0 ? b : a;
    const double s = std::max(da, db) / std::abs(da - db);
    out[kept++] = {inner.x + s * (outer.x - inner.x), inner.y + s * (outer.y - inner.y),
                   inner.w + s * (outer.w - inner.w), -1};
  }
  return kept;
}

}  // namespace

std::size_t clip_triangle(const VertexBuffer& in, std::size_t a, std::size_t b, std::size_t c, const MeshTransform& t,
                          VertexBuffer& out) {
  Polygon polygon{}, scratch{};
  std::size_t count = 0;
  for (const std::size_t v : {a, b, c}) {
    const float x = in.view_x[v], y = in.view_y[v], w = in.point[v].w;
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(w)) return 0;
    polygon[count++] = {static_cast<double>(x), static_cast<double>(y), static_cast<double>(w), static_cast<int>(v)};
  }
  for (int plane = 0; plane < 6 && count >= 3; ++plane) {
    if (plane == 1 && std::isinf(t.far)) continue;
    count = clip(polygon, count, plane, t, scratch);
    polygon = scratch;
  }
  if (count < 3) return 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Corner& p = polygon[i];
    if (p.from >= 0) {
      out.point[i] = in.point[static_cast<std::size_t>(p.from)];
      continue;
    }
    const double near = t.perspective ? 1.0 / p.w : -p.w, scale = t.perspective ? near : 1.0;
    out.point[i] = {static_cast<float>(static_cast<double>(t.centre_x) + p.x * scale),
                    static_cast<float>(static_cast<double>(t.centre_y) + p.y * scale), static_cast<float>(near),
                    static_cast<float>(p.w)};
  }
  return count;
}

}  // namespace sightline::raster
