#include "sightline/raster/setup.hpp"

#include <algorithm>
#include <cmath>

namespace sightline::raster {
namespace {

/// Top-left rule in an image with y down, edges directed so that the inside has positive values: left edges run up,
/// top edges run to the right.
bool owns_border(std::int64_t run_x, std::int64_t run_y) { return run_y < 0 || (run_y == 0 && run_x > 0); }

int floor_pixel(std::int32_t v) { return v >> subpixel_bits; }
int ceil_pixel(std::int32_t v) { return (v + subpixel_one - 1) >> subpixel_bits; }

}  // namespace

std::int32_t snap(float pixels) {
  return static_cast<std::int32_t>(std::lrintf((pixels - 0.5f) * static_cast<float>(subpixel_one)));
}

bool set_up(const std::array<WindowPoint, 3>& corners, int width, int height, bool front_is_ccw, TriangleSetup& t) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!std::isfinite(corners[i].x) || !std::isfinite(corners[i].y)) return false;
    t.x[i] = snap(corners[i].x);
    t.y[i] = snap(corners[i].y);
  }
  t.area = static_cast<std::int64_t>(t.x[1] - t.x[0]) * (t.y[2] - t.y[0]) -
           static_cast<std::int64_t>(t.x[2] - t.x[0]) * (t.y[1] - t.y[0]);
  if (t.area == 0) return false;
  // With y down a positive area is clockwise as seen.
  const std::int64_t sign = t.area > 0 ? 1 : -1;
  t.front = (sign < 0) == front_is_ccw;
  t.area *= sign;
  t.x0 = std::max(0, ceil_pixel(std::min({t.x[0], t.x[1], t.x[2]})));
  t.y0 = std::max(0, ceil_pixel(std::min({t.y[0], t.y[1], t.y[2]})));
  t.x1 = std::min(width, floor_pixel(std::max({t.x[0], t.x[1], t.x[2]})) + 1);
  t.y1 = std::min(height, floor_pixel(std::max({t.y[0], t.y[1], t.y[2]})) + 1);
  if (t.x0 >= t.x1 || t.y0 >= t.y1) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t a = (i + 1) % 3, b = (i + 2) % 3;
    const std::int64_t run_x = sign * (t.x[b] - t.x[a]), run_y = sign * (t.y[b] - t.y[a]);
    Edge& e = t.edges[i];
    e.dx = -run_y * subpixel_one;
    e.dy = run_x * subpixel_one;
    e.c = run_y * t.x[a] - run_x * t.y[a] - (owns_border(run_x, run_y) ? 0 : 1);
  }
  return true;
}

Plane3 plane_through(const TriangleSetup& t, double v0, double v1, double v2) {
  // Gradients by Cramer's rule on exact differences; anchored at vertex 0.
  const double x1 = t.x[1] - t.x[0], y1 = t.y[1] - t.y[0], x2 = t.x[2] - t.x[0], y2 = t.y[2] - t.y[0];
  const double det = x1 * y2 - x2 * y1;
  const double dx = ((v1 - v0) * y2 - (v2 - v0) * y1) / det, dy = ((v2 - v0) * x1 - (v1 - v0) * x2) / det;
  return {v0 - dx * t.x[0] - dy * t.y[0], dx * subpixel_one, dy * subpixel_one};
}

}  // namespace sightline::raster
