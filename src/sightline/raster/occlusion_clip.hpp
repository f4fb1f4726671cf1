// Triangles and contour edges of occluders that reach before the near plane or far out of the image: clipped in double
// precision. The cut at the near plane is a contour; cuts outside of the image need none. Internal to raster/.
#pragma once

#include <glm/glm.hpp>

namespace sightline::raster {

struct DrawList;

/// Mesh space to pixels: rows * p + offset is (x, y, distance), x and y from the image's centre, times the distance for
/// perspective views.
struct ClipTransform {
  glm::dmat3 rows;
  glm::dvec3 offset;
  glm::dvec2 centre;
  double near, guard;
  bool perspective;
};

/// > 0 if the triangle's front faces the eye, < 0 for its back, 0 without area; right even behind the eye (Olano and
/// Greer 1997).
double clip_facing(const ClipTransform& t, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
/// Appends what is left of a triangle, and its cut at the near plane as a contour edge.
void clip_triangle(const ClipTransform& t, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, DrawList& out);
/// Appends what is left of a contour edge.
void clip_edge(const ClipTransform& t, const glm::vec3& a, const glm::vec3& b, DrawList& out);

}  // namespace sightline::raster
