// The outline of a box and its front faces in the image: what a box can touch is less than its rectangle, and most of
// it is farther than its nearest corner (outlines of boxes: Schmalstieg and Tobler 1999). Promise: outwards and towards
// the eye, as the rectangle. Internal to raster/.
#pragma once

#include <glm/glm.hpp>

#include "sightline/geometry/aabb.hpp"
#include "sightline/raster/occlusion_kernels.hpp"

namespace sightline::raster {

/// The view from a box's own space. The point seen at pixel (x, y), counted from the image's centre, at distance w:
/// eye + w (x ray_x + y ray_y + ray_w) for perspective views, eye + x ray_x + y ray_y + w ray_w for orthographic ones.
struct LocalView {
  glm::dvec3 eye, ray_x, ray_y, ray_w;
  glm::dmat3 rows;  // of p - eye: (x, y, distance), times the distance for perspective views
  glm::dvec2 centre;
  double square, margin;  // pixels
  bool perspective;
};

/// The hull of a box all of which lies before the eye; the rectangle and `near` of `hull` are given.
void outline(const LocalView& view, const Aabb& box, Hull& hull);

}  // namespace sightline::raster
