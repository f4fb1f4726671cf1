#include "sightline/raster/box_footprint.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {

BoxProjector::BoxProjector(const View& view, int width, int height)
    : eye_(view.eye),
      near_(view.near),
      width_(width),
      height_(height),
      perspective_(view.projection == Projection::perspective) {
  const double half_height = perspective_ ? std::tan(0.5 * view.fov_y) : 0.5 * view.span_y;
  const double half_width = half_height * view.width / view.height;
  const glm::dmat3 axes = glm::mat3_cast(view.orientation);
  to_x_ = axes[0] * (0.5 * width / half_width);
  to_y_ = -axes[1] * (0.5 * height / half_height);
  to_w_ = -axes[2];
}

BoxFootprint BoxProjector::project(const Aabb& box) const {
  constexpr double margin = 1.0 / 64;  // pixels: what projecting in another order may differ by
  BoxFootprint f;
  if (box.empty()) return f;
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  f.nearest = 1e300;
  f.farthest = -1e300;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 d = glm::dvec3(box.corner(i)) - eye_;
    const double w = glm::dot(to_w_, d);
    f.nearest = std::min(f.nearest, w);
    f.farthest = std::max(f.farthest, w);
    const double scale = perspective_ ? 1.0 / w : 1.0;  // meaningless unless nearest > 0, and then not used
    const double x = 0.5 * width_ + glm::dot(to_x_, d) * scale, y = 0.5 * height_ + glm::dot(to_y_, d) * scale;
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
  }
  if (f.farthest < near_ * (1.0 - 1e-6)) return f;
  if (perspective_ ? !(f.nearest > near_) : !(f.nearest > near_ && std::isfinite(x0 + x1 + y0 + y1))) {
    f.place = BoxPlace::everywhere;
    f.x1 = width_;
    f.y1 = height_;
    return f;
  }
  const auto clip = [](double v, int limit) {
    return static_cast<int>(std::clamp(std::floor(v), 0.0, static_cast<double>(limit)));
  };
  f.x0 = clip(x0 - margin, width_);
  f.x1 = clip(x1 + margin + 1, width_);
  f.y0 = clip(y0 - margin, height_);
  f.y1 = clip(y1 + margin + 1, height_);
  if (f.x0 < f.x1 && f.y0 < f.y1) f.place = BoxPlace::rectangle;
  return f;
}

}  // namespace sightline
