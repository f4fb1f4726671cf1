// Oriented boxes (checklist 15.25, 20.04, 20.05): along the principal axes (E33: the eigenvectors give directions only,
// the extents are measured), or of least volume with a side on a face of the convex hull.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "sightline/geometry/affine.hpp"
#include "sightline/geometry/frustum.hpp"
#include "sightline/geometry/hull.hpp"

namespace sightline {

/// Centre, three unit axes, three radii: the unit cube [-1, 1]^3 under T(M) R(u, v, w) S(rx, ry, rz) (20.04).
struct Obb {
  glm::vec3 centre{0.0f};
  glm::mat3 axes{1.0f};
  glm::vec3 radii{-1.0f};  // negative: empty

  [[nodiscard]] Affine matrix() const { return {axes[0] * radii.x, axes[1] * radii.y, axes[2] * radii.z, centre}; }
  /// Corner i in 0..7 as Aabb::corner.
  [[nodiscard]] glm::vec3 corner(int i) const {
    return centre + axes[0] * ((i & 1) != 0 ? radii.x : -radii.x) + axes[1] * ((i & 2) != 0 ? radii.y : -radii.y) +
           axes[2] * ((i & 4) != 0 ? radii.z : -radii.z);
  }
};

/// The box of the points along the principal axes of the points.
Obb pca_box(std::span<const glm::vec3> points);
/// The least volume of all boxes that have a side on a face of the hull, and in that plane the rectangle of least area
/// (rotating calipers); at most 256 faces are tried, evenly chosen. Never larger than the box along the axes.
Obb fitted_box(const ConvexHull& hull);
/// The box of the points along the given axes (orthonormal up to rounding), radii rounded up.
Obb box_along(std::span<const glm::vec3> points, const glm::dmat3& axes);

/// 8 r_x r_y r_z, and the surface.
double volume(const Obb& box);
double surface(const Obb& box);

/// Outside is certain; the radius of the box along each plane's normal decides (20.14 in the box's frame).
Containment classify(const Frustum& frustum, const Obb& box);

}  // namespace sightline
