// Convex hulls of points (quickhull: Barber, Dobkin, Huhdanpaa 1996), as bounding volumes (checklist 20.06) and as the
// few points from which all other bounds of a mesh follow. Flat, straight and single sets give hulls without volume.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "sightline/geometry/frustum.hpp"

namespace sightline {

struct ConvexHull {
  /// Some of the points given.
  std::vector<glm::vec3> vertices;
  /// Triangles, outside counter-clockwise. A flat hull has both sides; a segment or point has none.
  std::vector<glm::uvec3> faces;
  /// No point given lies farther outside of the vertices' hull (a few roundings of float).
  float slack = 0.0f;
};

ConvexHull convex_hull(std::span<const glm::vec3> points);

/// Indices of the corners of the convex hull of points in the plane, counter-clockwise (Andrew 1979).
std::vector<std::uint32_t> convex_polygon(std::span<const glm::dvec2> points);
/// Area of that hull.
double convex_area(std::span<const glm::dvec2> points);

double volume(const ConvexHull& hull);
double surface(const ConvexHull& hull);

/// The test of any convex volume by its corners (20.12, 20.13): outside iff all lie behind one plane. Outside is
/// certain.
Containment classify(const Frustum& frustum, std::span<const glm::vec3> corners, float slack = 0.0f);

}  // namespace sightline
