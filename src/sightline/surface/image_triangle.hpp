// Triangles in the image of a calibrated camera, in double precision: exact on shared edges, depth affine in the image.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sightline {

/// A corner in the image; w grows towards the eye and is affine in the image (E5): 1 / distance, or minus the distance
/// for orthographic cameras.
struct Corner {
  double x, y, w;
};

inline double edge(const Corner& a, const Corner& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// What the corners of a triangle span in the image.
struct ImageBox {
  double min_x, max_x, min_y, max_y;
};
inline ImageBox box_of(const Corner& a, const Corner& b, const Corner& c) {
  return {std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y})};
}

/// Pixels [x0, x1] x [y0, y1]; none if x0 > x1 or y0 > y1.
struct PixelBox {
  int x0, x1, y0, y1;
  [[nodiscard]] bool empty() const { return x0 > x1 || y0 > y1; }
  [[nodiscard]] int count() const { return (x1 - x0 + 1) * (y1 - y0 + 1); }
};

/// A triangle of the image, turned so that edge() is positive inside (y down). Depth as w = w0 + wx x + wy y.
struct ImageTriangle {
  std::array<Corner, 3> c;
  std::array<double, 3> ex, ey, e0;  // edge i as e0 + ex * x + ey * y, exactly negated for the neighbour
  std::array<bool, 3> owns;
  double area, wx, wy, w0, low, high;

  bool set(const Corner& a, const Corner& b, const Corner& d) {
    if (!set_edges(a, b, d)) return false;
    set_depth();
    return true;
  }
  bool set_edges(const Corner& a, const Corner& b, const Corner& d) {
    c = {a, b, d};
    area = edge(a, b, d.x, d.y);
    if (!(area != 0.0) || !std::isfinite(area)) return false;
    if (area < 0.0) std::swap(c[1], c[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Corner &p = c[i], &q = c[(i + 1) % 3];
      // Coordinates are relative to the image; p x q in one order of operations, so that q x p is its negative.
      ex[i] = p.y - q.y;
      ey[i] = q.x - p.x;
      e0[i] = p.x * q.y - p.y * q.x;
      owns[i] = ex[i] > 0.0 || (ex[i] == 0.0 && ey[i] > 0.0);
    }
    return true;
  }
  void set_depth() {
    const double inverse = 1.0 / std::abs(area);
    wx = wy = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double w = c[(i + 2) % 3].w * inverse;
      wx += ex[i] * w;
      wy += ey[i] * w;
    }
    w0 = c[0].w - wx * c[0].x - wy * c[0].y;
    low = std::min({c[0].w, c[1].w, c[2].w});
    high = std::max({c[0].w, c[1].w, c[2].w});
  }
  [[nodiscard]] double value(std::size_t i, double x, double y) const { return ex[i] * x + (ey[i] * y + e0[i]); }
  [[nodiscard]] bool covers(double x, double y) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = value(i, x, y);
      if (v < 0.0 || (v == 0.0 && !owns[i])) return false;
    }
    return true;
  }
  /// Clamped, because the slopes of a sliver are mostly rounding.
  [[nodiscard]] double w_at(double x, double y) const { return std::clamp(w0 + (wx * x + wy * y), low, high); }
};

}  // namespace sightline
