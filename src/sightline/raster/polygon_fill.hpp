// Pixels of convex planar polygons without clipping: edges and cuts as linear functions of the pixel in homogeneous
// space (Olano and Greer 1997), 1 / distance as another (E5). Promise: the oracle's pixel centres, top-left rule for
// edges of triangles; the two parts of a cut polygon share every pixel out between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "sightline/index/bsp.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// a * x + b * y + c over pixel coordinates.
struct PixelFunction {
  double a = 0.0, b = 0.0, c = 0.0;
  [[nodiscard]] double at(double x, double y) const { return a * x + (b * y + c); }
};

/// How view space is seen in the image of a view.
struct ImageMap {
  explicit ImageMap(const View& view);
  glm::dmat4 to_view;
  bool perspective;
  double scale;  // metres per pixel, at distance 1 for perspective views
  double cx, cy;
  double near, far;
  int width, height;

  [[nodiscard]] glm::dvec3 view_point(const glm::dvec3& world) const {
    return glm::dvec3(to_view * glm::dvec4(world, 1.0));
  }
  /// dot(n, d) where d is what the pixel looks along (perspective, depth 1) or at (orthographic, depth 0).
  [[nodiscard]] PixelFunction along(const glm::dvec3& n) const;
};

/// A convex polygon ready for filling.
class PolygonFill {
 public:
  /// Corners in view space. False if it has no area in the image or lies beside the viewport, near or far plane.
  bool set(const ImageMap& map, std::span<const glm::dvec3> corners);
  /// Keeps only the pixels whose point of the polygon has F >= 0 (or, if strict, F > 0) for a plane in view space.
  void cut(const ImageMap& map, const BspPlane& plane, bool strict);
  /// Restricts the pixels to the bounds of these corners (view space), which lie on the polygon.
  bool narrow(const ImageMap& map, std::span<const glm::dvec3> corners);

  /// Calls put(x, y, depth) for every pixel centre inside, depth within near and far plane.
  template <class Put>
  void fill(Put&& put) const {
    for (int y = y0_; y < y1_; ++y) {
      const double py = y + 0.5;
      int x0 = x0_, x1 = x1_;
      for (const Limit& limit : limits_) {
        const double rest = limit.f.b * py + limit.f.c;
        if (limit.f.a == 0.0) continue;
        const double x = -rest / limit.f.a - 0.5;  // a little generous; the test below decides
        if (!(std::abs(x) < 1e9)) continue;
        if (limit.f.a > 0.0)
          x0 = std::max(x0, static_cast<int>(std::floor(x)));
        else
          x1 = std::min(x1, static_cast<int>(std::ceil(x)) + 1);
      }
      for (int x = x0; x < x1; ++x) {
        const double px = x + 0.5;
        bool inside = true;
        for (const Limit& limit : limits_) {
          const double value = limit.f.at(px, py);
          inside = inside && (value > 0.0 || (value == 0.0 && limit.owns_zero));
        }
        if (!inside) continue;
        const double depth = depth_at(px, py);
        if (depth >= near_ && depth <= far_) put(x, y, static_cast<float>(depth));
      }
    }
  }

  [[nodiscard]] double depth_at(double px, double py) const {
    const double z = depth_.at(px, py);
    return std::clamp(perspective_ ? 1.0 / z : z, low_, high_);
  }
  [[nodiscard]] bool empty() const { return x0_ >= x1_ || y0_ >= y1_; }

 private:
  struct Limit {
    PixelFunction f;
    bool owns_zero;
  };
  bool bound(const ImageMap& map, std::span<const glm::dvec3> corners);

  std::vector<Limit> limits_;
  PixelFunction depth_;  // 1 / distance, or the distance of orthographic views
  bool perspective_ = true;
  double near_ = 0.0, far_ = 0.0, low_ = 0.0, high_ = 0.0;
  int x0_ = 0, y0_ = 0, x1_ = 0, y1_ = 0;
};

}  // namespace sightline
