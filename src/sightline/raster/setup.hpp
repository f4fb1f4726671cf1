// Third stage: snapping to 1/256 pixel, exact integer edge functions with the top-left rule (E4), and the plane of the
// depth. Two triangles that share an edge share no pixel and leave none out. Checklist 3.04, 3.05, 3.08.
#pragma once

#include <array>
#include <cstdint>

#include "sightline/raster/vertex.hpp"

namespace sightline::raster {

inline constexpr int subpixel_bits = 8;
inline constexpr std::int32_t subpixel_one = 1 << subpixel_bits;

/// Window coordinate to 1/256 pixels relative to pixel centres (the centre of pixel 0 is 0), rounded to nearest, ties
/// to even: what llvmpipe does.
std::int32_t snap(float pixels);

/// One edge as a function of the pixel: value(x, y) = c + dx * x + dy * y, in units of 2^-16 pixel^2; a centre belongs
/// to the triangle iff all three are >= 0. The fill rule is in c.
struct Edge {
  std::int64_t c, dx, dy;
  [[nodiscard]] std::int64_t at(int x, int y) const { return c + dx * x + dy * y; }
};

/// A quantity that is affine in the window, incrementally (3.08, E5): value(x, y) = at_origin + dx * x + dy * y at the
/// centre of pixel (x, y) counted from the pixel that `origin_*` names.
struct Plane3 {
  double at_origin, dx, dy;
  [[nodiscard]] double at(int x, int y) const { return at_origin + dx * x + dy * y; }
};

struct TriangleSetup {
  std::array<Edge, 3> edges;         // edge i is opposite to vertex i
  std::array<std::int32_t, 3> x, y;  // snapped vertices
  std::int64_t area;                 // twice the area, > 0 after setup, in units of 2^-16 pixel^2
  bool front;                        // which side is seen
  int x0, y0, x1, y1;                // pixels whose centres lie in the bounding box: [x0, x1) x [y0, y1)
};

/// Sets up a triangle for an image of width x height pixels. False: nothing to fill (no area, or no pixel centre within
/// its box). `front_is_ccw`: counter-clockwise on the screen is the front.
bool set_up(const std::array<WindowPoint, 3>& corners, int width, int height, bool front_is_ccw, TriangleSetup& out);

/// The plane through the snapped vertices with these values there.
Plane3 plane_through(const TriangleSetup& t, double v0, double v1, double v2);

}  // namespace sightline::raster
