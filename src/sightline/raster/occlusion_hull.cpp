#include "sightline/raster/occlusion_hull.hpp"

#include <cmath>

namespace sightline::raster {
namespace {

/// Adds the plane of a front face at `value` along `axis`: nearness, which is affine in the image.
void add_plane(const LocalView& v, int axis, double value, Hull& hull) {
  const double ahead = value - v.eye[axis];
  const double per = v.perspective ? 1.0 / ahead : 1.0 / v.ray_w[axis];
  const double a = v.ray_x[axis] * per, b = v.ray_y[axis] * per;
  const double c = v.perspective ? v.ray_w[axis] * per : -ahead * per;
  const double width = hull.x1 + 1.0, height = hull.y1 + 1.0;
  // At the pixel's centre, raised to the most within the part that counts, and by the rounding of the float loops.
  double at_origin = c + a * (0.5 - v.centre.x) + b * (0.5 - v.centre.y);
  at_origin += (v.square + v.margin) * (std::abs(a) + std::abs(b));
  at_origin += 0x1p-20 * (std::abs(a) * width + std::abs(b) * height + std::abs(at_origin));
  if (!(std::abs(a) < 1e30 && std::abs(b) < 1e30 && std::abs(at_origin) < 1e30)) return;
  const auto i = static_cast<std::size_t>(hull.planes++);
  hull.plane_a[i] = static_cast<float>(a);
  hull.plane_b[i] = static_cast<float>(b);
  hull.plane_c[i] = static_cast<float>(at_origin);
}

/// Adds the edge of the outline through p and q (pixels from the image's centre); `inner` lies inside.
void add_edge(const LocalView& v, const glm::dvec2& p, const glm::dvec2& q, const glm::dvec2& inner, Hull& hull) {
  double a = p.y - q.y, b = q.x - p.x;
  const double length = std::abs(a) + std::abs(b);
  if (!(length > 1e-9)) return;
  const double scale = 1.0 / (length * (v.square + v.margin));
  a *= scale;
  b *= scale;
  double c = -(a * p.x + b * p.y);
  const double depth = a * inner.x + b * inner.y + c;
  if (!(std::abs(depth) > 1e-6)) return;  // flat: the rectangle is all that is known
  if (depth < 0) {
    a = -a;
    b = -b;
    c = -c;
  }
  c += a * (0.5 - v.centre.x) + b * (0.5 - v.centre.y);
  if (!(std::abs(c) < 1e30)) return;
  const auto i = static_cast<std::size_t>(hull.edges++);
  hull.edge_a[i] = static_cast<float>(a);
  hull.edge_b[i] = static_cast<float>(b);
  hull.edge_c[i] = static_cast<float>(c);
}

}  // namespace

void outline(const LocalView& v, const Aabb& box, Hull& hull) {
  hull.edges = hull.planes = 0;
  bool front[3][2];
  for (int axis = 0; axis < 3; ++axis) {
    const double lo = box.lo[axis], hi = box.hi[axis];
    front[axis][0] = v.perspective ? v.eye[axis] < lo : v.ray_w[axis] > 0;
    front[axis][1] = v.perspective ? v.eye[axis] > hi : v.ray_w[axis] < 0;
    if (front[axis][0]) add_plane(v, axis, lo, hull);
    if (front[axis][1]) add_plane(v, axis, hi, hull);
  }
  const auto to_pixel = [&](const glm::dvec3& p) {
    const glm::dvec3 r = v.rows * (p - v.eye);
    return v.perspective ? glm::dvec2(r) / r.z : glm::dvec2(r);
  };
  glm::dvec2 corners[8];
  for (int i = 0; i < 8; ++i) corners[i] = to_pixel(glm::dvec3(box.corner(i)));
  const glm::dvec2 inner = to_pixel(0.5 * (glm::dvec3(box.lo) + glm::dvec3(box.hi)));
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 8; ++i) {
      if (((i >> axis) & 1) != 0) continue;
      const int u = (axis + 1) % 3, w = (axis + 2) % 3;
      if (front[u][(i >> u) & 1] != front[w][(i >> w) & 1] && hull.edges < 6)
        add_edge(v, corners[i], corners[i | (1 << axis)], inner, hull);
    }
}

}  // namespace sightline::raster
