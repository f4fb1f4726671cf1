#include "sightline/raster/polygon_fill.hpp"

#include <limits>

namespace sightline {
namespace {

/// Pixels whose centres lie in [low, high], within [0, size); generous by rounding.
void pixel_range(double low, double high, int size, int& begin, int& end) {
  begin = static_cast<int>(std::clamp(std::ceil(low - 0.5 - 1e-6), 0.0, static_cast<double>(size)));
  end = static_cast<int>(std::clamp(std::floor(high - 0.5 + 1e-6) + 1.0, 0.0, static_cast<double>(size)));
}

}  // namespace

ImageMap::ImageMap(const View& view)
    : to_view(view_matrix(view)),
      perspective(view.projection == Projection::perspective),
      scale((perspective ? 2.0 * std::tan(0.5 * view.fov_y) : view.span_y) / view.height),
      cx(0.5 * view.width),
      cy(0.5 * view.height),
      near(view.near),
      far(view.far),
      width(view.width),
      height(view.height) {}

PixelFunction ImageMap::along(const glm::dvec3& n) const {
  const double a = n.x * scale, b = -n.y * scale;
  return {a, b, (perspective ? -n.z : 0.0) - (a * cx + b * cy)};
}

bool PolygonFill::bound(const ImageMap& map, std::span<const glm::dvec3> corners) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double min_x = infinity, max_x = -infinity, min_y = infinity, max_y = -infinity;
  double low = infinity;
  const auto add = [&](const glm::dvec3& p) {
    const double w = map.perspective ? -p.z * map.scale : map.scale;
    const double x = map.cx + p.x / w, y = map.cy - p.y / w;
    min_x = std::min(min_x, x);
    max_x = std::max(max_x, x);
    min_y = std::min(min_y, y);
    max_y = std::max(max_y, y);
    low = std::min(low, -p.z);
  };
  // The part beyond the near plane bounds what can be seen; before the eye nothing may be divided.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const bool a_in = -a.z >= map.near, b_in = -b.z >= map.near;
    if (a_in) add(a);
    if (a_in != b_in) {
      glm::dvec3 p = a + (map.near + a.z) / (a.z - b.z) * (b - a);
      p.z = -map.near;
      add(p);
    }
  }
  if (!(low <= map.far)) return false;
  pixel_range(min_x, max_x, map.width, x0_, x1_);
  pixel_range(min_y, max_y, map.height, y0_, y1_);
  return !empty();
}

bool PolygonFill::set(const ImageMap& map, std::span<const glm::dvec3> corners) {
  limits_.clear();
  perspective_ = map.perspective;
  near_ = map.near;
  far_ = map.far;
  if (!bound(map, corners)) return false;
  low_ = high_ = -corners[0].z;
  for (const glm::dvec3& p : corners) {
    low_ = std::min(low_, -p.z);
    high_ = std::max(high_, -p.z);
  }
  glm::dvec3 normal(0.0);
  for (std::size_t i = 2; i < corners.size(); ++i)
    normal += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  // Towards the eye or away from it: the sense of rotation in the image.
  const double facing = map.perspective ? glm::dot(normal, corners[0]) : -normal.z;
  if (!(facing != 0.0) || !std::isfinite(facing)) return false;
  const double sign = facing > 0.0 ? 1.0 : -1.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    // Of a -> b exactly the negative of b -> a: neighbours see the same number up to the sign.
    PixelFunction f;
    if (map.perspective) {
      f = map.along(glm::cross(a, b));
    } else {
      f = map.along({a.y - b.y, b.x - a.x, 0.0});
      f.c += a.x * b.y - a.y * b.x;
      f = {-f.a, -f.b, -f.c};
    }
    f = {sign * f.a, sign * f.b, sign * f.c};
    limits_.push_back({f, f.a > 0.0 || (f.a == 0.0 && f.b > 0.0)});
  }
  if (map.perspective) {
    const PixelFunction n = map.along(normal);
    depth_ = {n.a / facing, n.b / facing, n.c / facing};
  } else {  // n . (x, y, -depth) = n . corner
    const PixelFunction n = map.along(normal);
    const double offset = glm::dot(normal, corners[0]);
    depth_ = {n.a / normal.z, n.b / normal.z, (n.c - offset) / normal.z};
  }
  return true;
}

void PolygonFill::cut(const ImageMap& map, const BspPlane& plane, bool strict) {
  PixelFunction f = map.along(plane.normal);
  if (map.perspective) {  // n . (d t) + o >= 0 with t > 0
    f = {f.a + plane.offset * depth_.a, f.b + plane.offset * depth_.b, f.c + plane.offset * depth_.c};
  } else {
    f = {f.a - plane.normal.z * depth_.a, f.b - plane.normal.z * depth_.b,
         f.c - plane.normal.z * depth_.c + plane.offset};
  }
  limits_.push_back({strict ? PixelFunction{-f.a, -f.b, -f.c} : f, !strict});
}

bool PolygonFill::narrow(const ImageMap& map, std::span<const glm::dvec3> corners) {
  const int x0 = x0_, y0 = y0_, x1 = x1_, y1 = y1_;
  const bool any = bound(map, corners);
  x0_ = std::max(x0_, x0);
  y0_ = std::max(y0_, y0);
  x1_ = std::min(x1_, x1);
  y1_ = std::min(y1_, y1);
  return any && !empty();
}

}  // namespace sightline
